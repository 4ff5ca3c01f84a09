"""When an interrupt from the keyboard reaches a process that has worker processes."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any

__all__ = ["interrupts_afterwards", "interrupts_wait"]


@contextmanager
def interrupts_wait() -> Iterator[None]:
    """SIGINT waits until the block ends, and reaches no process that Dask starts from here, now or later.

    A terminal sends it to all processes of a job. A worker would tell of it with a traceback, its own and each that
    takes its place; this process ends its workers in any case. Threads inherit what is blocked, and so do processes
    from the thread that starts them: Dask's threads begin in the block, and all workers from them.
    """
    if not hasattr(signal, "pthread_sigmask"):  # not a POSIX system
        yield
        return
    resource_tracker.ensure_running()  # whoever starts it unblocks SIGINT, later it would be one of Dask's threads
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def interrupts_afterwards() -> Iterator[None]:
    """SIGINT is raised when the block ends: inside Dask it may meet a destructor, where Python tells and forgets it."""
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    came: list[Any] = []
    signal.signal(signal.SIGINT, lambda *what: came.append(what))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if came:
        before(*came[0])
