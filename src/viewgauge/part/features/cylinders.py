"""Cylindrical faces that are one hole or boss."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .coincidence import same_axis, same_radius
from .grouping import connected_groups
from .outline import Outline

__all__ = ["cylinder_groups", "extent_along", "one_cylinder"]


def cylinder_groups(outline: Outline, faces: Sequence[int]) -> list[list[int]]:
    """The cylindrical faces among some faces, grouped: of one axis and radius, adjoining along the axis, and either all
    holes or all bosses."""
    cylinders = [face for face in faces if _is_bounded_cylinder(outline, face)]
    return connected_groups(cylinders, lambda a, b: one_cylinder(outline, a, b))


def _is_bounded_cylinder(outline: Outline, face: int) -> bool:
    return outline.brep.faces[face].kind == "cylinder" and bool(outline.brep.faces[face].edges)


def one_cylinder(outline: Outline, a: int, b: int) -> bool:
    """Whether two cylindrical faces have one axis and radius and adjoin along the axis, both holes or both bosses."""
    first, second = outline.brep.faces[a], outline.brep.faces[b]
    if first.concave != second.concave or not same_radius(first.radius_mm, second.radius_mm, outline.tolerance_mm):
        return False
    if not same_axis(first.origin, first.axis, second.origin, second.axis, outline.tolerance_mm):
        return False
    (low, high), (other_low, other_high) = (extent_along(outline, face, first.axis) for face in (a, b))
    return max(low, other_low) <= min(high, other_high) + outline.tolerance_mm


def extent_along(outline: Outline, face: int, direction: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest and highest coordinate of the face's edges along a direction ``(3,)``, mm."""
    along = np.concatenate([outline.brep.edges[edge].points @ direction for edge in outline.brep.faces[face].edges])
    return float(along.min()), float(along.max())
