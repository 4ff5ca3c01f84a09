"""Scratch folders beside an output: each is of one process, and those of killed processes are taken away."""

from __future__ import annotations

import hashlib
import os
import shutil
import socket
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

__all__ = ["make_scratch"]


def make_scratch(parent: Path) -> Path:
    """A new folder in ``parent`` for this process; raises OSError where none can be made.

    Folders that processes of this machine left there when they were killed are taken away first.
    """
    own = f".viewgauge-{_machine()}-"
    for left in parent.glob(f"{own}*"):
        process = left.name.removeprefix(own).partition("-")[0]
        if process.isdecimal() and not _runs(int(process)):
            shutil.rmtree(left, ignore_errors=True)
    return Path(tempfile.mkdtemp(prefix=f"{own}{os.getpid()}-", dir=parent))


@cache
def _machine() -> str:
    """This machine, and on Linux what its numbers of processes are of (a container has its own)."""
    numbers = ""
    with suppress(OSError):
        numbers = os.readlink("/proc/self/ns/pid")
    return hashlib.sha256(f"{socket.gethostname()} {numbers}".encode()).hexdigest()[:12]


def _runs(process: int) -> bool:
    """Whether a process of this machine runs; so it counts where nobody can tell."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
