"""Linear distances: between parallel planes given by faces or edges, and between the axes of equal holes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..brep import PmiRecord, Reference
from ..features.coincidence import is_parallel, unit
from ..features.feature_groups import feature_groups
from ..features.outline import Outline
from ..features.parallel_planes import Side, distinct_normals, measurands_between, side_of
from ..measurands import PointPair
from ..measurands.selection import LIMIT
from .axis_distances import axis_distance, has_axis
from .outcome import NO_REFERENCE, Derived, NotDerived, Outcome, agrees, closest, disagreement

__all__ = ["derive_distance", "distance"]


def derive_distance(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """The distance between the two features that the PMI record refers to.

    Where one side is a pattern, there is one outcome for each of its features, ordered by position: its distance from
    the other side; where both are patterns of as many features, from the nearest one there that is at the nominal
    distance.
    """
    if not pmi_record.first:
        return [NO_REFERENCE]
    if not pmi_record.second:
        return [NotDerived("the PMI record refers to only one of the two features of a distance")]
    first, second = (feature_groups(outline, side) for side in (pmi_record.first, pmi_record.second))
    if len(first) == len(second) == 1:
        return [distance(outline, pmi_record)]
    if len(first) >= len(second):
        return [_nearest(outline, pmi_record, one, second) for one in first]
    turned = replace(pmi_record, first=pmi_record.second, second=pmi_record.first)
    return [_nearest(outline, turned, one, first) for one in second]


def _nearest(
    outline: Outline, pmi_record: PmiRecord, one: tuple[Reference, ...], others: list[tuple[Reference, ...]]
) -> Outcome:
    """The distance of one feature of a pattern from the nearest of the others that it can be measured from."""
    outcomes = [distance(outline, replace(pmi_record, first=one, second=other)) for other in others]
    derived = [outcome for outcome in outcomes if isinstance(outcome, Derived)]
    if not derived:
        return outcomes[0]
    return min(derived, key=lambda outcome: min(m.length_mm for m in outcome.measurands))


def distance(outline: Outline, pmi_record: PmiRecord) -> Outcome:
    """The distance between what the PMI record's ``first`` and ``second`` refer to.

    The distance is measured along the common normal of planes, or perpendicular to parallel lines. Edges that
    bound flat faces across it stand for these: measurands on the edges themselves come first. Where the
    references allow several distances (a step between sets of faces), the one closest to the nominal counts.
    """
    along_normals = _between_planes(outline, pmi_record)
    if isinstance(along_normals, Derived):
        return along_normals
    axes = [any(has_axis(outline, reference) for reference in side) for side in (pmi_record.first, pmi_record.second)]
    if all(axes):
        return axis_distance(outline, pmi_record)
    if any(axes):
        return NotDerived("an axis has no visible edge: its distance from a face or an edge cannot be seen")
    return along_normals


def _between_planes(outline: Outline, pmi_record: PmiRecord) -> Outcome:
    found: list[tuple[float, NDArray[np.float64], list[Side], list[Side]]] = []
    for normal in _normals(outline, pmi_record):
        first, second = (
            [side for reference in references if (side := side_of(outline, reference, normal))]
            for references in (pmi_record.first, pmi_record.second)
        )
        apart = {abs(float((b.point - a.point) @ normal)) for a in first for b in second}
        found += [(value, normal, first, second) for value in sorted(apart) if value > outline.tolerance_mm]
    if not found:
        return NotDerived(_why_no_planes(outline, pmi_record))
    best = closest([value for value, *_ in found], pmi_record)
    if not agrees(best, pmi_record):
        return NotDerived(disagreement(best, pmi_record))
    for value, normal, first, second in found:
        if abs(value - best) <= outline.tolerance_mm:
            measurands = measurands_between(outline, first, second, normal, value)
            whole = [[_whole_face(outline, side) for side in sides] for sides in (first, second)]
            if _edges(whole[0]) != _edges(first) or _edges(whole[1]) != _edges(second):
                measurands = _united(measurands, measurands_between(outline, whole[0], whole[1], normal, value))
            if measurands:
                return Derived(value, measurands)
    return NotDerived("no two visible edges of the two sides lie opposite each other along their normal")


def _united(measurands: tuple[PointPair, ...], further: tuple[PointPair, ...]) -> tuple[PointPair, ...]:
    """The measurands, then the further ones that are not among them, as many as one characteristic may have."""
    places = {(*measurand.start, *measurand.end) for measurand in measurands}
    return (*measurands, *(measurand for measurand in further if (*measurand.start, *measurand.end) not in places))[
        :LIMIT
    ]


def _normals(outline: Outline, pmi_record: PmiRecord) -> list[NDArray[np.float64]]:
    """Directions along which the distance may be meant: faces' normals, or those between lines given as edges."""
    brep = outline.brep
    references = (*pmi_record.first, *pmi_record.second)
    flat = [brep.faces[r.index].axis for r in references if r.kind == "face" and brep.faces[r.index].kind == "plane"]
    if flat:
        return distinct_normals(flat)
    between = [_between_lines(outline, a, b) for a in pmi_record.first for b in pmi_record.second]
    adjoining = [
        brep.faces[face].axis
        for reference in references
        if reference.kind == "edge"
        for face in brep.edges[reference.index].faces
        if brep.faces[face].kind == "plane"
    ]
    return distinct_normals(between + adjoining)


def _between_lines(outline: Outline, a: Reference, b: Reference) -> NDArray[np.float64]:
    """Direction from one straight edge to a parallel one, perpendicular to both; zero where there is none."""
    if a.kind != "edge" or b.kind != "edge":
        return np.zeros(3)
    first, second = outline.brep.edges[a.index], outline.brep.edges[b.index]
    direction = unit(first.points[-1] - first.points[0])
    if first.kind != "line" or second.kind != "line":
        return np.zeros(3)
    if not is_parallel(direction, unit(second.points[-1] - second.points[0])):
        return np.zeros(3)
    offset = second.points[0] - first.points[0]
    across = offset - (offset @ direction) * direction
    return unit(across) if float(np.linalg.norm(across)) > outline.tolerance_mm else np.zeros(3)


def _whole_face(outline: Outline, side: Side) -> Side:
    """The side with all visible edges of the flat faces that its edges bound in its plane."""
    edges = [edge for face in side.faces for edge in outline.visible_edges(face)]
    return Side(side.point, tuple(dict.fromkeys((*side.edges, *edges))), side.faces)


def _edges(sides: list[Side]) -> set[int]:
    return {edge for side in sides for edge in side.edges}


def _why_no_planes(outline: Outline, pmi_record: PmiRecord) -> str:
    references = (*pmi_record.first, *pmi_record.second)
    if any(r.kind == "edge" for r in references):
        return "the edges are not parallel, or lie in no parallel planes"
    if all(outline.brep.faces[r.index].kind == "plane" for r in references):
        return "the faces are not parallel, or lie in one plane"
    return "the faces are not parallel planes"
