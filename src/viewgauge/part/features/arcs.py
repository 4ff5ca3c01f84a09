"""Which angles of a circle its arcs cover, and points at angles that stay away from the arcs' ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..brep import Edge
from .coincidence import distance_from_axis, unit

__all__ = ["Circle", "circle_of", "evenly", "opposite_angles"]

_STEPS = 720  # angles tried around a circle: every half degree
_END_MARGIN_RAD = np.deg2rad(2.0)


@dataclass(frozen=True)
class Circle:
    """A circle with a zero direction: the point at angle t is centre + radius (cos t x + sin t y).

    Parameters
    ----------
    centre
        ``(3,)`` mm.
    x, y
        ``(3,)`` orthogonal unit vectors of its plane.
    radius_mm
        Radius, mm.
    """

    centre: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    radius_mm: float

    def point(self, angle_rad: float) -> NDArray[np.float64]:
        """Point ``(3,)`` mm at an angle."""
        return np.asarray(self.centre + self.radius_mm * (np.cos(angle_rad) * self.x + np.sin(angle_rad) * self.y))

    def angle(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Angles ``(...)`` rad in (-pi, pi] of points ``(..., 3)`` mm."""
        offset = points - self.centre
        return np.asarray(np.arctan2(offset @ self.y, offset @ self.x))

    def covered(self, arc: Edge) -> NDArray[np.bool_]:
        """Which of the angles :attr:`angles` lie on the arc, at least 2 degrees (or 5 % of it) from its ends."""
        if arc.closed:
            return np.ones(_STEPS, dtype=bool)
        along = np.unwrap(self.angle(arc.points))
        low, high = min(along[0], along[-1]), max(along[0], along[-1])
        margin = min(_END_MARGIN_RAD, 0.05 * (high - low))
        return np.asarray(np.mod(self.angles - (low + margin), 2 * np.pi) <= high - low - 2 * margin)

    def step(self, angle_rad: float) -> int:
        """Index of the nearest of :attr:`angles`."""
        return int(np.mod(angle_rad, 2 * np.pi) / (2 * np.pi) * _STEPS) % _STEPS

    def arc_at(self, arcs: list[Edge], angle_rad: float) -> int:
        """Which of the arcs covers an angle (the first where none does)."""
        return int(np.argmax([self.covered(arc)[self.step(angle_rad)] for arc in arcs]))

    @property
    def angles(self) -> NDArray[np.float64]:
        """The angles at which coverage is stated, rad in (0, 2 pi), ``(720,)``, none of them 0."""
        return np.asarray((np.arange(_STEPS) + 0.5) * (2 * np.pi / _STEPS), dtype=np.float64)


def circle_of(arc: Edge) -> Circle:
    """The circle of a circular edge, with the zero direction towards the edge's first point."""
    x = unit(distance_from_axis(arc.points[0], arc.centre, arc.axis))
    return Circle(arc.centre, x, np.cross(arc.axis, x), arc.radius_mm)


def opposite_angles(circle: Circle, arcs: list[Edge]) -> NDArray[np.float64]:
    """Angles in (0, pi) at which both the point and the opposite one lie on one of the arcs."""
    covered = np.any([circle.covered(arc) for arc in arcs], axis=0)
    half = _STEPS // 2
    return np.asarray(circle.angles[:half][covered[:half] & covered[half:]])


def evenly(values: NDArray[np.float64], count: int) -> list[float]:
    """At most ``count`` of the sorted values, at the middles of as many equal shares of them."""
    count = min(count, len(values))
    return [float(values[int((k + 0.5) * len(values) / count)]) for k in range(count)]
