"""The size of a run, and how a benchmark tells what it timed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """``--tiny``: everything runs, nothing is worth timing."""
    parser.addoption("--tiny", action="store_true", help="a few items and one round: does it run?")


@pytest.fixture(scope="session")
def tiny(request: pytest.FixtureRequest) -> bool:
    """Whether this run is a mere test of the benchmarks."""
    return bool(request.config.getoption("--tiny"))


@pytest.fixture
def timed(benchmark: Any, tiny: bool) -> Callable[..., None]:
    """Times a call in rounds and keeps what a row of the report says about it.

    ``count`` items are done by one call; ``unit`` is their name in the plural. Further keywords (``name``,
    ``largest_error``, ``median_error``, ``note``, …) end up in the row; the ``group`` mark is the section.
    """

    def run(call: Callable[[], object], *, count: int, unit: str, rounds: int, **row: object) -> None:
        benchmark.extra_info.update(count=count, unit=unit, **row)
        benchmark.pedantic(call, rounds=1 if tiny else rounds, iterations=1, warmup_rounds=0 if tiny else 1)

    return run
