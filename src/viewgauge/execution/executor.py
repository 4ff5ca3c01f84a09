"""Where the chunks of a long job run: in this process, or on the workers of a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

from ..exceptions import InputError

__all__ = ["Executor", "InProcess", "open_executor"]

Common = TypeVar("Common")
Item = TypeVar("Item")
Result = TypeVar("Result")


class Executor(Protocol):
    """Runs a function on many items."""

    def run(
        self, function: Callable[[Common, Item], Result], common: Common, items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """Yield ``(index, function(common, items[index]))`` as soon as each is there, in any order.

        No more than a few results for each worker are under way or wait to be taken, however many items there are:
        who takes no result holds up the work. An exception of the function is raised here, and ends the work.

        Parameters
        ----------
        function
            Without effects beyond its result that a second call with the same arguments would not repeat: what a
            lost worker was at is run again. With a cluster, importable by the workers.
        common
            What all calls share (a frozen dataclass of arrays); it goes to each worker once.
        items
            What tells the calls apart; small.
        """
        ...


class InProcess:
    """One item after the other in this process; the function uses what threads it wants."""

    def run(
        self, function: Callable[[Common, Item], Result], common: Common, items: Sequence[Item]
    ) -> Iterator[tuple[int, Result]]:
        """See :class:`Executor`; here in the order of the items."""
        for index, item in enumerate(items):
            yield index, function(common, item)


@contextmanager
def open_executor(scheduler: str | None = None, workers: int | None = None) -> Iterator[Executor]:
    """The executor for the time of a block: this process unless one of the two is given.

    Parameters
    ----------
    scheduler
        Address of a running Dask scheduler, such as ``tcp://10.0.0.5:8786``.
    workers
        Number of worker processes, of one thread each, to start on this machine. They end with the block. A script
        that asks for them does so below ``if __name__ == "__main__":``, as each worker imports it.

    Raises
    ------
    InputError
        If both are given, the scheduler cannot be reached or has no workers of this version of viewgauge, or Dask
        is not installed.
    """
    if scheduler is not None and workers is not None:
        raise InputError(
            "a scheduler and a number of workers exclude each other",
            key="scheduler, workers",
            got=f"{scheduler}, {workers}",
            expected="the address of a running scheduler, or the number of processes to start here",
        )
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError("not a number of workers", key="workers", got=repr(workers), expected="a whole number from 1")
    if scheduler is None and workers is None:
        yield InProcess()
        return
    try:
        from . import cluster
    except ImportError as error:
        raise InputError(
            "running on several processes or machines needs Dask, which is not installed",
            hint='pip install "viewgauge[distributed]"',
        ) from error
    with cluster.remote(scheduler) if scheduler is not None else cluster.local(workers or 1) as executor:
        yield executor
