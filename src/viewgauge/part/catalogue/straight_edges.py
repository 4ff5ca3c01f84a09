"""Straight visible edges as features."""

from __future__ import annotations

import numpy as np

from ..brep import Reference
from ..features.coincidence import unit
from ..features.outline import Outline
from .part_feature import PartFeature

__all__ = ["StraightEdges"]


class StraightEdges:
    """Every straight edge that shows as a crease; its size is its length."""

    name = "edge"
    letter = "E"

    def find(self, outline: Outline) -> list[PartFeature]:
        """The straight edges that are neither seams nor tangent."""
        found = []
        for index, edge in enumerate(outline.brep.edges):
            if edge.kind == "line" and outline.is_visible(index):
                run = edge.points[-1] - edge.points[0]
                length = float(np.linalg.norm(run))
                run = run if tuple(np.round(run, 6)) > (0.0, 0.0, 0.0) else -run
                middle = edge.points[[0, -1]].mean(axis=0)
                found.append(PartFeature("edge", (Reference("edge", index),), middle, unit(run), {"length": length}))
        return found
