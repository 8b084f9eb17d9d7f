"""The command `footopt`, and `python -m footopt`: what loads the program can be stopped, too."""

from __future__ import annotations

import gc
import signal
import sys

from footopt import __version__


def main() -> None:
    """Load the command line and run it. Before and after the run itself, Ctrl-C ends it at once."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where it is to be ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if "--version" in sys.argv[1:]:
        return print(f"footopt {__version__}")
    gc.set_threshold(100_000, 50, 50)  # a run makes few cycles: to look for them took a tenth of its time
    from footopt.cli.main import main as run

    run()


if __name__ == "__main__":
    main()
