"""Which of the faces and edges that a PMI record refers to are one feature, and which are several."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..brep import Reference
from .coincidence import same_circle
from .cylinders import one_cylinder
from .grouping import connected_groups
from .outline import Outline

__all__ = ["feature_groups"]

_ORDER_DECIMALS = 3  # mm: features whose positions agree that closely are ordered by the next coordinate


def feature_groups(outline: Outline, references: Sequence[Reference]) -> list[tuple[Reference, ...]]:
    """The features among the references, ordered by position x, then y, then z.

    Faces that share an edge are one feature, and so are the faces of one cylinder; edges that meet at an end, and arcs
    of one circle; an edge belongs to a face that it bounds.
    """
    given = list(dict.fromkeys(references))
    if len(given) < 2:
        return [tuple(given)] if given else []
    borders = [_borders(outline, reference) for reference in given]
    groups = connected_groups(range(len(given)), lambda a, b: _one_feature(outline, given, borders, a, b))
    found = [tuple(given[k] for k in group) for group in groups]
    return sorted(found, key=lambda group: tuple(np.round(_middle(outline, group), _ORDER_DECIMALS) + 0.0))


def _borders(outline: Outline, reference: Reference) -> frozenset[int]:
    """The edges of a face, or the edge itself."""
    if reference.kind == "edge":
        return frozenset((reference.index,))
    return frozenset(outline.brep.faces[reference.index].edges)


def _one_feature(
    outline: Outline, given: Sequence[Reference], borders: Sequence[frozenset[int]], a: int, b: int
) -> bool:
    if borders[a] & borders[b]:
        return True
    first, second = given[a], given[b]
    if first.kind == second.kind == "face":
        faces = outline.brep.faces
        if faces[first.index].kind != "cylinder" or faces[second.index].kind != "cylinder":
            return False
        return bool(borders[a] and borders[b]) and one_cylinder(outline, first.index, second.index)
    if first.kind == second.kind == "edge":
        one, other = outline.brep.edges[first.index], outline.brep.edges[second.index]
        if same_circle(one, other, outline.tolerance_mm):
            return True
        ends = np.linalg.norm(one.points[[0, -1]][:, None] - other.points[[0, -1]][None], axis=2)
        return not (one.closed or other.closed) and float(ends.min()) <= outline.tolerance_mm
    return False


def _middle(outline: Outline, group: Sequence[Reference]) -> NDArray[np.float64]:
    """Middle of the box of a feature's edges, mm; the origin where it has none."""
    points = [outline.brep.edges[edge].points for reference in group for edge in _borders(outline, reference)]
    if not points:
        return np.zeros(3)
    joined = np.concatenate(points)
    return np.asarray((joined.min(axis=0) + joined.max(axis=0)) / 2)
