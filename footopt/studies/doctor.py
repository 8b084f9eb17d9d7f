"""Is the installation sound? Versions, processor, cache folder, and a walk whose numbers are published."""

import numpy as np

from footopt.compiled import cache_folder, target
from footopt.errors import FootoptError
from footopt.files import identity
from footopt.report import terminal
from footopt.sand import Sand
from footopt.studies.runs import Study
from footopt.walk import FIVE, Scene, evaluate
from footopt.walk.accuracy import TOLERANCES
from footopt.walk.batch import available_threads

#: Heights of a foot's waypoints, and the five objectives that another program, written apart from this one,
#: found for it on each sand: the law in its angles, LSODA, 100 chords for plates, a creep speed of 1e-5 m/s.
RAMP = (1, 2, 3, 4, 5, 6, 7, 8, 8, 8, 8)
PUBLISHED = {
    "soft": (1.84941, 0.76065, 684.635, 606.292, 0.17711),
    "regular": (2.08141, 0.88027, 364.225, 364.768, 0.23598),
    "hard": (2.16852, 0.91860, 148.094, 502.316, 0.29326),
}


def run(study: Study) -> None:
    """List what footopt runs on, and hold a walk on each sand against an independent program's."""
    found = {
        **identity.versions(),
        "processor": f"{target()['processor']}, {available_threads()} threads",
    }
    wrong = []
    with study.compiling():
        for sand, published in PUBLISHED.items():
            walked = evaluate([RAMP], Scene(sand=Sand.named(sand)), threads=1).values[0]
            off, limit = np.abs(walked / np.array(published) - 1.0), TOLERANCES["standard"]
            said = f"differs by up to {100 * off.max():.2g} % ({FIVE[int(off.argmax())].replace('_', ' ')})"
            found[f"{sand} sand"] = f"{said}; {100 * limit:.2g} % are allowed"
            if not off.max() <= limit:
                wrong.append(f"{sand} sand {said}. Install numba and numpy anew.")
    cache = cache_folder()
    found["cache folder"] = cache or "none"
    if cache is None:
        wrong.append("No cache folder can be written. Set NUMBA_CACHE_DIR to one that can.")
    table = terminal.table(("", "found"), ("", "found"), rows=found.items())
    verdict = wrong or ["All is as it should be."]
    study.conclude("Is the installation sound?", [table], {"findings": found}, verdict)
    if wrong:
        raise FootoptError(f"study=doctor: {' '.join(wrong)}")
