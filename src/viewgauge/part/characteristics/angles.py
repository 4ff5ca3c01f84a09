"""Angles between faces, which no pair of edge points measures."""

from __future__ import annotations

from math import degrees

from ..brep import PmiRecord
from ..face_angles import disagreeing_angle
from ..features.feature_groups import feature_groups
from ..features.outline import Outline
from .outcome import NotDerived, Outcome

__all__ = ["derive_angle"]


def derive_angle(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """For each feature the reason why its angle cannot be measured by pairs of points."""
    reason = "an angle has no pair of opposite edge points"
    between = disagreeing_angle(pmi_record, outline.brep.faces)
    if between is not None:
        reason += f"; the file says {degrees(pmi_record.nominal_mm):.6g} deg, its faces {degrees(between):.6g} deg"
    features = max(len(feature_groups(outline, side)) for side in (pmi_record.first, pmi_record.second))
    return [NotDerived(reason)] * max(features, 1)
