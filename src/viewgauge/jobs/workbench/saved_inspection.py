"""An inspection file with the values to which knobs were turned."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...formats.inspection.edited_file import edited_inspection
from ...planning.improve.knob_values import KnobValues, with_pixel_pitch
from ...planning.inspection import Inspection

__all__ = ["changed_inspection_text"]


def changed_inspection_text(text: str, inspection: Inspection, knobs: KnobValues) -> tuple[str, tuple[str, ...]]:
    """The inspection file's text with the knobs' values, and the names of those that it has no place for.

    What another file states has no place in it: a camera's calibration, a covariance of the pose. Nor has the distance,
    which belongs to the viewpoints.

    Parameters
    ----------
    text
        The text of the file that the inspection was read from.
    """
    today = KnobValues.of(inspection.setup)
    changes: dict[tuple[str, ...], Any] = {}
    unsaved: list[str] = []
    calibrated, covariance = _states(text, "camera", "calibration"), _states(text, "pose_uncertainty", "covariance")
    if not math.isclose(knobs.pixel_pitch_mm, today.pixel_pitch_mm):
        if calibrated or inspection.camera.intrinsics_covariance is not None:
            unsaved.append("pixel pitch")
        else:
            _put_pixel_pitch(changes, inspection, knobs.pixel_pitch_mm / today.pixel_pitch_mm)
    if not math.isclose(knobs.focal_length_mm, today.focal_length_mm):
        if calibrated:
            unsaved.append("focal length")
        else:
            changes["camera", "focal_length"] = f"{_digits(knobs.focal_length_mm)} mm"
    if not math.isclose(knobs.edge_px, today.edge_px):
        if inspection.camera.edge_detector is None:
            changes["camera", "edge_detector", "quantization"] = f"{_digits(knobs.edge_px)} px"
        else:
            unsaved.append("edge location")
    for name, was, now, first, unit, scale in (
        ("translation", today.translation_mm, knobs.translation_mm, 0, "mm", 1.0),
        ("rotation", today.rotation_rad, knobs.rotation_rad, 3, "deg", 180 / math.pi),
    ):
        if math.isclose(was, now):
            continue
        if covariance or _states(text, "pose_uncertainty", "common"):
            unsaved.append(name)
        else:
            deviations = np.sqrt(inspection.pose_error.covariance.diagonal()[first : first + 3]) * scale * now / was
            listed = ", ".join(_digits(value) for value in deviations)
            alike = np.ptp(deviations) <= 1e-12 * deviations.max()
            changes["pose_uncertainty", name] = f"{_digits(deviations[0])} {unit}" if alike else f"[{listed}] {unit}"
    if knobs.required is not None:
        if today.required is not None and not math.isclose(knobs.required, today.required):
            unit = f" {inspection.requirement.unit}" if inspection.requirement.unit else ""
            value = _digits(knobs.required)
            changes["requirement", inspection.requirement.kind] = f"{value}{unit}" if unit else float(value)
        if not math.isclose(knobs.probability, today.probability):
            changes["requirement", "probability"] = float(_digits(knobs.probability))
    if knobs.distance != 1:
        unsaved.append("distance")
    return (edited_inspection(text, changes) if changes else text), tuple(unsaved)


def _put_pixel_pitch(changes: dict[tuple[str, ...], Any], inspection: Inspection, factor: float) -> None:
    camera = with_pixel_pitch(inspection.camera, factor)
    pitch = [f"{_digits(1000 * value)}" for value in camera.pixel_pitch_mm]
    changes["camera", "pixel_pitch"] = f"{pitch[0]} um" if pitch[0] == pitch[1] else f"[{', '.join(pitch)}] um"
    changes["camera", "resolution"] = list(camera.resolution)
    if inspection.camera.principal_point_px is not None:
        changes["camera", "principal_point"] = f"[{', '.join(map(_digits, camera.principal_point))}] px"


def _states(text: str, section: str, key: str) -> bool:
    from ...formats.files.problems import Problems
    from ...formats.files.yaml_tree import parse_yaml

    value = parse_yaml(text, Problems("inspection")).value
    below = value.get(section) if isinstance(value, dict) else None
    return isinstance(below, dict) and below.get(key) is not None


def _digits(value: float) -> str:
    return f"{float(value):.10g}"
