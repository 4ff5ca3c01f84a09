"""Work in a child process that reports how far it is, and that can be ended at any moment."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

from ..exceptions import JobCancelledError, ViewgaugeError
from .progress import Progress

__all__ = ["Job", "Stage"]

_Result = TypeVar("_Result")
_Arguments = ParamSpec("_Arguments")

_REPORT_EVERY_S = 0.1
_GRACE_S = 1.0


@dataclass(frozen=True)
class Stage:
    """How far the work is: a stage by name, and what is done of its total, where that is known."""

    name: str
    done: int = 0
    total: int | None = None

    @property
    def share(self) -> float | None:
        """From 0 to 1; None where the total is not known."""
        return None if not self.total else min(self.done / self.total, 1.0)


class Job(Generic[_Result]):
    """A function that runs in a child process, started at once.

    Parameters
    ----------
    work
        A function of a module, which takes a :class:`~viewgauge.execution.progress.Progress` first; it and its
        arguments go to the child pickled, its result, or the error it raises, comes back so.
    watcher
        Called from another thread with each :class:`Stage`.
    memory_bytes
        Limit of the child's address space (POSIX only); None for none.
    timeout_s
        Seconds after which it is ended; None for never.
    """

    def __init__(
        self,
        work: Callable[Concatenate[Progress, _Arguments], _Result],
        *arguments: Any,
        watcher: Callable[[Stage], object] | None = None,
        memory_bytes: int | None = None,
        timeout_s: float | None = None,
    ) -> None:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe(duplex=False)
        self._process: BaseProcess = context.Process(
            target=_run, args=(theirs, memory_bytes, work, arguments), daemon=True
        )
        self._process.start()
        theirs.close()
        self._watcher, self._outcome = watcher, _ChildResult[_Result]()
        self._cancelled, self._over = threading.Event(), threading.Event()
        self._deadline = None if timeout_s is None else time.monotonic() + timeout_s
        self._timeout_s = timeout_s
        threading.Thread(target=self._listen, args=(ours,), daemon=True).start()

    @property
    def running(self) -> bool:
        """Whether it is neither done nor ended."""
        return not self._over.is_set()

    def cancel(self) -> None:
        """End it now; :meth:`result` then raises :class:`JobCancelledError`. Nothing happens where it is over."""
        self._cancelled.set()

    def result(self) -> _Result:
        """What the function returned, once it has.

        Raises
        ------
        JobCancelledError
            If it was cancelled.
        ViewgaugeError
            What the function raised, or that it took too long, or that the child crashed.
        """
        self._over.wait()
        return self._outcome.value()

    def _listen(self, connection: Connection) -> None:
        try:
            self._outcome = self._heard(connection)
        finally:
            if self._process.is_alive():
                self._process.terminate()  # which lets it end what it has started itself
                self._process.join(_GRACE_S)
            if self._process.is_alive():
                self._process.kill()
            self._process.join()
            connection.close()
            self._over.set()

    def _heard(self, connection: Connection) -> _ChildResult[_Result]:
        """Listens until there is an outcome."""
        while True:
            if self._cancelled.is_set():
                return _ChildResult(error=JobCancelledError("ended on request"))
            if self._deadline is not None and time.monotonic() > self._deadline:
                return _ChildResult(error=ViewgaugeError(f"it took longer than {self._timeout_s:g} s"))
            try:
                if not connection.poll(_REPORT_EVERY_S):
                    continue
                kind, content = connection.recv()
            except (EOFError, OSError):
                self._process.join()
                return _ChildResult(error=ViewgaugeError(f"the work crashed (exit code {self._process.exitcode})"))
            if kind == "stage":
                if self._watcher is not None:
                    self._watcher(content)
            else:
                return _ChildResult(error=content) if kind == "error" else _ChildResult(result=(content,))


@dataclass(frozen=True)
class _ChildResult(Generic[_Result]):
    """What a child process has returned, or the error it has ended with."""

    result: tuple[_Result] | None = None
    error: BaseException | None = None

    def value(self) -> _Result:
        if self.result is None:
            raise self.error or ViewgaugeError("the work did not end")
        return self.result[0]


class _Reporter:
    """Reports stages to the parent, but not more often than they can be shown."""

    def __init__(self, connection: Connection) -> None:
        self._connection, self._last = connection, 0.0

    @contextmanager
    def stage(self, name: str, total: int | None = None) -> Iterator[Callable[[int], None]]:
        done = 0

        def advance(some: int) -> None:
            nonlocal done
            done += some
            if time.monotonic() - self._last > _REPORT_EVERY_S:
                self._report(Stage(name, done, total))

        self._report(Stage(name, 0, total))
        yield advance

    def _report(self, stage: Stage) -> None:
        self._last = time.monotonic()
        with contextlib.suppress(OSError):  # nobody listens any more
            self._connection.send(("stage", stage))


def _run(
    connection: Connection, memory_bytes: int | None, work: Callable[..., object], arguments: tuple[Any, ...]
) -> None:
    """What the child process does."""
    if memory_bytes is not None and os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent says when to end
    outcome: tuple[str, object]
    try:
        outcome = ("result", work(_Reporter(connection), *arguments))
    except ViewgaugeError as error:
        outcome = ("error", error)
    except MemoryError:
        outcome = ("error", ViewgaugeError("it needs more memory than it is allowed"))
    except Exception as error:  # a defect of ours must not end the page: it is reported as one
        outcome = ("error", ViewgaugeError(f"an unexpected error: {type(error).__name__}: {error}"))
    with contextlib.suppress(OSError):
        connection.send(outcome)
