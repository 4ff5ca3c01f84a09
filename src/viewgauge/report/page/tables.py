"""The report's sections on characteristics and viewpoints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...part import Part
from ...planning.plan import Plan, PlannedCharacteristic, PlannedViewpoint
from ...sensors.camera import Camera
from ..palette import viewpoint_colours
from ..templating import Markup, render
from ..wording import length, probability, tolerance
from .ranking import STATUS_WORDS, ranked

__all__ = ["characteristics_section", "viewpoints_section", "working_distance_mm"]


@dataclass(frozen=True)
class _CharacteristicRow:
    """A characteristic with what is printed of it; a probability or an accuracy is None where there is none."""

    characteristic: PlannedCharacteristic
    nominal: str
    tolerance: str
    probability: float | None
    accuracy: float | None
    viewpoints: list[str]
    remark: str


@dataclass(frozen=True)
class _ViewpointRow:
    """A viewpoint with what is printed of it."""

    viewpoint: PlannedViewpoint
    position: str
    direction: str
    distance: str
    pixel: str


def characteristics_section(plan: Plan) -> Markup:
    """Every characteristic: not met, not measurable, then met; the least probable first in each group."""
    rows = [_characteristic_row(characteristic) for characteristic in ranked(plan)]
    return render(
        "characteristics.html",
        rows=rows,
        colours=viewpoint_colours(plan),
        status_words=STATUS_WORDS,
        without_tolerance=plan.without_tolerance,
    )


def _characteristic_row(characteristic: PlannedCharacteristic) -> _CharacteristicRow:
    measurable, reached = characteristic.status.is_judged, characteristic.measurand is not None
    return _CharacteristicRow(
        characteristic,
        _nominal(characteristic),
        _tolerance(characteristic),
        _defined(characteristic.probability) if measurable else None,
        _defined(characteristic.expected_accuracy) if reached else None,
        [name for name, _ in _acquisitions(characteristic)],
        _remark(characteristic),
    )


def _defined(value: float) -> float | None:
    return None if math.isnan(value) else value


def _nominal(characteristic: PlannedCharacteristic) -> str:
    """A nominal value: mm, but degrees for an angle."""
    value = characteristic.nominal_mm
    if characteristic.kind == "angle" and math.isfinite(value):
        return f"{length(math.degrees(value))}°"
    return length(value)


def _tolerance(characteristic: PlannedCharacteristic) -> str:
    """A tolerance in the unit of the nominal value."""
    if characteristic.kind != "angle" or characteristic.tolerance_mm is None:
        return tolerance(characteristic.tolerance_mm)
    lower, upper = characteristic.tolerance_mm
    return f"{tolerance((math.degrees(lower), math.degrees(upper)))}°"


def _remark(characteristic: PlannedCharacteristic) -> str:
    """What limits it and what is proven; of an averaged one what the best single acquisition would be worth."""
    if characteristic.acquisitions and characteristic.single_probability is not None:
        alone = probability(characteristic.single_probability)
        return f"mean of {len(characteristic.acquisitions)} acquisitions; the best alone {alone}"
    own = characteristic.indication.text if not characteristic.status.is_judged else ""
    sentences = [text for text in (own, characteristic.limit, characteristic.proof) if text]
    return ". ".join(text[0].upper() + text[1:] if n else text for n, text in enumerate(sentences))


def _acquisitions(characteristic: PlannedCharacteristic) -> list[tuple[str, NDArray[np.float64]]]:
    """The viewpoints that a characteristic is measured from, and what is measured from each."""
    if characteristic.acquisitions:
        return [(acquisition.viewpoint, acquisition.measurand) for acquisition in characteristic.acquisitions]
    return (
        [(characteristic.viewpoint, characteristic.measurand)]
        if characteristic.viewpoint and characteristic.measurand is not None
        else []
    )


def viewpoints_section(plan: Plan, part: Part, camera: Camera) -> Markup:
    """Every viewpoint: where it stands, where it looks, and what it measures."""
    rows = []
    for viewpoint in plan.viewpoints:
        distance = working_distance_mm(viewpoint, plan, part)
        rows.append(
            _ViewpointRow(
                viewpoint,
                _vector(viewpoint.T_part_camera[:3, 3], 1),
                _vector(viewpoint.T_part_camera[:3, 2], 3),
                f"{distance:.0f}",
                f"{distance * max(camera.pixel_pitch_mm) / camera.principal_distance_mm:.3f}",
            )
        )
    return render("viewpoints.html", rows=rows, colours=viewpoint_colours(plan))


def working_distance_mm(viewpoint: PlannedViewpoint, plan: Plan, part: Part) -> float:
    """Depth, along the optical axis, of the middle of the measurands measured from a viewpoint (of the part if
    none).
    """
    mine = [measurand for d in plan.characteristics for name, measurand in _acquisitions(d) if name == viewpoint.id]
    middle = np.mean(np.concatenate(mine), axis=0) if mine else part.mesh.bounds.mean(axis=0)
    return float((middle - viewpoint.T_part_camera[:3, 3]) @ viewpoint.T_part_camera[:3, 2])


def _vector(values: NDArray[np.float64], digits: int) -> str:
    rounded = np.round(values, digits) + 0.0  # no minus zero
    return ", ".join(f"{value:.{digits}f}".replace("-", "−") for value in rounded)
