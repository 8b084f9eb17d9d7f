"""A tracker: a callback of Hydra that hears of every job of a sweep, and keeps it where you keep your runs.

PYTHONPATH=examples/tracking footopt -m sand=soft,hard +hydra.callbacks.tracker._target_=tracker.Tracker
"""

import json
from pathlib import Path

from hydra.experimental.callback import Callback


class Tracker(Callback):
    """Writes a line of JSON for each job: its settings, its objectives, and where it is."""

    def __init__(self, path="runs.jsonl"):
        self.path = path

    def on_job_end(self, config, job_return, **kwargs):
        """Read what the job has left; it has failed if it left no result."""
        folder = Path(config.hydra.runtime.output_dir)
        if not (folder / "result.json").is_file():
            return self.log(folder, {}, {})
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        groups = {name: own for name, own in result["settings"].items() if isinstance(own, dict)}
        settings = {f"{group}.{name}": value for group, own in groups.items() for name, value in own.items()}
        return self.log(folder, settings, result["objectives"])

    def log(self, folder, settings, objectives):
        """Replace this by your tracker's own calls. MLflow's are:

        with mlflow.start_run(run_name=str(folder)):
            mlflow.log_params(settings)
            mlflow.log_metrics(objectives)
            mlflow.log_artifact(folder / "result.json")
        """
        line = json.dumps({"folder": str(folder), "settings": settings, "objectives": objectives})
        with open(self.path, "a", encoding="utf-8") as file:
            file.write(line + "\n")
