"""The distance between the axes of two holes or bosses of equal radius, by corresponding points of their rims.

An axis has no visible edge. But where two rims of one radius lie in one plane, the point at angle t of the one and
the point at angle t of the other are as far apart as the centres, and as the axes where these are perpendicular
to the plane.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..brep import Edge, PmiRecord, Reference
from ..features.arcs import circle_of, evenly
from ..features.coincidence import coaxial, is_parallel, same_radius
from ..features.outline import Outline
from ..measurands.selection import Candidate, select
from .outcome import Derived, NotDerived, Outcome, agrees, closest, disagreement

__all__ = ["axis_distance", "has_axis", "rims_of"]

_LARGEST_TILT = np.cos(np.deg2rad(50.0))  # rim tangents further along the distance would not locate it
_ANGLES = 5


def has_axis(outline: Outline, reference: Reference) -> bool:
    """Whether the reference stands for its axis: a surface of revolution or a circular edge."""
    if reference.kind == "edge":
        return outline.brep.edges[reference.index].kind == "circle"
    return outline.brep.faces[reference.index].kind in ("cylinder", "cone", "torus", "sphere")


def rims_of(outline: Outline, references: tuple[Reference, ...]) -> list[int]:
    """Visible circular edges among the references or around the cylinders among them."""
    edges: list[int] = []
    for reference in references:
        if reference.kind == "edge":
            edges += [reference.index] if outline.is_visible(reference.index) else []
        elif (face := outline.brep.faces[reference.index]).kind == "cylinder":
            edges += [
                edge
                for edge in outline.visible_edges(reference.index)
                if coaxial(outline.brep.edges[edge], face, outline.tolerance_mm)
            ]
    return [edge for edge in dict.fromkeys(edges) if outline.brep.edges[edge].kind == "circle"]


def axis_distance(outline: Outline, pmi_record: PmiRecord) -> Outcome:
    """The distance between the axis of ``first`` and the axis of ``second``."""
    pairs = [
        (i, j)
        for i in rims_of(outline, pmi_record.first)
        for j in rims_of(outline, pmi_record.second)
        if _correspond(outline.brep.edges[i], outline.brep.edges[j], outline.tolerance_mm)
    ]
    if not pairs:
        return NotDerived("an axis has no visible edge, and no two rims of equal radius lie in one plane")
    apart = {(i, j): _centre_distance(outline, i, j) for i, j in pairs}
    best = closest(list(apart.values()), pmi_record)
    if not agrees(best, pmi_record):
        return NotDerived(disagreement(best, pmi_record))
    near = [pair for pair in pairs if abs(apart[pair] - best) <= outline.tolerance_mm]
    measurands = select([candidate for i, j in near for candidate in _corresponding_points(outline, i, j)])
    if not measurands:
        return NotDerived("an axis has no visible edge, and the rims have no corresponding points")
    return Derived(best, measurands)


def _centre_distance(outline: Outline, i: int, j: int) -> float:
    return float(np.linalg.norm(outline.brep.edges[j].centre - outline.brep.edges[i].centre))


def _correspond(a: Edge, b: Edge, tolerance_mm: float) -> bool:
    """Whether two circles have one radius, lie in one plane and have different centres."""
    offset = b.centre - a.centre
    return (
        is_parallel(a.axis, b.axis)
        and same_radius(a.radius_mm, b.radius_mm, tolerance_mm)
        and abs(float(offset @ a.axis)) <= tolerance_mm < float(np.linalg.norm(offset))
    )


def _corresponding_points(outline: Outline, i: int, j: int) -> list[Candidate]:
    a, b = outline.brep.edges[i], outline.brep.edges[j]
    offset = b.centre - a.centre
    distance = float(np.linalg.norm(offset))
    circle = circle_of(a)
    moved = replace(b, points=b.points - offset, centre=a.centre)
    radial = np.cos(circle.angles)[:, None] * circle.x + np.sin(circle.angles)[:, None] * circle.y
    along = radial @ (offset / distance)
    common = circle.covered(a) & circle.covered(moved)
    candidates = []
    for outward in (along > _LARGEST_TILT, along < -_LARGEST_TILT):
        angles = circle.angles[common & outward]
        for place, angle in enumerate(_from_middle(evenly(angles[np.argsort(along[common & outward])], _ANGLES))):
            start = circle.point(angle)
            measurand = outline.measurand(i, start, j, start + offset)
            shared = bool(set(a.faces) & set(b.faces))
            candidates.append(Candidate(measurand, shared, False, False, False, place, 2 * a.radius_mm))
    return candidates


def _from_middle(values: list[float]) -> list[float]:
    """The values in order of distance from the middle of the list."""
    order = sorted(range(len(values)), key=lambda k: abs(k - (len(values) - 1) / 2))
    return [values[k] for k in order]
