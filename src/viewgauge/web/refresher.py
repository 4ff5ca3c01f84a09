"""Does again what is asked for, in a thread of its own: what is asked for meanwhile is done once."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping

__all__ = ["Refresher"]

_log = logging.getLogger(__name__)


class Refresher:
    """Runs named steps in their order when they are asked for.

    Parameters
    ----------
    steps
        In the order in which they are done.
    patient
        Names of steps that wait until nothing new has been asked for so long, s.
    failed
        Told of an error, which ends nothing.
    """

    def __init__(
        self,
        steps: Mapping[str, Callable[[], None]],
        patient: frozenset[str],
        failed: Callable[[Exception], None],
        quiet_s: float = 0.15,
    ) -> None:
        self._steps, self._patient, self._failed, self._quiet_s = dict(steps), patient, failed, quiet_s
        self._asked: set[str] = set()
        self._last, self._closed = 0.0, False
        self._change = threading.Condition()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def ask(self, *names: str) -> None:
        """Ask for steps; returns at once."""
        with self._change:
            self._asked.update(names)
            self._last = time.monotonic()
            self._change.notify()

    def close(self) -> None:
        """Do nothing more."""
        with self._change:
            self._closed = True
            self._change.notify()

    def _run(self) -> None:
        while (name := self._next()) is not None:
            try:
                self._steps[name]()
            except Exception as error:
                _log.exception("the step %s failed", name)
                self._failed(error)

    def _next(self) -> str | None:
        """The next step that is due; None at the end."""
        with self._change:
            while not self._closed:
                wait = self._last + self._quiet_s - time.monotonic()
                for name in self._steps:
                    if name in self._asked and (name not in self._patient or wait <= 0):
                        self._asked.discard(name)
                        return name
                self._change.wait(max(wait, 0.001) if self._asked else None)
            return None
