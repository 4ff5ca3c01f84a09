"""Pairs of points of two edges, in two parallel planes, that face each other along the planes' normal.

Both edges are perpendicular to the normal, so an error of locating them along themselves does not change the
distance. One edge is moved along the normal into the other's plane; where the two curves then overlap or cross
is a pair.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..brep import Edge
from .arcs import circle_of, evenly
from .coincidence import is_parallel, same_circle, unit

__all__ = ["facing_points"]

_PLACES = (0.5, 0.1, 0.9)  # of an overlap: the middle, and near the ends but away from the corners
_PLACES_ON_ARC = 6


def facing_points(
    a: Edge, b: Edge, shift: NDArray[np.float64], tolerance_mm: float
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Pairs (p, p + shift) with p on edge ``a`` and p + shift on edge ``b``, the best place first.

    Parameters
    ----------
    a, b
        Edges in two parallel planes.
    shift
        ``(3,)`` mm: the planes' normal times their distance, from ``a`` to ``b``.
    tolerance_mm
        Position tolerance, mm.
    """
    moved = replace(b, points=b.points - shift, centre=b.centre - shift)
    if a.kind == "line" and b.kind == "line":
        places = _on_lines(a, moved, tolerance_mm)
    elif a.kind == "circle" and b.kind == "circle":
        places = _on_common_circle(a, moved, tolerance_mm)
    elif {a.kind, b.kind} == {"line", "circle"}:
        line, circle = (a, moved) if a.kind == "line" else (moved, a)
        places = _line_and_circle(line, circle, tolerance_mm)
    else:
        places = _common_samples(a, moved, tolerance_mm)
    return [(place, place + shift) for place in places]


def _on_lines(a: Edge, b: Edge, tolerance_mm: float) -> list[NDArray[np.float64]]:
    """Places on the overlap of two segments of one line, or the crossing of two segments of a plane."""
    start, along = a.points[0], a.points[-1] - a.points[0]
    length = float(np.linalg.norm(along))
    direction, other = unit(along), unit(b.points[-1] - b.points[0])
    offset = b.points[[0, -1]] - start
    if is_parallel(direction, other):
        away = np.linalg.norm(offset - np.outer(offset @ direction, direction), axis=1).max()
        low, high = max(0.0, min(offset @ direction)), min(length, max(offset @ direction))
        if away > tolerance_mm or high - low <= 10 * tolerance_mm:
            return []
        return [start + (low + place * (high - low)) * direction for place in _PLACES]
    basis = np.stack([direction, -other], axis=1)
    (s, t), *_ = np.linalg.lstsq(basis, offset[0], rcond=None)
    inside = tolerance_mm < s < length - tolerance_mm
    inside &= tolerance_mm < t < float(np.linalg.norm(b.points[-1] - b.points[0])) - tolerance_mm
    return [start + s * direction] if inside else []


def _on_common_circle(a: Edge, b: Edge, tolerance_mm: float) -> list[NDArray[np.float64]]:
    """Places on the arcs' common part, where both belong to one circle."""
    if not same_circle(a, b, tolerance_mm):
        return []
    circle = circle_of(a)
    common = circle.angles[circle.covered(a) & circle.covered(b)]
    return [circle.point(angle) for angle in evenly(common, _PLACES_ON_ARC)]


def _line_and_circle(line: Edge, arc: Edge, tolerance_mm: float) -> list[NDArray[np.float64]]:
    """Crossings of a segment and an arc of one plane."""
    circle = circle_of(arc)
    direction = unit(line.points[-1] - line.points[0])
    length = float(np.linalg.norm(line.points[-1] - line.points[0]))
    offset = line.points[0] - arc.centre
    middle = -float(offset @ direction)
    discriminant = arc.radius_mm**2 - float(np.sum((offset + middle * direction) ** 2))
    if discriminant <= (10 * tolerance_mm) ** 2:  # a line that only touches the circle
        return []
    places = []
    for s in (middle - np.sqrt(discriminant), middle + np.sqrt(discriminant)):
        place = line.points[0] + s * direction
        step = circle.step(float(circle.angle(place)))
        if tolerance_mm < s < length - tolerance_mm and circle.covered(arc)[step]:
            places.append(place)
    return places


def _common_samples(a: Edge, b: Edge, tolerance_mm: float) -> list[NDArray[np.float64]]:
    """Points that two curves of any kind have in common among their exact samples, ends excluded."""
    inner = a.points[1:-1]
    if len(inner) == 0 or len(b.points) < 3:
        return []
    apart, _ = cKDTree(b.points[1:-1]).query(inner)
    shared = np.flatnonzero(apart <= tolerance_mm)
    return [inner[shared[int(k)]] for k in evenly(np.arange(len(shared), dtype=float), len(_PLACES))]
