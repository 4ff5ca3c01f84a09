"""Holes and bosses: cylinders that go all or most of the way round."""

from __future__ import annotations

import numpy as np

from ..brep import Reference
from ..features.coincidence import distance_from_axis, unit
from ..features.cylinders import cylinder_groups, extent_along
from ..features.outline import Outline
from .part_feature import PartFeature

__all__ = ["Bosses", "Holes"]

_LARGEST_GAP_RAD = np.pi / 2  # a cylinder with a wider gap is a rounded corner or the end of a slot


class Holes:
    """Cylinders with the material outside."""

    name = "hole"
    letter = "H"

    def find(self, outline: Outline) -> list[PartFeature]:
        """The holes, a stepped one as one hole for each diameter."""
        return _round_features(outline, "hole", "depth", concave=True)


class Bosses:
    """Cylinders with the material inside: pins, shafts, discs."""

    name = "boss"
    letter = "B"

    def find(self, outline: Outline) -> list[PartFeature]:
        """The bosses, a stepped one as one boss for each diameter."""
        return _round_features(outline, "boss", "height", concave=False)


def _round_features(outline: Outline, kind: str, along: str, *, concave: bool) -> list[PartFeature]:
    faces = [k for k, face in enumerate(outline.brep.faces) if face.kind == "cylinder" and face.concave == concave]
    groups = [group for group in cylinder_groups(outline, faces) if _goes_round(outline, group)]
    return [_feature(outline, group, kind, along) for group in groups]


def _feature(outline: Outline, group: list[int], kind: str, along: str) -> PartFeature:
    face = outline.brep.faces[group[0]]
    extents = np.array([extent_along(outline, cylinder, face.axis) for cylinder in group])
    low, high = float(extents.min()), float(extents.max())
    position = face.origin + ((low + high) / 2 - face.origin @ face.axis) * face.axis
    axis = face.axis if tuple(np.round(face.axis, 6)) > (0.0, 0.0, 0.0) else -face.axis
    references = tuple(Reference("face", cylinder) for cylinder in group)
    return PartFeature(kind, references, position, axis, {"diameter": 2 * face.radius_mm, along: high - low})


def _goes_round(outline: Outline, group: list[int]) -> bool:
    """Whether the edges of the cylinders leave no wide gap around the axis."""
    face = outline.brep.faces[group[0]]
    points = np.concatenate(
        [outline.brep.edges[e].points for cylinder in group for e in outline.brep.faces[cylinder].edges]
    )
    radial = np.array([distance_from_axis(point, face.origin, face.axis) for point in points])
    x = unit(radial[0])
    angles = np.sort(np.arctan2(radial @ np.cross(face.axis, x), radial @ x))
    gaps = np.diff([*angles, angles[0] + 2 * np.pi])
    return bool(gaps.max() < _LARGEST_GAP_RAD)
