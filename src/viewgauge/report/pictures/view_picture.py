"""What a camera sees from a viewpoint, with the measurands of the characteristics drawn on it, as SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from ..palette import probability_colour
from ..wording import element, probability

__all__ = ["REASON_WORDS", "SeenCharacteristic", "ViewpointView", "unseen_table", "view_picture"]

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
"""Most measurands that are named in the picture."""


@dataclass(frozen=True)
class SeenCharacteristic:
    """A characteristic in the image of a viewpoint.

    Parameters
    ----------
    reason
        Why it cannot be measured from here; empty where it can.
    ends_px
        ``(2, 2)`` px in the full image: the two points of its measurand; None where not visible.
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
class ViewpointView:
    """A simulated image of a viewpoint and what is in it.

    Parameters
    ----------
    png
        The image, of any size but the shape of the sensor.
    resolution
        Columns and rows of the full image, px.
    """

    viewpoint: str
    png: bytes
    resolution: tuple[int, int]
    characteristics: tuple[SeenCharacteristic, ...]


def view_picture(view: ViewpointView, required: float, *, chosen: str | None = None) -> str:
    """The image with the measurands on it, coloured by probability; the chosen one is drawn stronger.

    Parameters
    ----------
    required
        Probability.
    """
    columns, rows = view.resolution
    unit = columns / 480  # px of the image for each of the picture
    seen = [characteristic for characteristic in view.characteristics if characteristic.ends_px is not None]
    seen.sort(key=lambda characteristic: (characteristic.id == chosen, characteristic.planned))
    named = {characteristic.id for characteristic in seen[-_LABELS:]}
    marks = "".join(_measurand(d, required, unit, chosen=d.id == chosen, named=d.id in named) for d in seen)
    picture = base64.b64encode(view.png).decode()
    planned = sum(characteristic.planned for characteristic in seen)
    reported = f"Simulated view of {view.viewpoint}: {len(seen)} characteristics visible, {planned} measured from here"
    return (
        f'<svg class="view" role="img" aria-label="{escape(reported)}" viewBox="-0.5 -0.5 {columns} {rows}" '
        'style="width:100%;height:auto;display:block;border-radius:6px">'
        f"<title>{escape(reported)}</title>"
        f'<image x="-0.5" y="-0.5" width="{columns}" height="{rows}" href="data:image/png;base64,{picture}"/>'
        f"{marks}</svg>"
    )


def _measurand(characteristic: SeenCharacteristic, required: float, unit: float, *, chosen: bool, named: bool) -> str:
    assert characteristic.ends_px is not None  # the caller's condition
    (u0, v0), (u1, v1) = np.round(characteristic.ends_px, 1)
    colour = probability_colour(characteristic.probability, required)
    strong = chosen or characteristic.planned
    width = unit * (4.0 if chosen else 2.6 if characteristic.planned else 1.4)
    dashes = "" if strong else f' stroke-dasharray="{4 * unit:.1f} {3 * unit:.1f}"'
    met = characteristic.probability >= required
    ends = "".join(_end(u, v, unit * (4.5 if chosen else 3.2), colour, met) for u, v in ((u0, v0), (u1, v1)))
    reported = f"{characteristic.id}: probability {probability(characteristic.probability)}"
    line = f'x1="{u0}" y1="{v0}" x2="{u1}" y2="{v1}" stroke-linecap="round"'
    words = ""
    if named:
        size, (u, v) = 13 * unit, (characteristic.ends_px[0] + characteristic.ends_px[1]) / 2
        words = (
            f'<text x="{u + 5 * unit:.1f}" y="{v - 5 * unit:.1f}" font-size="{size:.1f}" font-weight="600" '
            f'font-family="system-ui, sans-serif" fill="#ffffff" stroke="#101820" stroke-width="{3 * unit:.1f}" '
            f'paint-order="stroke">{escape(("" if met else "✗ ") + characteristic.id)}</text>'
        )
    return (
        f"<g><title>{escape(reported)}</title>"
        f'<line {line} stroke="#ffffff" stroke-opacity="0.85" stroke-width="{width + 2 * unit:.1f}"/>'
        f'<line {line} stroke="{colour}" stroke-width="{width:.1f}"{dashes}/>{ends}{words}</g>'
    )


def _end(u: float, v: float, radius: float, colour: str, met: bool) -> str:
    shared = f'fill="{colour}" stroke="#ffffff" stroke-width="{radius / 3:.1f}"'
    if met:
        return f'<circle cx="{u}" cy="{v}" r="{radius:.1f}" {shared}/>'
    r = 1.5 * radius
    return f'<path d="M{u} {v - r:.1f} L{u + r:.1f} {v} L{u} {v + r:.1f} L{u - r:.1f} {v} Z" {shared}/>'


def unseen_table(characteristics: Sequence[SeenCharacteristic]) -> str:
    """Which characteristics cannot be measured from here, and why: one row for each reason."""
    by_reason: dict[str, list[str]] = {}
    for characteristic in characteristics:
        if characteristic.reason:
            by_reason.setdefault(characteristic.reason, []).append(characteristic.id)
    if not by_reason:
        return element("p", "Every characteristic is visible from here.", class_="hint")
    rows = "".join(
        element(
            "tr",
            markup=element("th", REASON_WORDS.get(reason, reason), scope="row") + element("td", ", ".join(names)),
        )
        for reason, names in by_reason.items()
    )
    return f'<table class="facts"><caption>Not visible from here</caption><tbody>{rows}</tbody></table>'
