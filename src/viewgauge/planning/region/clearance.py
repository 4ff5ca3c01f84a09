"""How far positions are from the part's surface, and whether they are inside it."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ...part import Mesh

__all__ = ["Clearance"]


class Clearance:
    """Distances to a mesh, exact to rounding; only of points that are near enough to matter.

    A point is inside where the mesh's winding number about it is more than a half: for a closed surface 1 inside and 0
    outside, and of a sound meaning for one with gaps (Jacobson, Kavan and Sorkine-Hornung, *ACM Trans. Graph.* 32,
    2013, article 33).
    """

    def __init__(self, mesh: Mesh) -> None:
        self._corners = np.ascontiguousarray(mesh.vertices[mesh.triangles], dtype=float)
        self._bounds = mesh.bounds

    def too_near(self, points: NDArray[np.float64], standoff_mm: float) -> NDArray[np.bool_]:
        """``(n,)``: whether points ``(n, 3)`` mm are inside, on the surface, or nearer to it than the standoff."""
        near = self._near(points, points, standoff_mm)
        distance, winding = self._measured(points[near])
        result = np.zeros(len(points), dtype=bool)
        result[near] = (winding > 0.5) | (distance < standoff_mm) | (distance == 0)
        return result

    def all_too_near(
        self, low: NDArray[np.float64], high: NDArray[np.float64], standoff_mm: float
    ) -> NDArray[np.bool_]:
        """``(n,)``: True only where every point of the box between corners ``(n, 3)`` mm is too near."""
        near = self._near(low, high, standoff_mm)
        middle, radius = (low[near] + high[near]) / 2, np.linalg.norm(high[near] - low[near], axis=1) / 2
        distance, winding = self._measured(middle)
        result = np.zeros(len(low), dtype=bool)
        # a ball about the middle that holds the box: wholly within the standoff, or inside and clear of the surface
        result[near] = (distance + radius < standoff_mm) | ((winding > 0.5) & (distance > radius))
        return result

    def _near(self, low: NDArray[np.float64], high: NDArray[np.float64], reach: float) -> NDArray[np.int64]:
        gap = np.maximum(np.maximum(self._bounds[0] - high, low - self._bounds[1]), 0.0)
        return np.flatnonzero((gap**2).sum(axis=1) <= reach**2)

    def _measured(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        distance, winding = np.empty(len(points)), np.empty(len(points))
        _measure(np.ascontiguousarray(points), self._corners, distance, winding)
        return distance, winding


@numba.njit(error_model="numpy")
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(error_model="numpy")
def _to_segment(a, b):  # type: ignore[no-untyped-def]
    d = b - a
    size = _dot(d, d)
    share = min(max(-_dot(a, d) / size, 0.0), 1.0) if size > 0.0 else 0.0
    foot = a + share * d
    return _dot(foot, foot)


@numba.njit(error_model="numpy")
def _squared_distance(a, b, c):  # type: ignore[no-untyped-def]
    """Of the origin to a triangle: to its plane where the foot is inside, else to the nearest edge."""
    least = min(_to_segment(a, b), _to_segment(b, c), _to_segment(c, a))
    normal = np.cross(b - a, c - a)
    size = _dot(normal, normal)
    if size > 0.0 and (
        _dot(normal, np.cross(a, b)) >= 0 and _dot(normal, np.cross(b, c)) >= 0 and _dot(normal, np.cross(c, a)) >= 0
    ):
        height = _dot(normal, a)
        return min(least, height * height / size)
    return least


@numba.njit(
    "void(float64[:,::1], float64[:,:,::1], float64[::1], float64[::1])", cache=True, nogil=True, error_model="numpy"
)
def _measure(points, corners, distance, winding):  # type: ignore[no-untyped-def]
    """Distance to the nearest triangle, and the winding number (van Oosterom and Strackee 1983: solid angles)."""
    for k in range(len(points)):
        p = points[k]
        least, total = np.inf, 0.0
        for t in range(len(corners)):
            a, b, c = corners[t, 0] - p, corners[t, 1] - p, corners[t, 2] - p
            least = min(least, _squared_distance(a, b, c))
            la, lb, lc = math.sqrt(_dot(a, a)), math.sqrt(_dot(b, b)), math.sqrt(_dot(c, c))
            triple = _dot(a, np.cross(b, c))
            total += math.atan2(triple, la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb)
        distance[k] = math.sqrt(least)
        winding[k] = total / (2 * math.pi)
