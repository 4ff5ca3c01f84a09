"""Slots: two parallel flat faces with air between them, joined by a floor, an end wall, or a rounded end."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..brep import Reference
from ..features.coincidence import is_parallel, unit
from ..features.outline import Outline
from .part_feature import PartFeature

__all__ = ["Slots"]


class Slots:
    """Grooves, pockets and oblong holes; the size is the width between the two faces."""

    name = "slot"
    letter = "S"

    def find(self, outline: Outline) -> list[PartFeature]:
        """The slots: each is two faces that look at each other and adjoin one face between them."""
        found: dict[tuple[int, int], float] = {}
        for between, sides in _walls(outline).items():
            for a, b in combinations(sorted(sides), 2):
                width = _air_between(outline, a, b)
                if width > outline.tolerance_mm and _is_within(outline, between, a, width):
                    found.setdefault((a, b), width)
        return [_slot(outline, a, b, width) for (a, b), width in found.items()]


def _walls(outline: Outline) -> dict[int, set[int]]:
    """For each face the flat faces that meet it in an inner corner, or tangentially where it is a hollow cylinder."""
    walls: dict[int, set[int]] = {}
    faces = outline.brep.faces
    for index, edge in enumerate(outline.brep.edges):
        if len(edge.faces) != 2 or edge.kind != "line":
            continue
        for wall, between in (edge.faces, edge.faces[::-1]):
            hollow = faces[between].kind == "cylinder" and faces[between].concave and edge.smooth
            corner = faces[between].kind == "plane" and not edge.smooth and outline.is_concave(index)
            if faces[wall].kind == "plane" and (hollow or corner):
                walls.setdefault(between, set()).add(wall)
    return walls


def _air_between(outline: Outline, a: int, b: int) -> float:
    """Distance, mm, between two parallel flat faces that look at each other; 0 for any others."""
    first, second = outline.brep.faces[a], outline.brep.faces[b]
    if not is_parallel(first.axis, second.axis) or float(first.axis @ second.axis) > 0:
        return 0.0
    return max(0.0, float((second.origin - first.origin) @ first.axis))


def _is_within(outline: Outline, between: int, a: int, width: float) -> bool:
    """Whether the face between two walls spans from one to the other and no farther."""
    face, normal = outline.brep.faces[between], outline.brep.faces[a].axis
    if face.kind == "cylinder":
        return abs(2 * face.radius_mm - width) <= outline.tolerance_mm
    along = np.concatenate([outline.brep.edges[edge].points @ normal for edge in face.edges])
    return bool(abs(np.ptp(along) - width) <= outline.tolerance_mm)


def _slot(outline: Outline, a: int, b: int, width: float) -> PartFeature:
    points = np.concatenate([outline.brep.edges[e].points for k in (a, b) for e in outline.brep.faces[k].edges])
    normal = outline.brep.faces[a].axis
    across = normal if tuple(np.round(normal, 6)) > (0.0, 0.0, 0.0) else -normal
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    references = (Reference("face", a), Reference("face", b))
    return PartFeature("slot", references, middle, unit(across), {"width": width})
