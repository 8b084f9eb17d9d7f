"""Each job of a multirun as a run of MLflow (pip install mlflow), by a callback of Hydra:

PYTHONPATH=examples footopt -m sand=soft,hard +hydra.callbacks.mlflow._target_=mlflow_callback.MLflow
"""

import json
from pathlib import Path

import mlflow
from hydra.experimental.callback import Callback
from omegaconf import OmegaConf


class MLflow(Callback):
    """Settings are parameters and objectives metrics; MLFLOW_TRACKING_URI says where they are kept."""

    def on_job_end(self, config, job_return, **kwargs):
        """Read what the job has left in its folder."""
        folder = Path(config.hydra.runtime.output_dir)
        found = folder / "result.json"
        result = json.loads(found.read_text()) if found.is_file() else {}
        values = result.get("objectives", {})
        mlflow.set_experiment("footopt")
        with mlflow.start_run(run_name=folder.name, tags={"folder": str(folder)}):
            settings = OmegaConf.masked_copy(config, [name for name in config if name != "hydra"])
            for group, choice in settings.items():
                chosen = choice if OmegaConf.is_dict(choice) else {"": choice}
                mlflow.log_params({f"{group}.{name}".rstrip("."): value for name, value in chosen.items()})
            mlflow.log_metrics({name: value for name, value in values.items() if value is not None})
            if not result:
                mlflow.end_run("FAILED")
