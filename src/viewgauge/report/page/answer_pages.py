"""Pages on what to improve, and on cameras for a part; each one HTML text that needs nothing from outside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from importlib.metadata import version
from string import Template
from typing import Any

from ...evaluation.requirement.allowed_error import Requirement
from ...planning.improve.improvement import CameraChoice, Improvement, Specification
from ..wording import DASH, element, requirement_text, rounded
from .changes import changes_table
from .report_page import resource, script_data
from .tables import fact_table, markup_table

__all__ = ["render_improvement", "render_specification"]

_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#7A5195")  # as those of viewpoints (Okabe and Ito)
_MARKS = ("circle", "square", "diamond", "cross", "triangle-up", "x")


def render_improvement(
    improvement: Improvement, requirement: Requirement, *, title: str, inputs: Mapping[str, str]
) -> str:
    """What to improve as one HTML text: a picture of pixels against head, and the least change of each thing."""
    characteristics = improvement.characteristics
    met = sum(characteristic.met for characteristic in characteristics)
    verdict = f"{met} of {len(characteristics)} characteristics are met today"
    body = element("p", verdict, class_=f"verdict {'good' if met == len(characteristics) else 'bad'}")
    picture = _trade_picture(improvement)
    if picture:
        hint = "The part is met below the line: with that step of the edge detector, by a head that is no worse."
        body += _figure("Pixels against head", hint)
    hint = (
        "The least change of one thing alone, all else as today, that meets a characteristic; where it is "
        "met, how far it "
        f"may go. By {improvement.viewpoints:,} viewpoints that were tried. Hatched: no such change will do; the "
        "probability is what is reached without that error."
    )
    body += element("h2", "What would have to change") + element("p", hint, class_="hint") + changes_table(improvement)
    if improvement.left_out:
        names = ", ".join(improvement.left_out)
        body += element("p", f"No camera or head error is in the way of {names}: they are not seen.", class_="hint")
    return _page(f"{title} – what to improve", requirement, body, picture, inputs)


def render_specification(
    specification: Specification, requirement: Requirement, *, title: str, inputs: Mapping[str, str]
) -> str:
    """Cameras for a part as one HTML text: a picture of pixels against head, and a row for each sensor and lens."""
    smallest = specification.smallest
    if smallest is None:
        verdict = element("p", "No camera that was tried meets the part with the head of today", class_="verdict bad")
    else:
        reported = f"Fewest pixels with the head of today: {smallest.sensor.name}, {smallest.focal_length_mm:g} mm"
        verdict = element("p", reported, class_="verdict good")
    hint = "From the red line on the part is met with the head of today; higher, the head may be worse by that factor."
    body = verdict + _figure("Pixels against head", hint)
    body += element("h2", "Cameras") + _choice_table(specification)
    return _page(f"{title} – which camera", requirement, body, _choice_picture(specification.choices), inputs)


def _page(
    title: str, requirement: Requirement, body: str, picture: dict[str, Any] | None, inputs: Mapping[str, str]
) -> str:
    from plotly.offline import get_plotlyjs  # here: 5 MB that only a page needs

    return Template(resource("answers.html")).substitute(
        title=escape(title),
        style=resource("page.css"),
        requirement=escape(requirement_text(requirement)),
        body=body,
        inputs=fact_table({**inputs, "viewgauge": version("viewgauge")}),
        picture=script_data(picture),
        plotly=get_plotlyjs(),
    )


def _figure(heading: str, hint: str) -> str:
    picture = element("div", id="trade", class_="picture")
    return element("h2", heading) + element("p", hint, class_="hint") + element("figure", markup=picture)


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
        "name": "the part is just met",
        "line": {"color": _COLOURS[0], "width": 3},
    }
    today = {
        "x": [improvement.today["pixel"]],
        "y": [1.0],
        "mode": "markers",
        "name": "today",
        "marker": {"color": "#D00000", "size": 14, "symbol": "star"},
    }
    return {"data": [line, today], "layout": _layout("step of the edge detector / px", "errors of the head / of today")}


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
    layout = _layout("megapixels", "errors of the head, at most / of today")
    layout["shapes"] = [
        {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": 1, "y1": 1, "line": {"color": "#D00000", "width": 2}}
    ]
    return {"data": data, "layout": layout}


def _choice_table(specification: Specification) -> str:
    pose_error = [
        ("Sensor", ""),
        ("Pixel / µm", "num"),
        ("Lens / mm", "num"),
        ("Distance / mm", "num"),
        ("Met with the head of today", "num"),
        ("Head, at most / of today", "num"),
        ("Translation / mm", "num"),
        ("Rotation / deg", "num"),
        ("Or edge detector, at most / px", "num"),
    ]
    best = {id(choice) for choice in specification.best}
    rows = []
    for choice in specification.choices:
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
        cells = element("th", choice.sensor.name, scope="row", style="white-space:nowrap")
        cells += "".join(element("td", number, class_="num") for number in numbers)
        good = choice.pose_error.factor is not None and choice.pose_error.factor >= 1
        kind = ("met" if good else "not_met") + (" total" if id(choice) in best else "")
        rows.append(element("tr", markup=cells, class_=kind))
    return element("p", "In bold, of each sensor the lens with which the head may be worst.", class_="hint") + (
        markup_table(pose_error, rows)
    )
