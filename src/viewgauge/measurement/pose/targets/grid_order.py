"""Points of a regular grid in an image, in the order of the target: right-handed, from the right corner."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["grid_points", "ordered", "turned_ids"]


def grid_points(columns: int, rows: int, pitch_mm: float) -> NDArray[np.float64]:
    """``(rows * columns, 3)``: row by row, x along a row, z = 0."""
    y, x = np.mgrid[:rows, :columns]
    return np.stack([x.ravel() * pitch_mm, y.ravel() * pitch_mm, np.zeros(rows * columns)], axis=1)


def ordered(grid: NDArray[np.float64], accepts: Callable[[NDArray[np.float64]], bool]) -> NDArray[np.float64] | None:
    """The first order of a grid ``(rows, columns, 2)`` px that is right-handed and accepted; None if none is.

    Right-handed: x of the target to y by a right turn in the image, so that its z points away from the camera.
    """
    for candidate in _orders(grid):
        x, y = candidate[0, -1] - candidate[0, 0], candidate[-1, 0] - candidate[0, 0]
        if x[0] * y[1] - x[1] * y[0] > 0 and accepts(candidate):
            return candidate
    return None


def _orders(grid: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    for mirrored in (grid, grid[:, ::-1]):
        for quarter in range(4):
            turned = np.rot90(mirrored, quarter)
            if turned.shape == grid.shape:
                yield turned


def turned_ids(columns: int, rows: int, is_same: Callable[[int], bool]) -> tuple[NDArray[np.int64], ...]:
    """For each turn by quarters that leaves the target as it is, the id that each point takes.

    Parameters
    ----------
    is_same
        Whether a turn by so many quarters (0 to 3) leaves the pattern as it is.
    """
    ids = np.arange(rows * columns).reshape(rows, columns)
    turns = [k for k in range(4) if is_same(k) and (k % 2 == 0 or rows == columns)]
    return tuple(np.rot90(ids, k).ravel() for k in turns)
