"""Whether directions, axes and circles are the same within the part's position tolerance."""

from __future__ import annotations

from math import hypot

import numpy as np
from numpy.typing import NDArray

from ..brep import Brep, Edge, Face

__all__ = [
    "coaxial",
    "distance_from_axis",
    "is_parallel",
    "position_tolerance_mm",
    "same_axis",
    "same_circle",
    "same_radius",
    "unit",
]

_POSITION_RELATIVE = 1e-6  # of the part's diagonal: finer than the uncertainty that CAD systems write into files
_ANGLE_RAD = 1e-6


def position_tolerance_mm(brep: Brep) -> float:
    """Distance below which two points of the part count as one, mm: 1e-6 of the diagonal of its edges' box."""
    points = np.concatenate([edge.points for edge in brep.edges]) if brep.edges else np.zeros((1, 3))
    return max(_POSITION_RELATIVE * float(np.linalg.norm(np.ptp(points, axis=0))), 1e-9)


def unit(vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vector ``(..., 3)`` at length 1 (zero stays zero)."""
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.asarray(np.divide(vector, length, out=np.zeros_like(vector, dtype=float), where=length > 0))


def is_parallel(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Whether two unit vectors ``(3,)`` are parallel or antiparallel (within 1e-6 rad); a zero vector is not."""
    ax, ay, az = a.tolist()  # plain numbers: this is asked for every pair of edges, and NumPy's cross is slow
    bx, by, bz = b.tolist()
    across = hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)
    return across <= _ANGLE_RAD and ax * bx + ay * by + az * bz != 0


def distance_from_axis(
    point: NDArray[np.float64], origin: NDArray[np.float64], axis: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Vector ``(3,)`` mm from the line through ``origin`` along the unit ``axis`` to the point, perpendicular to it."""
    offset = point - origin
    return np.asarray(offset - (offset @ axis) * axis)


def same_radius(a_mm: float, b_mm: float, tolerance_mm: float) -> bool:
    """Whether two radii are equal within the position tolerance (false for NaN)."""
    return bool(abs(a_mm - b_mm) <= tolerance_mm)


def same_axis(
    origin: NDArray[np.float64],
    axis: NDArray[np.float64],
    other_origin: NDArray[np.float64],
    other_axis: NDArray[np.float64],
    tolerance_mm: float,
) -> bool:
    """Whether two lines, each a point and a unit direction, are one line (either sense)."""
    apart = hypot(*distance_from_axis(other_origin, origin, axis).tolist())
    return apart <= tolerance_mm and is_parallel(axis, other_axis)


def same_circle(a: Edge, b: Edge, tolerance_mm: float) -> bool:
    """Whether two circular edges are arcs of one circle."""
    return (
        a.kind == b.kind == "circle"
        and is_parallel(a.axis, b.axis)
        and same_radius(a.radius_mm, b.radius_mm, tolerance_mm)
        and float(np.linalg.norm(a.centre - b.centre)) <= tolerance_mm
    )


def coaxial(edge: Edge, face: Face, tolerance_mm: float) -> bool:
    """Whether a circular edge lies on a cylinder around the cylinder's own axis."""
    return same_axis(face.origin, face.axis, edge.centre, edge.axis, tolerance_mm) and same_radius(
        edge.radius_mm, face.radius_mm, tolerance_mm
    )
