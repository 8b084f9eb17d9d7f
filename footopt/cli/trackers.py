"""Trackers: Hydra's callbacks that hear of every job, and keep it where you keep your runs.

``hydra/callbacks=mlflow`` or ``hydra/callbacks=jsonl`` switches one on; a class of your own that derives
from `Tracker` is another, by ``+hydra.callbacks.mine._target_=module.Class``.
"""

from __future__ import annotations

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig

from footopt.errors import ERROR_FILE, SettingError
from footopt.files.identity import flat
from footopt.files.io import read_json_file


class Tracker(Callback, ABC):
    """What is told of every job when it has ended, in the job's own process."""

    def on_job_end(self, config: DictConfig, job_return: Any, **kwargs: Any) -> None:
        """Read what the job has left, and `track` it."""
        folder = Path(config.hydra.runtime.output_dir)
        if (folder / "result.json").is_file():
            result = read_json_file(folder / "result.json", "folder")
            objectives, note = result.get("objectives"), result.get("reason") or ""
            numbers = objectives if isinstance(objectives, Mapping) else {}  # a study may list their names
            self.track(folder, flat(result.get("settings") or {}), numbers, note)
        else:
            error = folder / ERROR_FILE
            said = error.read_text(encoding="utf-8").strip() if error.is_file() else "no result"
            self.track(folder, {}, {}, said)

    @abstractmethod
    def track(
        self, folder: Path, settings: Mapping[str, Any], objectives: Mapping[str, float | None], note: str
    ) -> None:
        """Keep a job.

        Parameters
        ----------
        folder : Path
            Of its files.
        settings : mapping of str to object
            By their full names; empty for a job that has failed.
        objectives : mapping of str to float or None
            In their natural signs and units; None where the walk has none.
        note : str
            Why it or its walk has failed; "" if it has not.
        """


class JsonLines(Tracker):
    """A line of JSON for each job.

    Parameters
    ----------
    path : str
        The file that lines are added to.
    """

    def __init__(self, path: str = "runs.jsonl") -> None:
        self.path = Path(path).resolve()

    def track(
        self, folder: Path, settings: Mapping[str, Any], objectives: Mapping[str, float | None], note: str
    ) -> None:
        line = {"folder": str(folder), "settings": settings, "objectives": objectives, "note": note}
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")


class MLflow(Tracker):
    """Each job as a run of MLflow's: settings are its parameters, objectives its metrics.

    Parameters
    ----------
    experiment : str
        Its name; made if it is not there.
    uri : str, optional
        Of the tracking server or database; by default what MLFLOW_TRACKING_URI says.

    Raises
    ------
    SettingError
        MLflow is not installed.
    """

    def __init__(self, experiment: str = "footopt", uri: str | None = None) -> None:
        try:
            from mlflow.tracking import MlflowClient
        except ImportError as error:
            raise SettingError(
                "hydra/callbacks", "mlflow", f"installed ({error})", "pip install 'footopt[mlflow]'."
            ) from None
        self.experiment, self.uri, self._client = experiment, uri, MlflowClient

    def track(
        self, folder: Path, settings: Mapping[str, Any], objectives: Mapping[str, float | None], note: str
    ) -> None:
        client = self._client(self.uri)
        known = client.get_experiment_by_name(self.experiment)
        where = known.experiment_id if known else client.create_experiment(self.experiment)
        run = client.create_run(where, run_name=folder.name, tags={"folder": str(folder), "note": note}).info
        for name, value in settings.items():
            client.log_param(run.run_id, name, value)
        for name, number in objectives.items():
            if number is not None and math.isfinite(number):
                client.log_metric(run.run_id, name, number)
        client.set_terminated(run.run_id, "FAILED" if note else "FINISHED")
