"""What a worker of a cluster does with a chunk, and with what all chunks of a job share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

from ..exceptions import InputError, ViewgaugeError

__all__ = ["WorkerTask", "deliver", "other_version", "own_version", "withdraw"]

_COMMON_S = 120.0  # for what is common to arrive at a worker that joined

_DELIVERIES: dict[str, tuple[Callable[[Any, Any], Any], Any] | None] = {}  # by the job's token; None: it has ended
_ARRIVAL = threading.Condition()


def deliver(token: str, content: tuple[Callable[[Any, Any], Any], Any]) -> None:
    """Keep the function of a job and what its chunks share, on this worker."""
    with _ARRIVAL:
        _DELIVERIES[token] = content
        _ARRIVAL.notify_all()


def withdraw(token: str) -> None:
    """Note that a job has ended, on this worker."""
    with _ARRIVAL:
        _DELIVERIES[token] = None
        _ARRIVAL.notify_all()


@dataclass(frozen=True)
class WorkerTask:
    """One chunk as it travels: Dask looks for no futures in it."""

    token: str
    version: str
    item: Any

    def __call__(self) -> Any:
        if self.version != own_version():
            raise other_version(self.version, f"a worker: {own_version()}")
        function, common = _delivered(self.token)
        return function(common, self.item)


def _delivered(token: str) -> tuple[Callable[[Any, Any], Any], Any]:
    """Function and what is common; a worker that has just joined can get its first chunk before them."""
    with _ARRIVAL:
        _ARRIVAL.wait_for(lambda: token in _DELIVERIES, _COMMON_S)
        delivery = _DELIVERIES.get(token)
    if delivery is None:
        raise ViewgaugeError("a worker did not get what all chunks share, or was late: the job had ended")
    return delivery


def other_version(expected: str, got: str) -> InputError:
    """What a cluster with another version of viewgauge somewhere is refused with."""
    return InputError(
        "all parts of the cluster need the same version of viewgauge",
        key="scheduler",
        got=got,
        expected=f"{expected}, as here",
        hint=f"install viewgauge {expected} for the scheduler and its workers, and start them again",
    )


@cache
def own_version() -> str:
    """The version of viewgauge in this process."""
    return metadata.version("viewgauge")
