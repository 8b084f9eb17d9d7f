"""The command `footopt`, and `python -m footopt`: what loads the program can be stopped, too."""

from __future__ import annotations

import io
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
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal may lack the letters of a folder's name
            stream.reconfigure(errors="backslashreplace")
    _check_variables()
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


def _check_variables() -> None:
    """Mend or refuse variables of the environment with which a library could not be loaded, or would fail."""
    # figures are drawn without a backend, and matplotlib is not imported where it knows none of the name
    os.environ.pop("MPLBACKEND", None)
    for name, least, most in (("SOURCE_DATE_EPOCH", 0, 10**11), ("NUMBA_NUM_THREADS", 1, 10**4)):
        value = os.environ.get(name, "1")  # matplotlib puts the first into PDFs, and numpy reads it
        if not value:
            del os.environ[name]
        elif not (value.isdecimal() and least <= int(value) <= most):
            what = "a number of seconds" if least == 0 else "a whole number > 0"
            sys.exit(f"footopt: error: {name} = {value!r}: must be {what}, or unset.")
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        sys.exit("footopt: error: NUMBA_DISABLE_JIT is set, and the walk is always compiled. Unset it.")


def _stop(signum: int, frame: FrameType | None) -> None:
    os.write(2, b"footopt: stopped\n")
    os._exit(130)


if __name__ == "__main__":
    main()
