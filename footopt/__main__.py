"""The command `footopt`, and `python -m footopt`: what loads the program can be stopped, too."""

from __future__ import annotations

import os
import sys

from footopt import TYPE_CHECKING, __version__

if TYPE_CHECKING:
    from types import FrameType

signal = sys.modules["_signal"]  # there before any import; `signal` itself first makes enumerations
NEEDED = 700  # MB of address space, for the libraries and a small run


def main() -> None:
    """Load the command line and run it. Before and after the run itself, Ctrl-C ends it at once."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where it is to be ignored
        signal.signal(signal.SIGINT, _stop)
    if os.name == "posix":
        import resource

        if 0 <= (limit := resource.getrlimit(resource.RLIMIT_AS)[0]) < NEEDED << 20:  # OpenBLAS may hang then
            sys.exit(
                f"footopt: error: `ulimit -v` allows {limit >> 20} MB of address space; {NEEDED} are needed."
            )
    if "--version" in sys.argv[1:]:
        return print(f"footopt {__version__}")
    import gc

    gc.set_threshold(100_000, 50, 50)  # a run makes few cycles: to look for them took a tenth of its time
    # figures are drawn without a backend, and matplotlib is not imported where it knows none of the name
    os.environ.pop("MPLBACKEND", None)
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")  # matplotlib puts it into PDFs, and numpy reads it
    if not epoch:
        del os.environ["SOURCE_DATE_EPOCH"]
    elif not (epoch.isdecimal() and len(epoch) < 12):
        sys.exit(f"footopt: error: SOURCE_DATE_EPOCH = {epoch!r}: must be a number of seconds, or unset.")
    try:
        from footopt.cli.main import main as run
    except (OSError, MemoryError, ImportError) as error:  # too few files, too little memory, a library gone
        if os.environ.get("HYDRA_FULL_ERROR") == "1":
            raise
        sys.exit(f"footopt: error: the program cannot be loaded ({type(error).__name__}: {error}).")
    try:
        run()
    finally:
        gc.freeze()  # nor are there cycles to look for at its end, which took as long
        exec("")  # else Python ends by SIGINT, not the exit code, once Ctrl-C has fallen into any `exec`


def _stop(signum: int, frame: FrameType | None) -> None:
    os.write(2, b"footopt: stopped\n")
    os._exit(130)


if __name__ == "__main__":
    main()
