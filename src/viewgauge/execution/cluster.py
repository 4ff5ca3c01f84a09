"""Chunks on the workers of a Dask cluster. No other file of the package imports Dask, and none this one but on demand.

What all chunks share travels as a worker plugin: Dask's scheduler keeps it and gives it once to each worker, to those
also that join later or replace a lost one. (Scattered data is lost with the workers that hold it.) When a worker is
lost, Dask runs its chunks again elsewhere. A chunk whose workers were lost more than ``allowed-failures`` times
(Dask's configuration; 1 in a cluster started here, 3 by default) may be what kills them, or may have waited behind the
one that does: it is set aside until all others are done, and run once more with nothing beside it. If its workers are
lost again, it is to blame, and named when the others have had their turn, or two more are to blame.
"""

from __future__ import annotations

import itertools
import logging
import socket
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import metadata
from typing import Any, Generic, TypeVar
from urllib.parse import urlsplit

import dask
import distributed

from ..exceptions import InputError, ViewgaugeError
from .interrupts import interrupts_afterwards, interrupts_wait
from .worker_tasks import WorkerTask, deliver, other_version, own_version, withdraw

__all__ = ["Cluster", "local", "remote"]

Common = TypeVar("Common")
Item = TypeVar("Item")
Result = TypeVar("Result")

_CONNECT_S = 5.0
_FIRST_WORKER_S = 30.0
_ALL_LOST_S = 300.0  # without any worker, after which the job is given up
_COUNT_EVERY_S = 1.0  # between two counts of the workers
_RETRY_S = 0.2
_DELIVER_S = 60.0  # to give the workers what is common, while some of them are being lost
_GUILTY = 3  # items that end their workers, after which no more are tried
_AHEAD = 2  # chunks under way for each thread of the workers: one runs, one waits
_QUIET = ("distributed", "distributed.client", "distributed.nanny", "distributed.scheduler", "distributed.worker")
_THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_LOCAL_CONFIGURATION = {
    "distributed.nanny.pre-spawn-environ": dict.fromkeys(_THREADS, "1"),
    "distributed.scheduler.allowed-failures": 1,
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


@contextmanager
def local(workers: int) -> Iterator[Cluster]:
    """A cluster of processes on this machine, of one thread each, reached from this machine only.

    Raises
    ------
    InputError
        If the processes do not start.
    """
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        stack.enter_context(dask.config.set(_LOCAL_CONFIGURATION))
        with interrupts_wait():
            try:
                cluster = distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",  # Dask opens a port in any case: a free one, nothing behind it
                    scheduler_kwargs={"dashboard": False},
                    memory_limit=0,  # chunks are small; Dask would write results to disk, and pause and kill workers
                    silence_logs=logging.CRITICAL,
                )
            except (OSError, RuntimeError) as error:
                raise InputError(
                    "the worker processes do not start",
                    key="workers",
                    got=f"{workers}; {error}",
                    hint='in a script, put what is run below if __name__ == "__main__":',
                ) from error
            stack.enter_context(cluster)
        yield Cluster(stack.enter_context(distributed.Client(cluster, set_as_default=False)))


@contextmanager
def remote(scheduler: str) -> Iterator[Cluster]:
    """The cluster of a running scheduler.

    Raises
    ------
    InputError
        If the scheduler cannot be reached, or its workers are missing or do not have this
        version of viewgauge.
    """
    with _quiet():
        try:
            _knock(scheduler)
            client = distributed.Client(scheduler, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(
                "the scheduler cannot be reached",
                key="scheduler",
                got=f"{scheduler!r}; {error}",
                expected="the address of a running Dask scheduler, such as tcp://10.0.0.5:8786",
                hint="start one with: dask scheduler; and its workers with: dask worker ADDRESS --nthreads 1",
            ) from error
        with client:
            _require_equals(client, scheduler)
            yield Cluster(client)


def _knock(scheduler: str) -> None:
    """Raise OSError or ValueError where nothing can be at an address: at once, and before Dask starts its threads."""
    parts = urlsplit(scheduler if "://" in scheduler else f"tcp://{scheduler}")
    if not parts.hostname or not parts.port or parts.scheme not in ("tcp", "tls", "ws", "wss", "ucx"):
        raise ValueError("not an address")
    if parts.scheme != "ucx":
        with socket.create_connection((parts.hostname, parts.port), timeout=_CONNECT_S) as connection:
            if parts.scheme == "tcp":  # where a Dask scheduler speaks first, and waits for no answer
                connection.settimeout(_CONNECT_S)
                if not connection.recv(1):
                    raise OSError("it closes the connection")


class Cluster:
    """Runs chunks on the workers of a cluster; see :class:`~viewgauge.execution.executor.Executor`.

    At most two chunks for each thread of the workers that are there now are under way or unread.
    """

    def __init__(self, client: distributed.Client) -> None:
        self._client = client

    def run(
        self, function: Callable[[Common, Item], Result], common: Common, items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield ``(index, function(common, items[index]))`` as soon as each is there, in any order.

        Raises
        ------
        ViewgaugeError
            If an item kills its workers, all workers stay away, or the connection is lost; besides, whatever the
            function raises.
        """
        if not len(items):
            return
        job = _ClusterRun(self._client, uuid.uuid4().hex, items)
        name = f"viewgauge-{job.token}"
        try:
            with _connection():
                self._deliver(_Delivery(job.token, function, common), name)
            yield from job.results()
        finally:
            job.cancel()
            with suppress(Exception):  # the scheduler may be gone, and what is raised already tells why
                self._client.unregister_worker_plugin(name)

    def _deliver(self, delivery: _Delivery, name: str) -> None:
        """Give the workers what is common; one that is lost meanwhile is no reason to give up."""
        deadline = time.monotonic() + _DELIVER_S
        while True:
            try:
                self._client.register_plugin(delivery, name=name)
            except (OSError, RuntimeError):  # of a worker that the scheduler does not yet know to be lost, or its own
                self._client.nthreads()  # raises where the scheduler is gone
                if time.monotonic() > deadline:
                    raise
                time.sleep(_RETRY_S)
            else:
                return


@contextmanager
def _connection() -> Iterator[None]:
    """The errors that Dask has where its scheduler is gone as one that tells so."""
    try:
        yield
    except (distributed.CancelledError, OSError, RuntimeError) as error:  # the last: "ConnectionPool is closed"
        raise ViewgaugeError(
            "the connection to the Dask scheduler is lost\n"
            "  hint:     start the scheduler and its workers, then the job again: it goes on from what it has kept"
        ) from error


class _ClusterRun(Generic[Item]):
    """The chunks of one call: which are under way, which are yet to be sent, which may kill their workers."""

    def __init__(self, client: distributed.Client, token: str, items: Sequence[Item]) -> None:
        self.token = token
        self._client = client
        self._items = items
        self._waiting = iter(range(len(items)))
        self._under_way: dict[Any, int] = {}
        self._suspects: deque[int] = deque()
        self._accused: int | None = None
        self._guilty: list[int] = []
        self._attempts = itertools.count()
        self._threads = 1
        self._counted = self._seen_workers = float("-inf")

    def results(self) -> Iterator[tuple[int, Any]]:
        self._seen_workers = time.monotonic()
        while True:
            with _connection(), interrupts_afterwards():
                outcomes = self._outcomes()
            if outcomes is None:
                if self._guilty:
                    raise self._reported()
                return
            for index, error, traceback, result in outcomes:
                if error is None:
                    yield index, result
                elif isinstance(error, distributed.KilledWorker):
                    self._suspect(index)
                elif isinstance(error, ViewgaugeError):
                    raise error.with_traceback(None)  # a message for people, without its way through the worker
                else:
                    raise error.with_traceback(traceback)

    def _outcomes(self) -> list[tuple[int, Any, Any, Any]] | None:
        """Index, error, its traceback and result of what is done: something, unless nothing was for a while; or None.

        None: all is done. No future lives on, as its end is a message to the scheduler.
        """
        if not self._send():
            return None
        outcomes = []
        for future in self._done():
            index, error = self._under_way.pop(future), future.exception()
            outcomes.append((index, error, future.traceback(), future.result() if error is None else None))
        return outcomes

    def cancel(self) -> None:
        """Take back what is under way; what a worker is at, it ends."""
        with suppress(Exception):
            if self._under_way:
                self._client.cancel(list(self._under_way))
        self._under_way.clear()

    def _send(self) -> bool:
        """Send as many chunks as the workers are ready for; whether any is under way."""
        self._count_workers()
        while len(self._under_way) < _AHEAD * self._threads:
            index = next(self._waiting, None)
            if index is None:
                break
            self._submit(index)
        if not self._under_way and self._suspects:
            self._accused = self._suspects.popleft()
            self._submit(self._accused)
        return bool(self._under_way)

    def _submit(self, index: int) -> None:
        task = WorkerTask(self.token, own_version(), self._items[index])
        key = f"viewgauge-{self.token}-{index}-{next(self._attempts)}"
        self._under_way[self._client.submit(task, key=key, pure=False)] = index

    def _done(self) -> list[Any]:
        """Futures that are done: at least one, unless there was none for a while."""
        with suppress(distributed.TimeoutError), self._client.as_current():
            distributed.wait(list(self._under_way), timeout=_COUNT_EVERY_S, return_when="FIRST_COMPLETED")
        return [future for future in self._under_way if future.done()]

    def _count_workers(self) -> None:
        now = time.monotonic()
        if now - self._counted < _COUNT_EVERY_S:
            return
        threads = sum(self._client.nthreads().values())
        self._counted, self._threads = now, max(threads, 1)
        if threads:
            self._seen_workers = now
        elif now - self._seen_workers > _ALL_LOST_S:
            raise ViewgaugeError(f"all workers are lost, and none came for {_ALL_LOST_S:g} s")

    def _suspect(self, index: int) -> None:
        """One that waited behind another at a lost worker is as suspect: the rest have their turn before it is told."""
        if index != self._accused:
            self._suspects.append(index)
            return
        self._guilty.append(index)
        if len(self._guilty) == _GUILTY:
            raise self._reported()

    def _reported(self) -> ViewgaugeError:
        first, others = self._guilty[0], len(self._guilty) - 1
        rest = f"so did {others} others" if others else "all others are done"
        return ViewgaugeError(
            f"item {first} of {len(self._items)} ({_short(self._items[first])}) ended the worker process each time "
            f"it was tried; {rest}\n  hint:     give the workers more memory, or the job smaller chunks"
        )


class _Delivery(distributed.WorkerPlugin):  # type: ignore[misc] # Dask's types are not read
    """Brings function and what is common to a worker, and takes them away with the job."""

    def __init__(self, token: str, function: Callable[[Any, Any], Any], common: Any) -> None:
        self._token = token
        self._content = function, common

    def setup(self, worker: Any) -> None:  # noqa: ARG002 - the base class's
        deliver(self._token, self._content)

    def teardown(self, worker: Any) -> None:  # noqa: ARG002 - the base class's
        withdraw(self._token)


def _require_equals(client: distributed.Client, scheduler: str) -> None:
    """Raise InputError for a cluster without workers, or with another version of viewgauge anywhere in it."""
    try:
        client.wait_for_workers(1, timeout=_FIRST_WORKER_S)
    except TimeoutError as error:
        raise InputError(
            "the scheduler has no workers",
            key="scheduler",
            got=scheduler,
            hint=f"start some with: dask worker {scheduler} --nthreads 1",
        ) from error
    # a function of the standard library, which needs no viewgauge there
    found: dict[str, object] = client.run(metadata.version, "viewgauge", on_error="return")
    try:
        found["the scheduler"] = client.run_on_scheduler(metadata.version, "viewgauge")
    except metadata.PackageNotFoundError as error:
        found["the scheduler"] = error
    for place, version in found.items():
        if isinstance(version, OSError):  # lost meanwhile
            continue
        if version != own_version():
            reported = "none" if isinstance(version, metadata.PackageNotFoundError) else str(version)
            raise other_version(own_version(), f"{place}: {reported}")


def _short(item: object) -> str:
    text = repr(item)
    return text if len(text) <= 80 else f"{text[:77]}..."


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask's loggers are silent: what matters is raised."""
    loggers = [logging.getLogger(name) for name in _QUIET]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
