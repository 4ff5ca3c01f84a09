"""What to improve, and cameras for a part, as JSON-ready data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from ...evaluation import Requirement
from ...part import Unusable
from ...planning.improve.improvement import CameraChoice, Change, Improvement, Specification
from ...planning.improve.knobs import KNOBS

__all__ = ["improvement_document", "specification_document"]


def improvement_document(
    improvement: Improvement, requirement: Requirement, inputs: Mapping[str, str]
) -> dict[str, Any]:
    """Lengths mm, angles deg, pixels px; what does not exist is null."""
    return {
        **_head(requirement, inputs),
        "settings_tried": improvement.settings,
        "knobs": {
            name: {"today": today, "unit": KNOBS[name].unit, "what": KNOBS[name].what}
            for name, today in improvement.today.items()
        },
        "dimensions": [
            {
                "id": dimension.id,
                "met": dimension.met,
                "probability": dimension.probability,
                "changes": {name: _change(change) for name, change in dimension.changes.items()},
            }
            for dimension in improvement.dimensions
        ],
        "part": {
            "met": all(d.met for d in improvement.dimensions if d.id not in improvement.left_out),
            "changes": {name: _change(change) for name, change in improvement.part.items()},
            "left_out": list(improvement.left_out),
        },
        "trade_off": [asdict(trade) for trade in improvement.trade_off],
        "not_measurable": _refused(improvement.unusable),
    }


def specification_document(
    specification: Specification, requirement: Requirement, inputs: Mapping[str, str]
) -> dict[str, Any]:
    """Lengths mm, angles deg, pixels px; what does not exist is null."""
    return {
        **_head(requirement, inputs),
        "dimensions": specification.dimensions,
        "smallest": None if specification.smallest is None else _choice(specification.smallest),
        "best": [_choice(choice) for choice in specification.best],
        "choices": [_choice(choice) for choice in specification.choices],
        "not_measurable": _refused(specification.unusable),
    }


def _head(requirement: Requirement, inputs: Mapping[str, str]) -> dict[str, Any]:
    return {"version": version("viewgauge"), "inputs": dict(inputs), "requirement": asdict(requirement)}


def _change(change: Change) -> dict[str, Any]:
    return {
        "factor": change.factor,
        "value": change.value,
        "interval": None if change.interval is None else list(change.interval),
        "unlimited": change.unlimited,
        "best_probability": change.best_probability,
        "verified": change.verified,
        "limited_by": list(change.limited_by),
    }


def _choice(choice: CameraChoice) -> dict[str, Any]:
    return {
        "sensor": choice.sensor.name,
        "resolution": list(choice.sensor.resolution),
        "pixel_pitch_mm": choice.sensor.pixel_pitch_mm,
        "focal_length_mm": choice.focal_length_mm,
        "distance_mm": list(choice.distance_mm),
        "met": choice.met,
        "head_factor": choice.head.factor,
        "translation_mm": choice.translation_mm,
        "rotation_deg": choice.rotation_deg,
        "limited_by": list(choice.head.limited_by),
        "pixel_px": None if choice.pixel is None else choice.pixel.value,
        "verified": choice.head.verified and (choice.pixel is None or choice.pixel.verified),
    }


def _refused(unusable: Sequence[Unusable]) -> list[dict[str, Any]]:
    return [{"id": entry.id, "kind": entry.kind, "reason": entry.reason} for entry in unusable]
