"""What this machine can do at most: multiply-adds, and moving memory."""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
import pytest

import part

pytestmark = pytest.mark.benchmark(group="limits")


@numba.njit(nogil=True, fastmath={"contract"})  # a multiply-add in one instruction, and nothing simplified
def _multiply_add(x: np.ndarray, times: int) -> None:
    for _ in range(times):
        for k in range(x.size):
            v = x[k]
            for _ in range(16):  # in registers: as many chains as there are entries
                v = v * 0.999999 + 1e-6
            x[k] = v


@pytest.mark.parametrize("threads", [1, 2])
def test_multiply_add(threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """Double precision, vector instructions, values in the first-level cache."""
    times = 10 if tiny else 50_000
    arrays = [np.ones(512) for _ in range(threads)]
    timed(
        part.on_threads(threads, lambda x: _multiply_add(x, times), arrays),
        count=threads * times * 512 * 16 * 2,
        unit="operations",
        rounds=9,
        name=f"multiply-adds, {threads} thread{'s' * (threads > 1)}",
    )


@pytest.mark.parametrize("threads", [1, 2])
def test_copy(threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """Bytes read and written by copying arrays larger than any cache."""
    size = 1000 if tiny else 16_000_000
    pairs = [(np.ones(size), np.empty(size)) for _ in range(threads)]
    timed(
        part.on_threads(threads, lambda pair: np.copyto(pair[1], pair[0]), pairs),
        count=threads * size * 16,
        unit="bytes",
        rounds=9,
        name=f"copying, {threads} thread{'s' * (threads > 1)}",
    )
