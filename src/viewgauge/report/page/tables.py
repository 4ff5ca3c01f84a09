"""The tables of the report: characteristics, viewpoints, inputs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from ...part import Part
from ...planning.plan import Plan, PlannedCharacteristic, PlannedViewpoint, Status
from ...sensors.camera import Camera
from ..palette import viewpoint_colours
from ..wording import DASH, element, length, probability, tolerance

__all__ = ["characteristic_table", "fact_table", "markup_table", "viewpoint_table"]

STATUS_WORDS = {
    Status.NOT_MET: "not met",
    Status.NOT_MEASURABLE: "not measurable",
    Status.MET: "met",
}


def markup_table(pose_error: Sequence[tuple[str, str]], rows: Iterable[str]) -> str:
    """A table; each heading comes with the class of its column (``num`` for numbers)."""
    cells = "".join(element("th", text, scope="col", class_=kind) for text, kind in pose_error)
    return (
        '<div class="scroll"><table><thead>'
        + element("tr", markup=cells)
        + "</thead><tbody>"
        + "".join(rows)
        + "</tbody></table></div>"
    )


def _viewpoint_mark(name: str, colours: Mapping[str, str]) -> str:
    swatch = element("span", class_="swatch", style=f"background:{colours.get(name, 'transparent')}")
    return swatch + element("span", name)


def _quantity(value: float, kind: str) -> str:
    """A nominal value: mm, but degrees for an angle."""
    return f"{length(math.degrees(value))}°" if kind == "angle" and math.isfinite(value) else length(value)


def _tolerance(characteristic: PlannedCharacteristic) -> str:
    """A tolerance in the unit of the nominal value."""
    if characteristic.kind != "angle" or characteristic.tolerance_mm is None:
        return tolerance(characteristic.tolerance_mm)
    lower, upper = characteristic.tolerance_mm
    return f"{tolerance((math.degrees(lower), math.degrees(upper)))}°"


def _share(value: float) -> str:
    """A probability or an accuracy, with all its digits for the pointer."""
    if math.isnan(value):
        return element("td", DASH, class_="num")
    return element("td", probability(value), class_="num", title=repr(float(value)))


def _characteristic_row(characteristic: PlannedCharacteristic, colours: Mapping[str, str]) -> str:
    reached = characteristic.measurand is not None
    surely = characteristic.probability if characteristic.status != "not_measurable" else math.nan
    cells = (
        element("th", characteristic.id, scope="row"),
        element("td", characteristic.kind),
        element("td", _quantity(characteristic.nominal_mm, characteristic.kind), class_="num"),
        element("td", _tolerance(characteristic), class_="num"),
        element("td", length(characteristic.allowed_error_mm), class_="num"),
        element(
            "td", markup=element("span", STATUS_WORDS[characteristic.status], class_=f"status {characteristic.status}")
        ),
        _share(surely),
        _share(characteristic.expected_accuracy if reached else math.nan),
        _viewpoints_cell(characteristic, colours),
        element("td", _remark(characteristic), class_="limit"),
    )
    return element("tr", markup="".join(cells), class_=characteristic.status)


def _viewpoints_cell(characteristic: PlannedCharacteristic, colours: Mapping[str, str]) -> str:
    """The viewpoint, or those of several viewpoints."""
    names = [name for name, _ in _acquisitions(characteristic)]
    return element("td", markup="<br>".join(_viewpoint_mark(name, colours) for name in names) or escape(DASH))


def _remark(characteristic: PlannedCharacteristic) -> str:
    """What limits it and what is proven; of an averaged one what the best single acquisition would be worth."""
    if characteristic.acquisitions and characteristic.single_probability is not None:
        alone = probability(characteristic.single_probability)
        return f"mean of {len(characteristic.acquisitions)} acquisitions; the best alone {alone}"
    return ". ".join(said[0].upper() + said[1:] if n else said for n, said in enumerate(_said(characteristic)))


def _said(characteristic: PlannedCharacteristic) -> list[str]:
    return [text for text in (characteristic.limit, characteristic.proof) if text]


def characteristic_table(plan: Plan) -> str:
    """Every characteristic: not met, not measurable, then met; the least sure first in each group."""
    pose_error = [
        ("Characteristic", ""),
        ("Kind", ""),
        ("Nominal / mm", "num"),
        ("Tolerance / mm", "num"),
        ("Allowed error / mm", "num"),
        ("Status", ""),
        ("Probability", "num"),
        ("Expected accuracy", "num"),
        ("Viewpoint", ""),
        ("Limited by", ""),
    ]
    order = list(STATUS_WORDS)
    ranked = sorted(
        plan.characteristics,
        key=lambda characteristic: (order.index(characteristic.status), characteristic.probability),
    )
    colours = viewpoint_colours(plan)
    return markup_table(pose_error, [_characteristic_row(characteristic, colours) for characteristic in ranked])


def working_distance_mm(viewpoint: PlannedViewpoint, plan: Plan, part: Part) -> float:
    """Depth, along the optical axis, of the middle of the measurands measured from a viewpoint (of the part if
    none).
    """
    mine = [measurand for d in plan.characteristics for name, measurand in _acquisitions(d) if name == viewpoint.id]
    middle = np.mean(np.concatenate(mine), axis=0) if mine else part.mesh.bounds.mean(axis=0)
    return float((middle - viewpoint.T_part_camera[:3, 3]) @ viewpoint.T_part_camera[:3, 2])


def _acquisitions(characteristic: PlannedCharacteristic) -> list[tuple[str, NDArray[np.float64]]]:
    """The viewpoints that a characteristic is measured from, and what is measured from each."""
    if characteristic.acquisitions:
        return [(acquisition.viewpoint, acquisition.measurand) for acquisition in characteristic.acquisitions]
    return (
        [(characteristic.viewpoint, characteristic.measurand)]
        if characteristic.viewpoint and characteristic.measurand is not None
        else []
    )


def _vector(values: np.ndarray, digits: int) -> str:
    rounded = np.round(values, digits) + 0.0  # no minus zero
    return ", ".join(f"{value:.{digits}f}".replace("-", "−") for value in rounded)


def viewpoint_table(plan: Plan, part: Part, camera: Camera) -> str:
    """Every viewpoint: where it stands, where it acquisitions, and what it measures."""
    if not plan.viewpoints:
        return element("p", "None.")
    pose_error = [
        ("Viewpoint", ""),
        ("Position x, y, z / mm", "num"),
        ("Viewing direction", "num"),
        ("Working distance / mm", "num"),
        ("Pixel on the part / mm", "num"),
        ("Measures", "num"),
        ("Characteristics", "limit"),
    ]
    colours = viewpoint_colours(plan)
    rows = []
    for viewpoint in plan.viewpoints:
        distance = working_distance_mm(viewpoint, plan, part)
        pixel = distance * max(camera.pixel_pitch_mm) / camera.focal_length_mm
        cells = (
            element("td", markup=_viewpoint_mark(viewpoint.id, colours)),
            element("td", _vector(viewpoint.T_part_camera[:3, 3], 1), class_="num"),
            element("td", _vector(viewpoint.T_part_camera[:3, 2], 3), class_="num"),
            element("td", f"{distance:.0f}", class_="num"),
            element("td", f"{pixel:.3f}", class_="num"),
            element("td", str(len(viewpoint.observes)), class_="num"),
            element("td", ", ".join(viewpoint.observes), class_="limit"),
        )
        rows.append(element("tr", markup="".join(cells)))
    return markup_table(pose_error, rows)


def fact_table(facts: Mapping[str, str]) -> str:
    """Names and values, one pair a row."""
    rows = [element("tr", markup=element("th", k, scope="row") + element("td", v)) for k, v in facts.items()]
    return '<table class="facts"><tbody>' + "".join(rows) + "</tbody></table>"
