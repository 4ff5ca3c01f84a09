"""Rims of cylinders on planes that lean against the axis: ellipses, whose minor axis is the diameter.

A plane of unit normal n cuts the cylinder of radius r around the axis a (through o) in an ellipse with the centre

    c = o + a ((p - o) . n) / (a . n),    p any point of the plane,

a minor axis of half-length r along m = (n x a) / |n x a|, and a major axis of half-length r / |n . a|. The points
c - r m and c + r m lie on the exact curve, 2 r apart, and the curve's tangents there are perpendicular to m: an error
of locating the edge along itself does not change the distance. No other chord through the centre is as short.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..brep import Face
from .arcs import Circle
from .coincidence import is_parallel, unit
from .outline import Outline

__all__ = ["TiltedRim", "tilted_rims"]

_STEEPEST = np.sin(np.deg2rad(5.0))  # |n . a|: a plane nearly along the axis cuts no rim


@dataclass(frozen=True)
class TiltedRim:
    """The two ends of a rim's minor axis.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, part frame.
    start_edge, end_edge
        Indices of the edges on which they lie.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    start_edge: int
    end_edge: int


def tilted_rims(outline: Outline, cylinders: Sequence[int]) -> list[TiltedRim]:
    """The rims of cylindrical faces of one axis and radius on planes that are not perpendicular to the axis."""
    if not cylinders:
        return []
    cylinder = outline.brep.faces[cylinders[0]]
    edges_on: dict[int, list[int]] = {}
    for face in cylinders:
        for edge in outline.visible_edges(face):
            for other in outline.brep.edges[edge].faces:
                if other not in cylinders and outline.brep.faces[other].kind == "plane":
                    edges_on.setdefault(other, []).append(edge)
    rims = []
    for plane, edges in edges_on.items():
        found = _rim(outline, cylinder, outline.brep.faces[plane], list(dict.fromkeys(edges)))
        if found is not None:
            rims.append(found)
    return rims


def _rim(outline: Outline, cylinder: Face, plane: Face, edges: list[int]) -> TiltedRim | None:
    """The rim in a plane; None where it is square to the axis or nearly along it, or where an end is missing."""
    axis, normal = cylinder.axis, plane.axis
    slope = float(axis @ normal)
    if is_parallel(axis, normal) or abs(slope) < _STEEPEST:
        return None
    centre = cylinder.origin + axis * float((plane.origin - cylinder.origin) @ normal) / slope
    minor = unit(np.cross(normal, axis))
    circle = Circle(centre, minor, np.cross(axis, minor), cylinder.radius_mm)  # angles as seen along the axis
    ends = [_edge_at(outline, circle, edges, angle) for angle in (np.pi, 0.0)]
    if ends[0] is None or ends[1] is None:
        return None
    return TiltedRim(circle.point(np.pi), circle.point(0.0), ends[0], ends[1])


def _edge_at(outline: Outline, circle: Circle, edges: list[int], angle: float) -> int | None:
    """The edge that runs through the circle's angle, away from the edge's own ends."""
    for index in edges:
        if circle.covered(outline.brep.edges[index])[circle.step(angle)]:
            return index
    return None
