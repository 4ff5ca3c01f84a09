"""The workbench: what all visitors begin with, and the server that they visit."""

from __future__ import annotations

import logging
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import viser

from ..exceptions import JobCancelledError, ViewgaugeError
from ..workflow import Inspection, Job, Stage, plan_again
from .guard import GuardedServer
from .visitor import Visitor

if TYPE_CHECKING:
    from ..workflow import Plan

__all__ = ["Workbench", "open_workbench"]

_log = logging.getLogger(__name__)

_AT_ONCE = 2
"""How many visitors' work runs at once; that of others waits."""


class Workbench:
    """A served inspection.

    Parameters
    ----------
    path
        The inspection file; its folder is the project's.
    plan
        To begin with; None to make one, in a child process, while visitors look at the part already.
    host, port
        As of :class:`~viewgauge.web.guard.GuardedServer`.

    Raises
    ------
    InputError
        If it cannot be served there.
    """

    def __init__(
        self, path: Path, inspection: Inspection, plan: Plan | None = None, *, host: str = "127.0.0.1", port: int = 8080
    ) -> None:
        self.inspection, self.plan = inspection, plan
        self.text = path.read_text(encoding="utf-8")
        self._project = path.resolve().parent
        self._visitors: dict[int, Visitor] = {}
        self._lock, self._turns = threading.Lock(), threading.BoundedSemaphore(_AT_ONCE)
        self._told: list[Callable[[Plan | Stage | ViewgaugeError], None]] = []
        self._last: Plan | Stage | ViewgaugeError | None = plan
        self._server = GuardedServer(host, port)
        self._server.scene.world_axes.visible = False
        self._server.on_client_connect(self._came)
        self._server.on_client_disconnect(self._went)
        self._job = None if plan is not None else Job(plan_again, inspection, watcher=self._tell)
        if self._job is not None:
            threading.Thread(target=self._wait, args=(self._job,), daemon=True).start()

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return self._server.address

    def tell_plan(self, listener: Callable[[Plan | Stage | ViewgaugeError], None]) -> None:
        """How far the first plan is, and then the plan, or why there is none, to one who wants to know."""
        with self._lock:
            self._told.append(listener)
            last = self._last
        if last is not None:
            listener(last)

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
                raise JobCancelledError("ended on request")
        try:
            yield
        finally:
            self._turns.release()

    def lend_files(self, folder: Path) -> None:
        """Copy the files that the inspection itself is made of into a folder, where they are not there already."""
        for name in self.inspection.inputs:
            source = (self._project / name).resolve()
            if source.is_file() and source.is_relative_to(self._project) and not (folder / name).exists():
                shutil.copyfile(source, folder / name)

    def close(self) -> None:
        """End everything."""
        if self._job is not None:
            self._job.cancel()
        for visitor in list(self._visitors.values()):
            visitor.close()
        self._server.stop()

    def _came(self, client: viser.ClientHandle) -> None:
        try:
            self._visitors[client.client_id] = Visitor(client, self)
        except Exception:
            _log.exception("the page of a visitor could not be made")
            client.add_notification("The page could not be made", "See the log of the workbench.", color="red")

    def _went(self, client: viser.ClientHandle) -> None:
        visitor = self._visitors.pop(client.client_id, None)
        if visitor is not None:
            with self._lock:
                self._told = [listener for listener in self._told if listener != visitor._first_plan]
            visitor.close()

    def _wait(self, job: Job[Plan]) -> None:
        try:
            self.plan = job.result()
            self._tell(self.plan)
        except JobCancelledError:
            pass
        except ViewgaugeError as error:
            self._tell(error)

    def _tell(self, outcome: Plan | Stage | ViewgaugeError) -> None:
        with self._lock:
            self._last, listeners = outcome, list(self._told)
        for listener in listeners:
            listener(outcome)


def open_workbench(
    path: str | Path, inspection: Inspection, plan: Plan | None = None, *, host: str = "127.0.0.1", port: int = 8080
) -> Workbench:
    """Serve an inspection; see :class:`Workbench`."""
    return Workbench(Path(path), inspection, plan, host=host, port=port)
