"""The colours of everything that is shown, told apart by colour-blind readers too.

Viewpoints and error sources have Okabe and Ito's colours ("Color Universal Design", 2008). Probabilities have two ramps
that meet at the required one: blue from there on, darker for a higher probability; orange to dark red below it. Nothing
is told by colour alone: what is not met has a thicker line, a diamond and a cross as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from ..planning.plan import Plan

__all__ = [
    "DARK",
    "LIGHT",
    "NOT_MET_COLOUR",
    "OTHER_SOURCE_COLOUR",
    "SOURCE_COLOURS",
    "UNSEEN_COLOUR",
    "Theme",
    "colours_of",
    "probability_colour",
    "probability_scale",
    "viewpoint_colours",
    "viewpoint_markers",
]

# Without black, yellow (invisible on white) and vermilion.
VIEWPOINT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#7A5195")
MARKERS = ("circle", "square", "circle-open", "square-open")  # the diamond is kept for what is not met
NOT_MET_COLOUR = "#D00000"
UNSEEN_COLOUR = "#8a94a0"

SOURCE_COLOURS = {
    "translation": "#0072b2",
    "rotation": "#56b4e9",
    "u": "#e69f00",
    "v": "#d55e00",
    "edges": "#f0e442",
    "calibration": "#009e73",
}
"""The colour of each part of the error budget."""

OTHER_SOURCE_COLOUR = "#cc79a7"
"""Of a source of error that a camera has beside these."""

_IMPOSSIBLE, _NEARLY = (122, 4, 3), (240, 150, 50)  # at 0, and just below what is required
_JUST, _CERTAIN = (86, 170, 232), (0, 60, 130)  # at what is required, and at 1


@dataclass(frozen=True)
class Theme:
    """Paper and inks of a chart."""

    paper: str
    panel: str
    ink: str
    soft: str
    line: str
    good: str
    bad: str


LIGHT = Theme("#ffffff", "#f4f6f9", "#1c2733", "#5a6877", "#d5dce4", "#00664a", "#a80000")
DARK = Theme("#12181f", "#1b232c", "#e6ebf1", "#9fadbb", "#33404d", "#6ddcae", "#ff9c9c")


def colours_of(names: Iterable[str]) -> dict[str, str]:
    """A colour for each name, in their order; with more names than colours they repeat."""
    return {name: VIEWPOINT_COLOURS[k % len(VIEWPOINT_COLOURS)] for k, name in enumerate(names)}


def viewpoint_colours(plan: Plan) -> dict[str, str]:
    """A colour per viewpoint id; with more viewpoints than colours they repeat with another marker."""
    return colours_of(viewpoint.id for viewpoint in plan.viewpoints)


def viewpoint_markers(plan: Plan) -> dict[str, str]:
    """A marker per viewpoint id."""
    return {
        viewpoint.id: MARKERS[k // len(VIEWPOINT_COLOURS) % len(MARKERS)] for k, viewpoint in enumerate(plan.viewpoints)
    }


def _mixed(low: tuple[int, int, int], high: tuple[int, int, int], share: float) -> str:
    share = min(max(share, 0.0), 1.0)
    return "#" + "".join(f"{round(a + share * (b - a)):02x}" for a, b in zip(low, high, strict=True))


def probability_colour(probability: float, required: float) -> str:
    """Hexadecimal; in blues by the order of what is left to certainty, in oranges and reds in proportion."""
    if probability >= required:
        orders = math.log10((1 - required) / max(1 - probability, 1e-12)) if required < 1 else 0.0
        return _mixed(_JUST, _CERTAIN, orders / 3)
    return _mixed(_IMPOSSIBLE, _NEARLY, probability / required)


def probability_scale(required: float) -> list[tuple[float, str]]:
    """The same as a Plotly colour scale of probabilities from 0 to 1."""
    below = [(share * required, _mixed(_IMPOSSIBLE, _NEARLY, share)) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
    steps = [required + (1 - required) * (1 - 10.0 ** (-orders)) for orders in (0.0, 0.5, 1.0, 2.0)]
    above = [(step, probability_colour(step, required)) for step in steps]
    return [*below, *above, (1.0, _mixed(_JUST, _CERTAIN, 1.0))]
