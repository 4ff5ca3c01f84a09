"""Measurands between two parallel planes, each represented by the visible edges that lie in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..brep import Reference
from ..measurands import PointPair
from ..measurands.selection import Candidate, select
from .coincidence import is_parallel, unit
from .facing_points import facing_points
from .outline import Outline

__all__ = ["Side", "distinct_normals", "measurands_between", "side_of"]


@dataclass(frozen=True)
class Side:
    """A plane, by one point ``(3,)`` mm of it, with the edges and the faces that lie in it."""

    point: NDArray[np.float64]
    edges: tuple[int, ...]
    faces: tuple[int, ...]


def side_of(outline: Outline, reference: Reference, normal: NDArray[np.float64]) -> Side | None:
    """The reference as a side perpendicular to the unit ``normal`` ``(3,)``; None where it is not flat that way."""
    if reference.kind == "face":
        face = outline.brep.faces[reference.index]
        if face.kind != "plane" or not is_parallel(face.axis, normal):
            return None
        return Side(face.origin, outline.visible_edges(reference.index), (reference.index,))
    edge = outline.brep.edges[reference.index]
    if float(np.ptp(edge.points @ normal)) > outline.tolerance_mm:
        return None
    in_plane = tuple(
        face
        for face in edge.faces
        if outline.brep.faces[face].kind == "plane" and is_parallel(outline.brep.faces[face].axis, normal)
    )
    edges = (reference.index,) if outline.is_visible(reference.index) else ()
    return Side(edge.points[0], edges, in_plane)


def measurands_between(
    outline: Outline,
    first: Sequence[Side],
    second: Sequence[Side],
    normal: NDArray[np.float64],
    distance_mm: float,
) -> tuple[PointPair, ...]:
    """Measurands of length ``distance_mm`` between any of the first sides and any of the second that is so far away.

    Parameters
    ----------
    normal
        ``(3,)`` unit normal of all the sides, either sense.
    """
    candidates = []
    for a in first:
        for b in second:
            signed = float((b.point - a.point) @ normal)
            if abs(abs(signed) - distance_mm) > outline.tolerance_mm:
                continue
            shift = np.copysign(distance_mm, signed) * normal
            measured = {*a.faces, *b.faces}
            for i, j in outline.overlapping(a.edges, b.edges, shift):
                candidates += _between_edges(outline, i, j, shift, measured)
            candidates += _along_joining_edges(outline, a, b, shift)
    return select(candidates)


def _between_edges(outline: Outline, i: int, j: int, shift: NDArray[np.float64], measured: set[int]) -> list[Candidate]:
    a, b = outline.brep.edges[i], outline.brep.edges[j]
    pairs = facing_points(a, b, shift, outline.tolerance_mm) if i != j else []
    common = bool((set(a.faces) & set(b.faces)) - measured)
    straight = a.kind == b.kind == "line"
    concave = outline.is_concave(i) or outline.is_concave(j)
    shorter = min(_length(a.points), _length(b.points))
    return [
        Candidate(outline.measurand(i, start, j, end), common, concave, straight, False, place, shorter)
        for place, (start, end) in enumerate(pairs)
    ]


def _along_joining_edges(outline: Outline, a: Side, b: Side, shift: NDArray[np.float64]) -> list[Candidate]:
    """The visible straight edges that run from an edge of one side to an edge of the other along the normal."""
    candidates = []
    for index in _touching(outline, a):
        edge = outline.brep.edges[index]
        if edge.kind != "line" or not outline.is_visible(index):
            continue
        for start, end in (edge.points[[0, -1]], edge.points[[-1, 0]]):
            spans = bool(np.linalg.norm(end - start - shift) <= outline.tolerance_mm)
            if spans and _on_edges(outline, start, a) and _on_edges(outline, end, b):
                measurand = outline.measurand(index, start, index, start + shift)
                candidates.append(
                    Candidate(measurand, True, outline.is_concave(index), True, True, 0, _length(edge.points))
                )
    return candidates


def _touching(outline: Outline, side: Side) -> list[int]:
    """Edges with an end at an end of one of the side's edges."""
    touching: set[int] = set()
    for edge in side.edges:
        for end in outline.brep.edges[edge].points[[0, -1]]:
            touching.update(outline.edges_ending_at(end))
    return sorted(touching - set(side.edges))


def _on_edges(outline: Outline, point: NDArray[np.float64], side: Side) -> bool:
    return any(edge in side.edges for edge in outline.edges_ending_at(point))


def _length(points: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def distinct_normals(normals: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """The directions ``(3,)`` at unit length without parallel or antiparallel repetitions; zeros are left out."""
    kept: list[NDArray[np.float64]] = []
    for normal in (unit(n) for n in normals):
        if normal.any() and not any(is_parallel(normal, other) for other in kept):
            kept.append(normal)
    return kept
