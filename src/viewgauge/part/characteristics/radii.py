"""Radii of arcs and cylinders, which no pair of edge points measures."""

from __future__ import annotations

from ..brep import PmiRecord
from ..features.feature_groups import feature_groups
from ..features.outline import Outline
from .outcome import NO_REFERENCE, NotDerived, Outcome

__all__ = ["derive_radius"]


def derive_radius(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """For each arc or cylinder the reason why its radius cannot be measured by pairs of points."""
    if not pmi_record.first:
        return [NO_REFERENCE]
    reason = NotDerived("a radius has no pair of opposite edge points")
    return [reason for _ in feature_groups(outline, pmi_record.first)]
