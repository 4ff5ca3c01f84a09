"""The tables of the report: dimensions, settings, inputs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from ...part.characteristic import Part
from ...planning.plan import Plan, PlannedDimension, PlannedSetting, Status
from ...sensors.camera import Camera
from ..palette import setting_colours
from ..wording import DASH, element, length, probability, tolerance

__all__ = ["dimension_table", "fact_table", "markup_table", "setting_table"]

STATUS_WORDS: dict[Status, str] = {"unmet": "not met", "not_measurable": "not measurable", "met": "met"}


def markup_table(head: Sequence[tuple[str, str]], rows: Iterable[str]) -> str:
    """A table; each heading comes with the class of its column (``num`` for numbers)."""
    cells = "".join(element("th", text, scope="col", class_=kind) for text, kind in head)
    return (
        '<div class="scroll"><table><thead>'
        + element("tr", markup=cells)
        + "</thead><tbody>"
        + "".join(rows)
        + "</tbody></table></div>"
    )


def _setting_mark(name: str, colours: Mapping[str, str]) -> str:
    swatch = element("span", class_="swatch", style=f"background:{colours.get(name, 'transparent')}")
    return swatch + element("span", name)


def _quantity(value: float, kind: str) -> str:
    """A nominal value: mm, but degrees for an angle."""
    return f"{length(math.degrees(value))}°" if kind == "angle" and math.isfinite(value) else length(value)


def _tolerance(dimension: PlannedDimension) -> str:
    """A tolerance in the unit of the nominal value."""
    if dimension.kind != "angle" or dimension.tolerance_mm is None:
        return tolerance(dimension.tolerance_mm)
    lower, upper = dimension.tolerance_mm
    return f"{tolerance((math.degrees(lower), math.degrees(upper)))}°"


def _share(value: float) -> str:
    """A probability or an accuracy, with all its digits for the pointer."""
    if math.isnan(value):
        return element("td", DASH, class_="num")
    return element("td", probability(value), class_="num", title=repr(float(value)))


def _dimension_row(dimension: PlannedDimension, colours: Mapping[str, str]) -> str:
    reached = dimension.gauge is not None
    surely = dimension.probability if dimension.status != "not_measurable" else math.nan
    cells = (
        element("th", dimension.id, scope="row"),
        element("td", dimension.kind),
        element("td", _quantity(dimension.nominal_mm, dimension.kind), class_="num"),
        element("td", _tolerance(dimension), class_="num"),
        element("td", length(dimension.allowed_error_mm), class_="num"),
        element("td", markup=element("span", STATUS_WORDS[dimension.status], class_=f"status {dimension.status}")),
        _share(surely),
        _share(dimension.expected_accuracy if reached else math.nan),
        _settings_cell(dimension, colours),
        element("td", _remark(dimension), class_="limit"),
    )
    return element("tr", markup="".join(cells), class_=dimension.status)


def _settings_cell(dimension: PlannedDimension, colours: Mapping[str, str]) -> str:
    """The setting, or those of several looks."""
    names = [name for name, _ in _looks(dimension)]
    return element("td", markup="<br>".join(_setting_mark(name, colours) for name in names) or escape(DASH))


def _remark(dimension: PlannedDimension) -> str:
    """What limits it and what is proven; of an averaged one what the best single look would be worth."""
    if dimension.looks and dimension.single_probability is not None:
        alone = probability(dimension.single_probability)
        return f"mean of {len(dimension.looks)} looks; the best alone {alone}"
    return ". ".join(said[0].upper() + said[1:] if n else said for n, said in enumerate(_said(dimension)))


def _said(dimension: PlannedDimension) -> list[str]:
    return [text for text in (dimension.limit, dimension.proof) if text]


def dimension_table(plan: Plan) -> str:
    """Every dimension: not met, not measurable, then met; the least sure first in each group."""
    head = [
        ("Dimension", ""),
        ("Kind", ""),
        ("Nominal / mm", "num"),
        ("Tolerance / mm", "num"),
        ("Allowed error / mm", "num"),
        ("Status", ""),
        ("Probability", "num"),
        ("Expected accuracy", "num"),
        ("Setting", ""),
        ("Limited by", ""),
    ]
    order = list(STATUS_WORDS)
    ranked = sorted(plan.dimensions, key=lambda dimension: (order.index(dimension.status), dimension.probability))
    colours = setting_colours(plan)
    return markup_table(head, [_dimension_row(dimension, colours) for dimension in ranked])


def working_distance_mm(setting: PlannedSetting, plan: Plan, part: Part) -> float:
    """Depth, along the optical axis, of the middle of the gauges measured from a setting (of the part if none)."""
    mine = [gauge for d in plan.dimensions for name, gauge in _looks(d) if name == setting.id]
    middle = np.mean(np.concatenate(mine), axis=0) if mine else part.mesh.bounds.mean(axis=0)
    return float((middle - setting.T_part_camera[:3, 3]) @ setting.T_part_camera[:3, 2])


def _looks(dimension: PlannedDimension) -> list[tuple[str, NDArray[np.float64]]]:
    """The settings that a dimension is measured from, and what is measured from each."""
    if dimension.looks:
        return [(look.setting, look.gauge) for look in dimension.looks]
    return [(dimension.setting, dimension.gauge)] if dimension.setting and dimension.gauge is not None else []


def _vector(values: np.ndarray, digits: int) -> str:
    rounded = np.round(values, digits) + 0.0  # no minus zero
    return ", ".join(f"{value:.{digits}f}".replace("-", "−") for value in rounded)


def setting_table(plan: Plan, part: Part, camera: Camera) -> str:
    """Every setting: where it stands, where it looks, and what it measures."""
    if not plan.settings:
        return element("p", "None.")
    head = [
        ("Setting", ""),
        ("Position x, y, z / mm", "num"),
        ("Viewing direction", "num"),
        ("Working distance / mm", "num"),
        ("Pixel on the part / mm", "num"),
        ("Measures", "num"),
        ("Dimensions", "limit"),
    ]
    colours = setting_colours(plan)
    rows = []
    for setting in plan.settings:
        distance = working_distance_mm(setting, plan, part)
        pixel = distance * max(camera.pixel_pitch_mm) / camera.focal_length_mm
        cells = (
            element("td", markup=_setting_mark(setting.id, colours)),
            element("td", _vector(setting.T_part_camera[:3, 3], 1), class_="num"),
            element("td", _vector(setting.T_part_camera[:3, 2], 3), class_="num"),
            element("td", f"{distance:.0f}", class_="num"),
            element("td", f"{pixel:.3f}", class_="num"),
            element("td", str(len(setting.observes)), class_="num"),
            element("td", ", ".join(setting.observes), class_="limit"),
        )
        rows.append(element("tr", markup="".join(cells)))
    return markup_table(head, rows)


def fact_table(facts: Mapping[str, str]) -> str:
    """Names and values, one pair a row."""
    rows = [element("tr", markup=element("th", k, scope="row") + element("td", v)) for k, v in facts.items()]
    return '<table class="facts"><tbody>' + "".join(rows) + "</tbody></table>"
