"""The answers of improve and specify as JSON-ready data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from ...evaluation import Requirement
from ...part import NotMeasurable
from ...planning.improve.improvement import CameraChoice, Change, Improvement, Specification
from ...planning.improve.knobs import knob_named

__all__ = ["improvement_document", "specification_document"]


def improvement_document(
    improvement: Improvement, requirement: Requirement, inputs: Mapping[str, str]
) -> dict[str, Any]:
    """The improvement as JSON-ready data: lengths mm, angles deg, pixels px; what does not exist is null."""
    return {
        **_heading(requirement, inputs),
        "viewpoints_tried": improvement.viewpoints,
        "knobs": {
            name: {"today": today, "unit": knob_named(name).unit, "what": knob_named(name).what}
            for name, today in improvement.today.items()
        },
        "characteristics": [
            {
                "id": characteristic.id,
                "met": characteristic.met,
                "probability": characteristic.probability,
                "changes": {name: _change(change) for name, change in characteristic.changes.items()},
            }
            for characteristic in improvement.characteristics
        ],
        "part": {
            "met": all(d.met for d in improvement.characteristics if d.id not in improvement.left_out),
            "changes": {name: _change(change) for name, change in improvement.part.items()},
            "left_out": list(improvement.left_out),
        },
        "trade_off": [asdict(trade) for trade in improvement.trade_off],
        "not_measurable": _not_measurable(improvement.not_measurable),
    }


def specification_document(
    specification: Specification, requirement: Requirement, inputs: Mapping[str, str]
) -> dict[str, Any]:
    """The specification as JSON-ready data: lengths mm, angles deg, pixels px; what does not exist is null."""
    return {
        **_heading(requirement, inputs),
        "characteristics": specification.characteristics,
        "smallest": None if specification.smallest is None else _choice(specification.smallest),
        "best": [_choice(choice) for choice in specification.best],
        "choices": [_choice(choice) for choice in specification.choices],
        "not_measurable": _not_measurable(specification.not_measurable),
    }


def _heading(requirement: Requirement, inputs: Mapping[str, str]) -> dict[str, Any]:
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
        "pose_error_factor": choice.pose_error.factor,
        "translation_mm": choice.translation_mm,
        "rotation_deg": choice.rotation_deg,
        "limited_by": list(choice.pose_error.limited_by),
        "pixel_px": None if choice.pixel is None else choice.pixel.value,
        "verified": choice.pose_error.verified and (choice.pixel is None or choice.pixel.verified),
    }


def _not_measurable(not_measurable: Sequence[NotMeasurable]) -> list[dict[str, Any]]:
    return [{"id": entry.id, "kind": entry.kind, "reason": entry.reason} for entry in not_measurable]
