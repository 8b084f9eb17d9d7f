"""Work that leaves nothing but files, such as drawing figures, on several processors at once."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

Job = Callable[[], object]
PATIENCE = 120  # s until a copy ends that hangs, as with a lock that a thread of the process held


@contextmanager
def together(jobs: Sequence[Job], most: int) -> Iterator[None]:
    """Do jobs that leave nothing but files: in copies of this process while a block runs, and here after it.

    A copy knows all that this process knows, and needs no time to start. There is one only where it is safe:
    on Linux, of a process that has no other threads of Python's. What a copy could not do is done here, so
    that whatever went wrong there is raised here.

    Parameters
    ----------
    jobs : sequence of functions
        None needs what another one does; 256 at most.
    most : int
        Processes at once, with this one.
    """
    turns, numbers = os.pipe()  # each process takes the number of its next job from here
    os.write(numbers, bytes(range(len(jobs))))
    os.close(numbers)
    copies, here = list[int](), set[int]()
    try:
        if sys.platform == "linux" and threading.active_count() == 1:
            with suppress(OSError):  # no more processes, or no memory for them
                copies += (_copy(jobs, turns) for _ in range(min(most, len(jobs)) - 1))
        yield
        while number := os.read(turns, 1):
            jobs[number[0]]()
            here |= {*number}
    finally:
        os.read(turns, 256)  # after an error, or Ctrl-C, nobody begins another job
        os.close(turns)
        failed = [copy for copy in copies if os.waitpid(copy, 0)[1]]
    for number in {*range(len(jobs))} - here if failed else ():
        jobs[number]()


def _copy(jobs: Sequence[Job], turns: int) -> int:
    """Do jobs in a copy of this process as long as there are some; its number."""
    with warnings.catch_warnings():
        # Python 3.12 warns of any thread: those that are left are of libraries such as BLAS, made for copies
        warnings.simplefilter("ignore", DeprecationWarning)
        copy = os.fork()
    if copy:
        return copy
    status = 1
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process itself says that it was stopped
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(PATIENCE)
        while number := os.read(turns, 1):
            jobs[number[0]]()
        status = 0
    finally:
        os._exit(status)  # no word about an error: it comes again where the job is done again
