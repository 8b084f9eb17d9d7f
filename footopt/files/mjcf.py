"""A foot as a body of MuJoCo, with a script that drops it on sand."""

from __future__ import annotations

from pathlib import Path

from footopt.files.io import write_text
from footopt.foot import Foot

BODY = """<mujoco model="foot">
  <asset><mesh name="foot" file="contour.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <body name="foot" pos="0 0 {height:.6g}"> <!-- its origin is the ankle; x is forward, z up -->
      <freejoint/> <!-- take it away to mount the foot on a leg -->
      <geom type="mesh" mesh="foot" pos="{x:.6g} 0 {z:.6g}" density="1240" contype="0"/>
      <site name="ankle"/>
    </body>
  </worldbody>
</mujoco>
"""
SCRIPT = '''"""Drop the foot on sand. Your robot may take the place of foot.xml, its feet that of "foot"."""
import mujoco
import footopt as fo

sole = fo.read_foot("contour.csv", width={width!r}, ankle={ankle!r})
model = mujoco.MjModel.from_xml_path("foot.xml")
data = mujoco.MjData(model)
sand = fo.mujoco.attach(model, data, {{"foot": sole}}, fo.Sand.named("hard"))
mujoco.mj_step(model, data, nstep=1000)
print("sunk (m):", sand.depth["foot"], "carried (N):", sand.force["foot"][2])
'''


def write_mjcf(foot: Foot, folder: Path) -> list[Path]:
    """Write foot.xml, with the mesh contour.stl and the site ankle, and drop.py, which lets it fall."""
    x, z = (float(v) for v in foot.ankle)
    height = 0.02 + z - float(foot.contour[:, 1].min())  # the sole 2 cm above the sand
    write_text(folder / "foot.xml", BODY.format(height=height, x=-x, z=-z))
    write_text(folder / "drop.py", SCRIPT.format(width=float(foot.width), ankle=(x, z)))
    return [folder / "foot.xml", folder / "drop.py"]
