"""Radii of arcs and cylinders, which no pair of edge points measures."""

from __future__ import annotations

from ..brep import PmiRecord
from ..features.outline import Outline
from .outcome import NotDerived, Outcome

__all__ = ["derive_radius"]


def derive_radius(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:  # noqa: ARG001 - a deriver's signature
    """The reason why a radius cannot be measured by pairs of points."""
    return [NotDerived("a radius has no pair of opposite edge points")]
