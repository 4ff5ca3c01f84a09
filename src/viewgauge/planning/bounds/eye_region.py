"""Where an eye may be: boxes of positions, and what they say of the distances to a measurand's ends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...visibility import ObservationLimits
from ..region import Region
from .distance_grid import DistanceGrid

__all__ = ["Faces", "distance_range", "first_cell", "halves", "reachable_distances"]

_SAFE = 1e-9  # of the size, against rounding
_CELLS = 250_000  # of eye positions, shared by the measurands; what is left then counts as reachable
_FEWEST_CELLS = 25_000  # of each measurand
_ROUGH_CELLS = 10_000
_ROUGH_BINS = 96  # of a first pass, which only finds the range of the distances


def first_cell(region: Region) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The region's bounds as one box ``(1, 3)`` to ``(1, 3)``; none where they exclude each other."""
    low, high = (side[None] for side in np.asarray(region.bounds, dtype=float))
    some = (low <= high).all(axis=1)
    return low[some], high[some]


class Faces:
    """Whether each of g measurands can have, at both ends, a face turned to an eye.

    Parameters
    ----------
    points, normals
        ``(g, 2, 3)`` mm and ``(g, 2, k, 3)`` outward unit normals padded with zeros, part frame.
    """

    def __init__(self, points: NDArray[np.float64], normals: NDArray[np.float64], limits: ObservationLimits) -> None:
        self._points, self._normals = points, normals
        self._offset = np.einsum("gekx,gex->gek", normals, points)
        self._there = (normals != 0).any(axis=-1)
        self._sine = math.sin(limits.grazing_angle_rad)

    def possible(
        self, low: NDArray[np.float64], high: NDArray[np.float64], nearest: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """``(n, g)``: False only if from no point of the box ``(n, 3)`` to ``(n, 3)`` both ends have a face.

        Parameters
        ----------
        nearest
            ``(n, g, 2)`` mm: least distance of each end from the box.
        """
        middle, half = (low + high) / 2, (high - low) / 2
        shape = self._offset.shape
        flat = self._normals.reshape(-1, 3)
        height = middle @ flat.T + half @ np.abs(flat).T
        height = height.reshape(-1, *shape) - self._offset
        size = np.abs(height) + np.abs(self._offset)
        faces_eye = (height + _SAFE * size > self._sine * nearest[..., None]) & self._there
        return np.asarray(faces_eye.any(axis=-1).all(axis=-1))


def distance_range(
    low: NDArray[np.float64], high: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and largest distance, ``(n, ...)`` mm, of points ``(..., 3)`` from boxes ``(n, 3)`` to ``(n, 3)``."""
    expand = (slice(None), *[None] * (points.ndim - 1))
    below, above = low[expand] - points, points - high[expand]
    nearest = np.linalg.norm(np.maximum(np.maximum(below, above), 0.0), axis=-1)
    farthest = np.linalg.norm(np.maximum(np.abs(below), np.abs(above)), axis=-1)
    return np.asarray(nearest * (1 - _SAFE)), np.asarray(farthest * (1 + _SAFE))


def halves(low: NDArray[np.float64], high: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The boxes ``(n, 3)`` to ``(n, 3)``, each halved along its longest side."""
    rows, axis = np.arange(len(low)), (high - low).argmax(axis=1)
    middle = (low[rows, axis] + high[rows, axis]) / 2
    first, second = high.copy(), low.copy()
    first[rows, axis] = second[rows, axis] = middle
    return np.concatenate([low, second]), np.concatenate([first, high])


def reachable_distances(
    points: NDArray[np.float64], normals: NDArray[np.float64], region: Region, limits: ObservationLimits
) -> DistanceGrid:
    """The pairs of distances at which an allowed eye can be, for any of g measurands with a face turned to it at each
    end.

    Nothing that can occur is left out; what is in the set may be a little too much, by about a bin.

    Parameters
    ----------
    points, normals
        ``(g, 2, 3)`` mm, ``(g, 2, k, 3)``: as in :class:`~viewgauge.part.measurand_table.MeasurandTable`.
    """
    low, high = first_cell(region)
    if not len(low):
        return DistanceGrid(1.0, 1.0)
    nearest, farthest = distance_range(low, high, points)
    grid = DistanceGrid(float(nearest.min()), float(farthest.max()), _ROUGH_BINS)
    faces = [Faces(points[g : g + 1], normals[g : g + 1], limits) for g in range(len(points))]
    for ends, its_faces in zip(points, faces, strict=True):
        _add_measurand(grid, ends, its_faces, low, high, region, _ROUGH_CELLS)
    if grid.empty:
        return grid
    grid = DistanceGrid(*grid.range_mm())
    for ends, its_faces in zip(points, faces, strict=True):
        _add_measurand(grid, ends, its_faces, low, high, region, max(_CELLS // len(points), _FEWEST_CELLS))
    return grid


def _add_measurand(
    grid: DistanceGrid,
    ends: NDArray[np.float64],
    faces: Faces,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    region: Region,
    most_cells: int,
) -> None:
    """Mark the pairs of one measurand, by halving boxes of eye positions until they are small, empty or say nothing
    new.
    """
    cells = 0
    while len(low):
        nearest, farthest = distance_range(low, high, ends)
        ranges = np.stack([nearest, farthest], axis=-1).reshape(-1, 4)
        rectangles = grid.rectangles(ranges)
        left = ~grid.all_in(rectangles)
        left[left] = faces.possible(low[left], high[left], nearest[left, None])[:, 0]
        left[left] = region.possible(low[left], high[left])
        low, high, rectangles = low[left], high[left], rectangles[left]
        cells += len(low)
        small = grid.narrow(ranges[left]) if cells < most_cells else np.ones(len(low), dtype=bool)
        middle = (low + high) / 2
        distance, _ = distance_range(middle, middle, ends)
        certain = faces.possible(middle, middle, distance[:, None])[:, 0]
        certain[certain] = region.possible(middle[certain], middle[certain])
        grid.mark_pairs(distance[certain])
        grid.mark_rectangles(rectangles[small])
        low, high = halves(low[~small], high[~small])
