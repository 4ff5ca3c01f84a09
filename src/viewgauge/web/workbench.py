"""The workbench: the server of an inspection, and its visitors."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING

from .guard import GuardedServer
from .project import Project
from .visitor import Visitor

if TYPE_CHECKING:
    import viser

    from ..planning import Plan
    from ..planning.inspection import Inspection

__all__ = ["Workbench", "open_workbench"]

_log = logging.getLogger(__name__)


class Workbench:
    """A served project.

    Parameters
    ----------
    host, port
        As of :class:`~viewgauge.web.guard.GuardedServer`.

    Raises
    ------
    InputError
        If it cannot be served there.
    """

    def __init__(self, project: Project, *, host: str = "127.0.0.1", port: int = 8080) -> None:
        self.project = project
        self._visitors: dict[int, Visitor] = {}
        self._server = GuardedServer(host, port)
        self._server.scene.world_axes.visible = False
        self._server.on_client_connect(self._connect)
        self._server.on_client_disconnect(self._disconnect)

    @property
    def address(self) -> str:
        """What to open in a browser."""
        return self._server.address

    def close(self) -> None:
        """End everything."""
        self.project.close()
        for visitor in list(self._visitors.values()):
            visitor.close()
        self._server.stop()

    def _connect(self, client: viser.ClientHandle) -> None:
        try:
            self._visitors[client.client_id] = Visitor(client, self.project)
        except Exception:
            _log.exception("the page of a visitor could not be made")
            client.add_notification("The page could not be made", "See the log of the workbench.", color="red")

    def _disconnect(self, client: viser.ClientHandle) -> None:
        visitor = self._visitors.pop(client.client_id, None)
        if visitor is not None:
            visitor.close()


def open_workbench(
    path: str | Path, inspection: Inspection, plan: Plan | None = None, *, host: str = "127.0.0.1", port: int = 8080
) -> Workbench:
    """Serve an inspection file; see :class:`Project` and :class:`Workbench`."""
    project = Project(Path(path), inspection, plan)
    try:
        return Workbench(project, host=host, port=port)
    except BaseException:
        project.close()
        raise
