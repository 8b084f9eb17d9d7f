"""`footopt study=simulate run=FOLDER sand=soft`: the foot of a run, in its world but for what is given."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hydra.core.global_hydra import GlobalHydra
from hydra.types import RunMode
from omegaconf import OmegaConf, open_dict

from footopt.cli.paths import typed, within
from footopt.files import identity
from footopt.studies import CHOICE

#: Groups of settings that say in what world, and how finely, is walked.
WORLD = ("sand", "gait", "walker", "effects", "scene", "accuracy")


def in_the_world_of_its_run(settings: Mapping[str, Any], here: Any) -> dict[str, Any]:
    """The settings of a walk with the foot of a run: those of the run where nothing else was given.

    It is walked as finely as the run's own numbers were. The foot's own are the run's in any case, so that
    this walk's folder knows its foot, too; but for another sole of its space, and a block for the workshop.

    Parameters
    ----------
    settings : dict
        All settings, composed.
    here : HydraConfig
        Of what, and how.

    Raises
    ------
    FileError
        study.run is not the folder of a run.
    """
    study = settings["study"]
    if study["name"] != "simulate" or study["run"] is None:
        return dict(settings)
    run: Any = copy.deepcopy(identity.read(Path(study["run"]).expanduser(), "run").settings)
    if run["study"]["name"] != "simulate" and run["study"]["confirm"]:
        run["accuracy"] = dict.fromkeys(run["accuracy"]) | {"name": run["study"]["confirm"]}
    plain = GlobalHydra.instance().config_loader()
    default = plain.load_configuration(here.job.config_name, ["study=simulate"], RunMode.RUN)
    with open_dict(default):
        del default["hydra"]
    given = (word.lstrip("+").partition("=")[0] for word in typed(here))
    named = {name if name in WORLD else CHOICE.get(name, name) for name in given}  # planet: walker.g
    changed = {*identity.differing(settings, OmegaConf.to_container(default, resolve=True)), *named}
    given_foot = {name: settings["foot"][name] for name in ("k", "block")}
    walked = dict(settings) | {group: run[group] for group in WORLD} | {"foot": run["foot"] | given_foot}
    for name in sorted(changed):  # a group before what is in it
        *above, last = name.split(".")
        if (above or [last])[0] in WORLD:
            within(walked, above)[last] = within(settings, above)[last]
    return walked
