"""Which pairs of distances of a measurand's ends from the eye can occur: all that a set of eye positions says to the
bound.

A measurand and an eye make a triangle, so the two distances fix how the measurand lies to the lines of sight; where the
camera looks and its roll are free. The pairs are kept as the cells of a square grid, uniform in the logarithm of the
distance.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["DistanceGrid"]

_BINS = 128
_NEAREST = 0.01  # of the largest distance: what is nearer falls into the first bin


class DistanceGrid:
    """A set of pairs (r_1, r_2), mm, as cells of a grid; symmetric, because which end comes first has no meaning.

    Parameters
    ----------
    shortest_mm, longest_mm
        Between which all distances lie.
    """

    def __init__(self, shortest_mm: float, longest_mm: float, bins: int = _BINS) -> None:
        self.shortest_mm, self.longest_mm = shortest_mm, longest_mm
        self._first = math.log(max(shortest_mm, _NEAREST * longest_mm))
        self._per_bin = bins / max(math.log(longest_mm) - self._first, 1e-6)
        self.cells = np.zeros((bins, bins), dtype=bool)
        self._sums = np.zeros((bins + 1, bins + 1), np.int64)

    def _bin(self, distance_mm: NDArray[np.float64], slack: NDArray[np.float64] | float) -> NDArray[np.int64]:
        with np.errstate(divide="ignore"):
            place = (np.log(distance_mm) - self._first) * self._per_bin
        return np.clip(np.floor(place + slack), 0, len(self.cells) - 1).astype(np.int64)

    def rectangles(self, distances_mm: NDArray[np.float64]) -> NDArray[np.int64]:
        """``(n, 4)`` first and last bin of r_1 and of r_2, of least and largest r_1 and r_2 ``(n, 4)`` mm."""
        slack = np.array([-1e-9, 1e-9, -1e-9, 1e-9])
        return self._bin(distances_mm, slack)

    def mark_pairs(self, r: NDArray[np.float64]) -> None:
        """Add the cells of pairs ``(n, 2)`` mm."""
        place = self._bin(r, 0.0)
        self.cells[place[:, 0], place[:, 1]] = True
        self.cells[place[:, 1], place[:, 0]] = True
        self._sum_up()

    def mark_rectangles(self, rectangles: NDArray[np.int64]) -> None:
        """Add all cells of rectangles ``(n, 4)`` of bins."""
        size = len(self.cells) + 1
        change = np.zeros((size, size), np.int64)
        a, b, c, d = np.unique(rectangles, axis=0).T
        for rows, columns in (((a, b), (c, d)), ((c, d), (a, b))):
            np.add.at(change, (rows[0], columns[0]), 1)
            np.add.at(change, (rows[1] + 1, columns[0]), -1)
            np.add.at(change, (rows[0], columns[1] + 1), -1)
            np.add.at(change, (rows[1] + 1, columns[1] + 1), 1)
        self.cells |= change.cumsum(axis=0).cumsum(axis=1)[:-1, :-1] > 0
        self._sum_up()

    def fill(self) -> None:
        """All pairs."""
        self.cells[:] = True
        self._sum_up()

    def restrict(self, other: DistanceGrid) -> None:
        """Keep only what is also in another set of the same range."""
        self.cells &= other.cells
        self._sum_up()

    def _sum_up(self) -> None:
        self._sums[1:, 1:] = self.cells.cumsum(axis=0).cumsum(axis=1)

    def _count(self, rectangles: NDArray[np.int64]) -> NDArray[np.int64]:
        a, b, c, d = rectangles.T
        S = self._sums
        return np.asarray(S[b + 1, d + 1] - S[a, d + 1] - S[b + 1, c] + S[a, c])

    def any_in(self, rectangles: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(n,)``: some cell of the rectangle ``(n, 4)`` belongs to the set."""
        return self._count(rectangles) > 0

    def all_in(self, rectangles: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(n,)``: all cells of the rectangle ``(n, 4)`` belong to the set."""
        a, b, c, d = rectangles.T
        return np.asarray(self._count(rectangles) == (b - a + 1) * (d - c + 1))

    def narrow(self, distances_mm: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: neither r_1 nor r_2 has more than a bin's width between its least and largest, ``(n, 4)`` mm."""
        with np.errstate(divide="ignore", invalid="ignore"):
            place = np.maximum((np.log(distances_mm) - self._first) * self._per_bin, 0.0)
        return np.asarray((place[:, 1] - place[:, 0] <= 1) & (place[:, 3] - place[:, 2] <= 1))

    @property
    def empty(self) -> bool:
        """No pair can occur."""
        return not self.cells.any()

    def range_mm(self) -> tuple[float, float]:
        """Least and largest distance of the cells in the set (``shortest_mm`` where the first bin is)."""
        used = np.flatnonzero(self.cells.any(axis=0))
        low = self._first + used[0] / self._per_bin
        high = self._first + (used[-1] + 1) / self._per_bin
        shortest = self.shortest_mm if used[0] == 0 else math.exp(low) * (1 - 1e-9)
        return shortest, min(math.exp(high) * (1 + 1e-9), self.longest_mm * (1 + 1e-9))
