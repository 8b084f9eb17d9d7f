"""`study.mujoco=true` writes the foot."""

import json
from dataclasses import asdict

import pytest

from footopt import studies
from footopt.studies import export
from footopt.studies.settings import Config, FootConfig

mujoco = pytest.importorskip("mujoco")


@pytest.mark.slow
def test_a_run_becomes_a_body_with_its_ankle_above_the_sand(tmp_path):
    run, exported = tmp_path / "run", tmp_path / "out"
    run.mkdir()
    exported.mkdir()
    saved = FootConfig(k=[5, 8, 9, 8, 5, 4, 4, 2, 2, 3, 4], ankle=[0.02, 0.01])
    design = {"k": saved.k, "name": "best"}
    (run / "result.json").write_text(json.dumps({"design": design, "settings": {"foot": asdict(saved)}}))
    config = Config(
        report="none",
        study=export.Settings(run=str(run), mujoco=True),
        foot=FootConfig(),
    )
    studies.run_study(config, exported, {})
    assert "foot.xml" in json.loads((exported / "result.json").read_text())["files"]
    model = mujoco.MjModel.from_xml_path(str(exported / "foot.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    foot, ankle = model.body("foot").id, data.site("ankle").xpos
    assert ankle == pytest.approx(data.xpos[foot])
    mesh = model.mesh_vert @ data.geom_xmat[0].reshape(3, 3).T + data.geom_xpos[0]
    assert mesh[:, 2].min() == pytest.approx(0.02, abs=2e-4)  # above the sand
    assert mesh[:, 0].min() == pytest.approx(ankle[0] - 0.13 - 0.02, abs=1e-4)
    assert mesh[:, 2].max() == pytest.approx(ankle[2] - 0.01, abs=1e-4)  # the flat top is at z_p = 0
