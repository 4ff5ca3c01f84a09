"""Flat faces as features."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..brep import Reference
from ..features.coincidence import unit
from ..features.outline import Outline
from .part_feature import PartFeature

__all__ = ["Planes"]


class Planes:
    """Every flat face; its size is that of the rectangle along its longest straight edge that holds it."""

    name = "plane"
    letter = "F"

    def find(self, outline: Outline) -> list[PartFeature]:
        """The flat faces that have edges."""
        faces = outline.brep.faces
        return [_plane(outline, k) for k, face in enumerate(faces) if face.kind == "plane" and face.edges]


def _plane(outline: Outline, index: int) -> PartFeature:
    face = outline.brep.faces[index]
    points = np.concatenate([outline.brep.edges[edge].points for edge in face.edges])
    along = _longest_line(outline, face.edges, face.axis)
    across = np.cross(face.axis, along)
    (a_low, a_high), (b_low, b_high) = (((points @ d).min(), (points @ d).max()) for d in (along, across))
    position = (a_low + a_high) / 2 * along + (b_low + b_high) / 2 * across + (face.origin @ face.axis) * face.axis
    longer, shorter = sorted((float(a_high - a_low), float(b_high - b_low)), reverse=True)
    reference = Reference("face", index)
    return PartFeature("plane", (reference,), position, face.axis, {"length": longer, "width": shorter})


def _longest_line(outline: Outline, edges: tuple[int, ...], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction ``(3,)`` of the longest straight edge; where all are curved, of a part axis laid into the plane."""
    lines = [e.points[-1] - e.points[0] for k in edges if (e := outline.brep.edges[k]).kind == "line"]
    if lines:
        longest = max(lines, key=lambda line: round(float(np.linalg.norm(line)), 6))
        return unit(longest - (longest @ normal) * normal)
    axis = np.eye(3)[int(np.argmin(np.abs(normal)))]
    return unit(axis - (axis @ normal) * normal)
