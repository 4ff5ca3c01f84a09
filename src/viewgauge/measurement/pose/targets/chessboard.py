"""A chessboard: its inner corners."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..board import opencv
from .grid_order import grid_points, ordered, turned_ids

__all__ = ["Chessboard"]


@dataclass(frozen=True)
class Chessboard:
    """A chessboard of ``columns`` x ``rows`` squares.

    Parameters
    ----------
    columns, rows
        Squares, not inner corners.
    square_mm
        Side.
    """

    columns: int
    rows: int
    square_mm: float

    @property
    def pitch_mm(self) -> float:
        """Of its corners."""
        return self.square_mm

    @property
    def _inner(self) -> tuple[int, int]:
        return self.columns - 1, self.rows - 1

    @cached_property
    def points_mm(self) -> NDArray[np.float64]:
        """``(k, 3)``: inner corners row by row."""
        return grid_points(*self._inner, self.square_mm)

    @cached_property
    def symmetries(self) -> tuple[NDArray[np.int64], ...]:
        """Turns that leave the pattern as it is."""
        columns, rows = self._inner
        return turned_ids(columns, rows, lambda k: k == 0 or ((rows + columns) if k == 2 else columns) % 2 == 0)

    def find(self, grey: Any) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids and places px of the corners; none unless all are seen."""
        columns, rows = self._inner
        found, places = opencv().findChessboardCornersSB(grey, (columns, rows))
        if not found:
            return np.zeros(0, np.int64), np.zeros((0, 2))

        def first_is_dark(grid: NDArray[np.float64]) -> bool:
            return _brightness(grey, grid, 0) < _brightness(grey, grid, 1)

        grid = ordered(places.reshape(rows, columns, 2).astype(float), first_is_dark)
        if grid is None:
            return np.zeros(0, np.int64), np.zeros((0, 2))
        return np.arange(rows * columns), grid.reshape(-1, 2)


def _brightness(grey: Any, grid: NDArray[np.float64], column: int) -> float:
    """In the middle of a square of the first row."""
    u, v = np.rint(grid[:2, column : column + 2].reshape(-1, 2).mean(axis=0)).astype(int)
    return float(np.mean(grey[max(v - 1, 0) : v + 2, max(u - 1, 0) : u + 2]))
