"""The command `footopt`, and `python -m footopt`."""

import atexit
import gc
import os
import sys

from footopt import __version__


def main() -> None:
    """Load the command line and run it."""
    if "--version" in sys.argv[1:]:
        return print(f"footopt {__version__}")
    gc.set_threshold(500_000, 50, 50)  # a run makes few cycles: to look for them took a tenth of its time
    # a model's matrices are so small that a second thread costs more than it gives
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    atexit.register(gc.freeze)  # nor once more what the process ends with
    from footopt.cli.main import main as run

    run()


if __name__ == "__main__":
    main()
