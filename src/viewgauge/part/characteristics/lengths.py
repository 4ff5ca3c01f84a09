"""Sizes that are no diameters: lengths of edges, of faces, and widths and thicknesses between parallel faces."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..brep import Edge, PmiRecord
from ..features.coincidence import is_parallel, unit
from ..features.outline import Outline
from ..features.parallel_planes import Side, measurands_between
from ..measurands import PointPair
from ..measurands.selection import LIMIT
from .distances import distance
from .outcome import NO_REFERENCE, Derived, NotDerived, Outcome, agrees, closest, disagreement
from .widths import widths

__all__ = ["derive_lengths"]


def derive_lengths(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """One outcome per feature that the PMI record sizes, in the order of the features' first references.

    - straight edges: each one's length; two parallel ones, neither of that length: their distance
    - one flat face: the distance between its opposite parallel edges
    - several faces: pairs of parallel flat faces at the nominal distance; pairs that share a face are one
      feature (the thickness of a plate whose underside is divided), others are features of their own
    - cylinders: the distance between their flat ends
    - two sets of references: the distance between them
    """
    if not pmi_record.first:
        return [NO_REFERENCE]
    if pmi_record.second:
        return [distance(outline, pmi_record)]
    brep = outline.brep
    edges = [r.index for r in pmi_record.first if r.kind == "edge"]
    faces = list(dict.fromkeys(r.index for r in pmi_record.first if r.kind == "face"))
    if edges and not faces:
        return _of_edges(outline, pmi_record, list(dict.fromkeys(edges)))
    flat = [face for face in faces if brep.faces[face].kind == "plane"]
    if not edges and len(faces) == len(flat) == 1:
        return [_across_face(outline, pmi_record, flat[0])]
    if not edges and not flat and all(brep.faces[face].kind == "cylinder" for face in faces):
        return [_along_cylinders(outline, pmi_record, faces)]
    if edges and len(pmi_record.first) == 2:
        return [_between_two(outline, pmi_record)]
    return widths(outline, pmi_record, flat)


def _between_two(outline: Outline, pmi_record: PmiRecord) -> Outcome:
    """The distance between two references of one size."""
    a, b = pmi_record.first
    return distance(outline, replace(pmi_record, first=(a,), second=(b,)))


def _of_edges(outline: Outline, pmi_record: PmiRecord, edges: list[int]) -> list[Outcome]:
    straight = {i: outline.brep.edges[i] for i in edges if outline.brep.edges[i].kind == "line"}
    if not straight:
        return [NotDerived("the length of a curved edge is no straight distance between two points")]
    fitting = [i for i, edge in straight.items() if agrees(_length(edge), pmi_record)]
    if not fitting and len(edges) == 2:
        return [_between_two(outline, pmi_record)]
    if not fitting:
        return [
            NotDerived(disagreement(closest([_length(edge) for edge in straight.values()], pmi_record), pmi_record))
        ]
    return [_edge_length(outline, i) for i in fitting]


def _edge_length(outline: Outline, index: int) -> Outcome:
    if not outline.is_visible(index):
        return NotDerived("the edge is smooth: its faces meet without a visible crease")
    start, end = outline.brep.edges[index].points[[0, -1]]
    return Derived(_length(outline.brep.edges[index]), (outline.measurand(index, start, index, end),))


def _across_face(outline: Outline, pmi_record: PmiRecord, face: int) -> Outcome:
    """The distance between opposite parallel straight edges of one flat face."""
    edges = [i for i in outline.visible_edges(face) if outline.brep.edges[i].kind == "line"]
    found: list[tuple[float, NDArray[np.float64], int, int]] = []
    for i, j in combinations(edges, 2):
        a, b = outline.brep.edges[i], outline.brep.edges[j]
        direction = unit(a.points[-1] - a.points[0])
        if is_parallel(direction, unit(b.points[-1] - b.points[0])):
            across = np.cross(outline.brep.faces[face].axis, direction)
            value = abs(float((b.points[0] - a.points[0]) @ across))
            if value > outline.tolerance_mm:
                found.append((value, across, i, j))
    if not found:
        return NotDerived("the face has no two parallel visible edges")
    if np.isnan(pmi_record.nominal_mm) and len({round(value / outline.tolerance_mm) for value, *_ in found}) > 1:
        return NotDerived("the file gives no nominal value, and the face has several lengths")
    best = closest([value for value, *_ in found], pmi_record)
    if not agrees(best, pmi_record):
        return NotDerived(disagreement(best, pmi_record))
    measurands: list[PointPair] = []
    for value, across, i, j in found:
        if abs(value - best) <= outline.tolerance_mm:
            first, second = (Side(outline.brep.edges[k].points[0], (k,), ()) for k in (i, j))
            measurands += measurands_between(outline, [first], [second], across, best)
    if not measurands:
        return NotDerived("no opposite edges of the face face each other")
    return Derived(best, tuple(measurands[:LIMIT]))


def _along_cylinders(outline: Outline, pmi_record: PmiRecord, faces: list[int]) -> Outcome:
    """The distance between the flat ends of cylinders with one direction."""
    axis = outline.brep.faces[faces[0]].axis
    rims = [
        edge
        for face in faces
        if is_parallel(outline.brep.faces[face].axis, axis)
        for edge in outline.visible_edges(face)
        if outline.brep.edges[edge].kind == "circle" and is_parallel(outline.brep.edges[edge].axis, axis)
    ]
    sides = [Side(outline.brep.edges[rim].centre, (rim,), ()) for rim in dict.fromkeys(rims)]
    values = [abs(float((b.point - a.point) @ axis)) for a, b in combinations(sides, 2)]
    values = [value for value in values if value > outline.tolerance_mm]
    if not values:
        return NotDerived("the curved face has no two visible flat ends")
    best = closest(values, pmi_record)
    if not agrees(best, pmi_record):
        return NotDerived(disagreement(best, pmi_record))
    measurands = measurands_between(outline, sides, sides, axis, best)
    return Derived(best, measurands) if measurands else NotDerived("the flat ends do not face each other")


def _length(edge: Edge) -> float:
    return float(np.linalg.norm(edge.points[-1] - edge.points[0]))
