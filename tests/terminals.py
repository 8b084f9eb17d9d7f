"""A terminal of a given size to run a program on, and what it wrote there."""

import contextlib
import fcntl
import os
import pty
import select
import struct
import subprocess
import termios
import time

from running import environment as variables


def on_a_terminal(command, columns=80, timeout=60, cwd=None, **environment):
    """Everything that a command writes to its terminal, and its exit code.

    `environment` replaces or, where None, removes variables.
    """
    unset = dict.fromkeys(("NO_COLOR", "FORCE_COLOR", "COLUMNS", "LINES"))
    env = variables(**(unset | {"TERM": "xterm-256color"} | environment))
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, cwd=cwd, env=env) as run:
        os.close(theirs)
        parts, end = [], time.monotonic() + timeout
        with contextlib.suppress(OSError):  # how a terminal ends on Linux
            while time.monotonic() < end:
                if select.select([ours], [], [], 0.1)[0]:
                    if not (part := os.read(ours, 65536)):
                        break
                    parts.append(part)
        os.close(ours)
        if time.monotonic() >= end:
            run.kill()
        code = run.wait(timeout=10)
    return b"".join(parts).decode(), code
