"""Diameters of circular edges, as chords between diametrically opposite points of a rim; one per hole or boss."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..brep import Edge, PmiRecord, Reference
from ..features.arcs import Circle, circle_of, evenly, opposite_angles
from ..features.coincidence import same_axis, same_circle, same_radius
from ..features.cylinders import cylinder_groups, extent_along
from ..features.grouping import connected_groups
from ..features.outline import Outline
from ..features.tilted_rims import TiltedRim, tilted_rims
from ..measurands import Diameter
from ..measurands.selection import Candidate, select
from .axis_distances import rims_of
from .distances import distance
from .outcome import NO_REFERENCE, Derived, NotDerived, Outcome, agrees, disagreement

__all__ = ["derive_diameters"]

_ORIENTATIONS = 6  # of the chords of one rim, over half a turn
_GAP_RAD = 1e-3  # of a rim that counts as whole
_ORDER_DECIMALS = 3  # mm: features whose positions agree that closely are ordered by the next coordinate


@dataclass(frozen=True)
class _Feature:
    """A hole or boss: the radius in mm, a place ``(3,)`` mm by which features are ordered, and its visible rims.

    ``rims`` are circles (edges); ``tilted`` are those on planes that lean against the axis.
    """

    radius_mm: float
    place: NDArray[np.float64]
    rims: tuple[int, ...]
    tilted: tuple[TiltedRim, ...] = ()


def derive_diameters(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """One outcome per hole or boss among the referenced faces and edges, ordered by position x, then y, then z.

    Cylinders of one axis and one radius that adjoin along the axis are one feature: its place is the middle of
    its axis. Of other faces (cones, spheres, planes) the circular edges of the nominal diameter count, and of
    edges the circles: arcs of one circle, and circles of one hole, are one feature. Two sets of references stand for
    the distance between them.
    """
    if not pmi_record.first:
        return [NO_REFERENCE]
    if pmi_record.second:
        return [distance(outline, pmi_record)]
    features = _holes_and_bosses(outline, pmi_record.first)
    features += _circles(outline, pmi_record, {edge for feature in features for edge in feature.rims})
    if not features:
        return [NotDerived("the PMI record refers to no cylinder and to no circular edge of the nominal diameter")]
    features.sort(key=lambda feature: tuple(np.round(feature.place, _ORDER_DECIMALS) + 0.0))
    return [_chords(outline, pmi_record, feature) for feature in features]


def _holes_and_bosses(outline: Outline, references: tuple[Reference, ...]) -> list[_Feature]:
    faces = [r.index for r in references if r.kind == "face"]
    return [_feature(outline, group) for group in cylinder_groups(outline, faces)]


def _feature(outline: Outline, cylinders: list[int]) -> _Feature:
    face = outline.brep.faces[cylinders[0]]
    extents = np.array([extent_along(outline, cylinder, face.axis) for cylinder in cylinders])
    middle = (extents.min() + extents.max()) / 2
    place = face.origin + (middle - face.origin @ face.axis) * face.axis
    rims = rims_of(outline, tuple(Reference("face", cylinder) for cylinder in cylinders))
    return _Feature(face.radius_mm, place, tuple(rims), tuple(tilted_rims(outline, cylinders)))


def _circles(outline: Outline, pmi_record: PmiRecord, known: set[int]) -> list[_Feature]:
    """Features from circular edges: referenced ones, and those of the nominal diameter on faces but cylinders."""
    edges: list[int] = []
    for reference in pmi_record.first:
        if reference.kind == "edge":
            edges.append(reference.index)
        elif outline.brep.faces[reference.index].kind != "cylinder":
            edges += [
                edge
                for edge in outline.visible_edges(reference.index)
                if agrees(2 * outline.brep.edges[edge].radius_mm, pmi_record)
            ]
    circles = [edge for edge in edges if outline.brep.edges[edge].kind == "circle" and edge not in known]
    features = []
    for group in connected_groups(circles, lambda a, b: _one_hole(outline, a, b)):
        members = [outline.brep.edges[edge] for edge in group]
        place = np.mean([edge.centre for edge in members], axis=0)
        visible = tuple(edge for edge in group if outline.is_visible(edge))
        features.append(_Feature(members[0].radius_mm, place, visible))
    return features


def _one_hole(outline: Outline, a: int, b: int) -> bool:
    """Whether two circular edges are arcs of one circle, or equal circles around one axis that bound one face."""
    first, second = outline.brep.edges[a], outline.brep.edges[b]
    if same_circle(first, second, outline.tolerance_mm):
        return True
    return (
        bool(set(first.faces) & set(second.faces))
        and same_axis(first.centre, first.axis, second.centre, second.axis, outline.tolerance_mm)
        and same_radius(first.radius_mm, second.radius_mm, outline.tolerance_mm)
    )


def _chords(outline: Outline, pmi_record: PmiRecord, feature: _Feature) -> Outcome:
    value = 2 * feature.radius_mm
    if not agrees(value, pmi_record):
        return NotDerived(disagreement(value, pmi_record))
    if not feature.rims and not feature.tilted:
        return NotDerived("the feature has no visible circular edge: its rims are smooth or not flat")
    candidates = [_minor_axis(outline, rim, value) for rim in feature.tilted]
    for arcs in connected_groups(
        feature.rims, lambda a, b: same_circle(outline.brep.edges[a], outline.brep.edges[b], outline.tolerance_mm)
    ):
        candidates += _chords_of_rim(outline, arcs, value)
    measurands = select(candidates)
    if not measurands:
        return NotDerived("no rim has two diametrically opposite points: its arcs are less than half a turn")
    return Derived(value, measurands)


def _chords_of_rim(outline: Outline, arcs: list[int], diameter_mm: float) -> list[Candidate]:
    """Chords of one circle at angles where both ends lie on its arcs."""
    edges = [outline.brep.edges[arc] for arc in arcs]
    circle = replace(circle_of(edges[0]), radius_mm=diameter_mm / 2)
    whole = any(edge.closed for edge in edges) or bool(np.sum([_turn(circle, e) for e in edges]) > 2 * np.pi - _GAP_RAD)
    rim_axis = np.cross(circle.x, circle.y) if whole and not any(map(outline.is_concave, arcs)) else None
    candidates = []
    for angle in evenly(opposite_angles(circle, edges), _ORIENTATIONS):
        i, j = (arcs[circle.arc_at(edges, turned)] for turned in (angle, angle + np.pi))
        chord = outline.measurand(i, circle.point(angle), j, circle.point(angle + np.pi))
        measurand = Diameter(chord.start, chord.end, *chord.normals, chord.source, rim_axis)
        shared = set(outline.brep.edges[i].faces) & set(outline.brep.edges[j].faces)
        concave = outline.is_concave(i) or outline.is_concave(j)
        on_flat_face = any(outline.brep.faces[face].kind == "plane" for face in shared)
        candidates.append(Candidate(measurand, on_flat_face, concave, False, False, 0, diameter_mm))
    return candidates


def _minor_axis(outline: Outline, rim: TiltedRim, diameter_mm: float) -> Candidate:
    """The chord of a rim that is an ellipse; no edge detector may fit a circle to it."""
    chord = outline.measurand(rim.start_edge, rim.start, rim.end_edge, rim.end)
    measurand = Diameter(chord.start, chord.end, *chord.normals, chord.source, None)
    concave = outline.is_concave(rim.start_edge) or outline.is_concave(rim.end_edge)
    return Candidate(measurand, True, concave, False, False, 0, diameter_mm)


def _turn(circle: Circle, arc: Edge) -> float:
    """Angle over which an arc goes round, rad."""
    return float(np.ptp(np.unwrap(circle.angle(arc.points))))
