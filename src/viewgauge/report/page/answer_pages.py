"""Pages on what to improve, and on cameras for a part; each one HTML text that needs nothing from outside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from ...evaluation.requirement.allowed_error import Requirement
from ...planning.improve.improvement import CameraChoice, Improvement, Specification
from ..templating import render_page
from ..wording import DASH, rounded
from .changes import changes_table

__all__ = ["render_improvement", "render_specification"]

_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#7A5195")  # as those of viewpoints (Okabe and Ito)
_MARKS = ("circle", "square", "diamond", "cross", "triangle-up", "x")


def render_improvement(
    improvement: Improvement, requirement: Requirement, *, title: str, inputs: Mapping[str, str]
) -> str:
    """What to improve as one HTML text: edge detector against pose uncertainty, and the least change of each thing."""
    characteristics = improvement.characteristics
    met = sum(characteristic.met for characteristic in characteristics)
    return _page(
        "improvement.html",
        f"{title} – what to improve",
        requirement,
        inputs,
        _trade_picture(improvement),
        verdict=f"{met} of {len(characteristics)} characteristics are met today",
        good=met == len(characteristics),
        viewpoints=improvement.viewpoints,
        changes=changes_table(improvement),
    )


def render_specification(
    specification: Specification, requirement: Requirement, *, title: str, inputs: Mapping[str, str]
) -> str:
    """Cameras for a part as one HTML text: pixels against the pose uncertainty, and a row for each sensor and lens."""
    smallest = specification.smallest
    verdict = "No camera that was tried measures every characteristic with today's pose uncertainty"
    if smallest is not None:
        verdict = (
            f"Fewest pixels with today's pose uncertainty: {smallest.sensor.name}, {smallest.focal_length_mm:g} mm"
        )
    best = {id(choice) for choice in specification.best}
    return _page(
        "specification.html",
        f"{title} – which camera",
        requirement,
        inputs,
        _choice_picture(specification.choices),
        verdict=verdict,
        good=smallest is not None,
        rows=[_choice_row(choice, specification, id(choice) in best) for choice in specification.choices],
    )


def _page(
    template: str,
    title: str,
    requirement: Requirement,
    inputs: Mapping[str, str],
    picture: dict[str, Any] | None,
    **values: Any,
) -> str:
    return render_page(
        template,
        picture,
        title=title,
        requirement=requirement.text,
        inputs={**inputs, "viewgauge": version("viewgauge")},
        has_picture=picture is not None,
        **values,
    )


def _layout(x: str, y: str) -> dict[str, Any]:
    ticks = [step * 10.0**power for power in range(-6, 6) for step in (1, 2, 5)]
    axis = {
        "type": "log",
        "gridcolor": "#d5dce4",
        "linecolor": "#5a6877",
        "tickvals": ticks,
        "ticktext": [f"{tick:g}" for tick in ticks],
    }
    return {
        "xaxis": {**axis, "title": {"text": x}},
        "yaxis": {**axis, "title": {"text": y}},
        "plot_bgcolor": "#ffffff",
        "paper_bgcolor": "#ffffff",
        "font": {"color": "#1c2733"},
        "margin": {"l": 70, "r": 20, "t": 20, "b": 60},
        "legend": {"orientation": "h", "y": 1.08},
    }


def _trade_picture(improvement: Improvement) -> dict[str, Any] | None:
    trades = [(t.pixel_px, t.pose_error_factor) for t in improvement.trade_off if t.pose_error_factor is not None]
    if not trades:
        return None
    line = {
        "x": [pixel for pixel, _ in trades],
        "y": [factor for _, factor in trades],
        "mode": "lines+markers",
        "name": "every characteristic is just met",
        "line": {"color": _COLOURS[0], "width": 3},
    }
    today = {
        "x": [improvement.today["pixel"]],
        "y": [1.0],
        "mode": "markers",
        "name": "today",
        "marker": {"color": "#D00000", "size": 14, "symbol": "star"},
    }
    return {
        "data": [line, today],
        "layout": _layout("step of the edge detector / px", "largest pose uncertainty / of today's"),
    }


def _choice_picture(choices: Sequence[CameraChoice]) -> dict[str, Any]:
    data: list[dict[str, Any]] = []
    for k, lens in enumerate(sorted({choice.focal_length_mm for choice in choices})):
        shown = [c for c in choices if c.focal_length_mm == lens and c.pose_error.factor is not None]
        data.append(
            {
                "x": [c.sensor.resolution[0] * c.sensor.resolution[1] / 1e6 for c in shown],
                "y": [c.pose_error.factor for c in shown],
                "text": [c.sensor.name for c in shown],
                "mode": "markers+lines",
                "name": f"{lens:g} mm",
                "marker": {"symbol": _MARKS[k % len(_MARKS)], "size": 10, "color": _COLOURS[k % len(_COLOURS)]},
                "line": {"dash": "dot", "width": 1},
            }
        )
    layout = _layout("megapixels", "largest pose uncertainty / of today's")
    layout["shapes"] = [
        {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": 1, "y1": 1, "line": {"color": "#D00000", "width": 2}}
    ]
    return {"data": data, "layout": layout}


@dataclass(frozen=True)
class _ChoiceRow:
    """A sensor with a lens as it is printed, and the classes of its row."""

    sensor: str
    kind: str
    numbers: list[str]


def _choice_row(choice: CameraChoice, specification: Specification, best: bool) -> _ChoiceRow:
    near, far = choice.distance_mm
    values = (
        choice.pose_error.factor,
        choice.translation_mm,
        choice.rotation_deg,
        None if choice.pixel is None else choice.pixel.value,
    )
    numbers = [
        f"{1000 * choice.sensor.pixel_pitch_mm:g}",
        f"{choice.focal_length_mm:g}",
        f"{near:.0f} to {far:.0f}",
        f"{choice.met} of {specification.characteristics}",
        *(DASH if value is None else rounded(value) for value in values),
    ]
    good = choice.pose_error.factor is not None and choice.pose_error.factor >= 1
    return _ChoiceRow(choice.sensor.name, ("met" if good else "not_met") + (" total" if best else ""), numbers)
