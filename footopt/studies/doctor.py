"""Is the installation sound? Versions, processor, cache folder, and a walk whose numbers are published."""

import numpy as np

from footopt.compiled import cache_folder, target
from footopt.errors import FootoptError
from footopt.files import identity
from footopt.report import terminal
from footopt.sand import Sand
from footopt.studies.runs import Study
from footopt.walk import FIVE, Scene, evaluate
from footopt.walk.batch import available_threads
from footopt.walk.reference import LIMITS, PUBLISHED, RAMP


def run(study: Study) -> None:
    """List what footopt runs on, and hold a walk on each sand against an independent program's."""
    found = {
        **identity.versions(),
        "processor": f"{target()['processor']}, {available_threads()} threads",
    }
    wrong = []
    with study.compiling():
        for published in PUBLISHED:
            walked = evaluate([RAMP], Scene(sand=Sand.named(published.sand)), threads=1).values[0]
            off, limit = np.abs(walked / np.array(published.objectives) - 1.0), LIMITS["standard"]
            said = f"differs by up to {100 * off.max():.2g} % ({FIVE[int(off.argmax())].replace('_', ' ')})"
            found[f"{published.sand} sand"] = f"{said}; {100 * limit:.2g} % are allowed"
            if not off.max() <= limit:
                wrong.append(f"{published.sand} sand {said}. Install numba and numpy anew.")
    cache = cache_folder()
    found["cache folder"] = cache or "none"
    if cache is None:
        wrong.append("No cache folder can be written. Set NUMBA_CACHE_DIR to one that can.")
    table = terminal.table(("", "found"), ("", "found"), rows=found.items())
    verdict = wrong or ["All is as it should be."]
    study.conclude("Is the installation sound?", [table], {"findings": found}, verdict)
    if wrong:
        raise FootoptError(f"study=doctor: {' '.join(wrong)}")
