"""What all visitors of the workbench share: the inspection, its files, the first plan, and turns for long work."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from ..exceptions import JobCancelledError, ViewgaugeError
from ..execution.child_process import Job, Stage
from ..jobs.workbench.child_jobs import plan_again
from ..planning import Plan
from ..planning.inspection import Inspection

__all__ = ["PlanListener", "Project"]

PlanListener = Callable[[Plan | Stage | ViewgaugeError], None]
"""Receives how far the first plan is, and then the plan, or why there is none."""

_AT_ONCE = 2
"""How many visitors' work runs at once; that of others waits."""


class Project:
    """An inspection file that is served.

    Parameters
    ----------
    path
        The inspection file; its folder is the project's.
    plan
        The plan to begin with; None to make one in a child process while visitors look at the part already.
    """

    def __init__(self, path: Path, inspection: Inspection, plan: Plan | None = None) -> None:
        self.inspection, self.plan = inspection, plan
        self.text = path.read_text(encoding="utf-8")
        self._folder = path.resolve().parent
        self._lock, self._turns = threading.Lock(), threading.BoundedSemaphore(_AT_ONCE)
        self._listeners: list[PlanListener] = []
        self._last: Plan | Stage | ViewgaugeError | None = plan
        self._job = None if plan is not None else Job(plan_again, inspection, watcher=self._report)
        if self._job is not None:
            threading.Thread(target=self._wait, args=(self._job,), daemon=True).start()

    def follow_plan(self, listener: PlanListener) -> None:
        """Report the first plan to a listener, beginning with how far it is now."""
        with self._lock:
            self._listeners.append(listener)
            last = self._last
        if last is not None:
            listener(last)

    def leave_plan(self, listener: PlanListener) -> None:
        """Report to a listener no more."""
        with self._lock:
            self._listeners = [other for other in self._listeners if other != listener]

    @contextmanager
    def turn(self, ended: threading.Event) -> Iterator[None]:
        """One of the few pieces of work that run at once; waits for one.

        Raises
        ------
        JobCancelledError
            If ``ended`` is set meanwhile.
        """
        while not self._turns.acquire(timeout=0.1):
            if ended.is_set():
                raise JobCancelledError("the work was cancelled")
        try:
            yield
        finally:
            self._turns.release()

    def lend_files(self, folder: Path) -> None:
        """Copy the files that the inspection itself is made of into a folder, where they are not there already."""
        for name in self.inspection.inputs:
            source = (self._folder / name).resolve()
            if source.is_file() and source.is_relative_to(self._folder) and not (folder / name).exists():
                shutil.copyfile(source, folder / name)

    def close(self) -> None:
        """End the first plan if it is still being made."""
        if self._job is not None:
            self._job.cancel()

    def _wait(self, job: Job[Plan]) -> None:
        try:
            self.plan = job.result()
            self._report(self.plan)
        except JobCancelledError:
            pass
        except ViewgaugeError as error:
            self._report(error)

    def _report(self, outcome: Plan | Stage | ViewgaugeError) -> None:
        with self._lock:
            self._last, listeners = outcome, list(self._listeners)
        for listener in listeners:
            listener(outcome)
