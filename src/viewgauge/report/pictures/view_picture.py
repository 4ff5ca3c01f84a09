"""What a camera sees from a setting, with the gauges of the dimensions drawn on it, as SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from ..palette import probability_colour
from ..wording import element, probability

__all__ = ["REASON_WORDS", "SeenDimension", "SettingView", "unseen_table", "view_picture"]

REASON_WORDS = {
    "behind_camera": "behind the camera",
    "out_of_view": "outside the image",
    "facing_away": "its faces are turned away",
    "too_short": "too short in the image",
    "out_of_focus": "out of focus",
    "occluded": "hidden by the part",
}
"""Of the observability conditions."""

_LABELS = 30
"""Most gauges that are named in the picture."""


@dataclass(frozen=True)
class SeenDimension:
    """A dimension in the image of a setting.

    Parameters
    ----------
    reason
        Why it cannot be measured from here; empty where it can.
    ends_px
        ``(2, 2)`` px in the full image: the two points of its gauge; None where not visible.
    probability
        From here; 0 where not visible.
    planned
        The plan measures it from here.
    """

    id: str
    reason: str
    ends_px: NDArray[np.float64] | None
    probability: float
    planned: bool = False


@dataclass(frozen=True)
class SettingView:
    """A simulated image of a setting and what is in it.

    Parameters
    ----------
    png
        The image, of any size but the shape of the sensor.
    resolution
        Columns and rows of the full image, px.
    """

    setting: str
    png: bytes
    resolution: tuple[int, int]
    dimensions: tuple[SeenDimension, ...]


def view_picture(view: SettingView, required: float, *, chosen: str | None = None) -> str:
    """The image with the gauges on it, coloured by probability; the chosen one is drawn stronger.

    Parameters
    ----------
    required
        Probability.
    """
    columns, rows = view.resolution
    unit = columns / 480  # px of the image for each of the picture
    seen = [dimension for dimension in view.dimensions if dimension.ends_px is not None]
    seen.sort(key=lambda dimension: (dimension.id == chosen, dimension.planned))
    named = {dimension.id for dimension in seen[-_LABELS:]}
    marks = "".join(_gauge(d, required, unit, chosen=d.id == chosen, named=d.id in named) for d in seen)
    picture = base64.b64encode(view.png).decode()
    planned = sum(dimension.planned for dimension in seen)
    told = f"Simulated view of {view.setting}: {len(seen)} dimensions visible, {planned} measured from here"
    return (
        f'<svg class="view" role="img" aria-label="{escape(told)}" viewBox="-0.5 -0.5 {columns} {rows}" '
        'style="width:100%;height:auto;display:block;border-radius:6px">'
        f"<title>{escape(told)}</title>"
        f'<image x="-0.5" y="-0.5" width="{columns}" height="{rows}" href="data:image/png;base64,{picture}"/>'
        f"{marks}</svg>"
    )


def _gauge(dimension: SeenDimension, required: float, unit: float, *, chosen: bool, named: bool) -> str:
    assert dimension.ends_px is not None  # the caller's condition
    (u0, v0), (u1, v1) = np.round(dimension.ends_px, 1)
    colour = probability_colour(dimension.probability, required)
    strong = chosen or dimension.planned
    width = unit * (4.0 if chosen else 2.6 if dimension.planned else 1.4)
    dashes = "" if strong else f' stroke-dasharray="{4 * unit:.1f} {3 * unit:.1f}"'
    met = dimension.probability >= required
    ends = "".join(_end(u, v, unit * (4.5 if chosen else 3.2), colour, met) for u, v in ((u0, v0), (u1, v1)))
    told = f"{dimension.id}: probability {probability(dimension.probability)}"
    line = f'x1="{u0}" y1="{v0}" x2="{u1}" y2="{v1}" stroke-linecap="round"'
    words = ""
    if named:
        size, (u, v) = 13 * unit, (dimension.ends_px[0] + dimension.ends_px[1]) / 2
        words = (
            f'<text x="{u + 5 * unit:.1f}" y="{v - 5 * unit:.1f}" font-size="{size:.1f}" font-weight="600" '
            f'font-family="system-ui, sans-serif" fill="#ffffff" stroke="#101820" stroke-width="{3 * unit:.1f}" '
            f'paint-order="stroke">{escape(("" if met else "✗ ") + dimension.id)}</text>'
        )
    return (
        f"<g><title>{escape(told)}</title>"
        f'<line {line} stroke="#ffffff" stroke-opacity="0.85" stroke-width="{width + 2 * unit:.1f}"/>'
        f'<line {line} stroke="{colour}" stroke-width="{width:.1f}"{dashes}/>{ends}{words}</g>'
    )


def _end(u: float, v: float, radius: float, colour: str, met: bool) -> str:
    shared = f'fill="{colour}" stroke="#ffffff" stroke-width="{radius / 3:.1f}"'
    if met:
        return f'<circle cx="{u}" cy="{v}" r="{radius:.1f}" {shared}/>'
    r = 1.5 * radius
    return f'<path d="M{u} {v - r:.1f} L{u + r:.1f} {v} L{u} {v + r:.1f} L{u - r:.1f} {v} Z" {shared}/>'


def unseen_table(dimensions: Sequence[SeenDimension]) -> str:
    """Which dimensions cannot be measured from here, and why: one row for each reason."""
    by_reason: dict[str, list[str]] = {}
    for dimension in dimensions:
        if dimension.reason:
            by_reason.setdefault(dimension.reason, []).append(dimension.id)
    if not by_reason:
        return element("p", "Every dimension is visible from here.", class_="hint")
    rows = "".join(
        element(
            "tr",
            markup=element("th", REASON_WORDS.get(reason, reason), scope="row") + element("td", ", ".join(names)),
        )
        for reason, names in by_reason.items()
    )
    return f'<table class="facts"><caption>Not visible from here</caption><tbody>{rows}</tbody></table>'
