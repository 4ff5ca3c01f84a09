"""What a camera sees from a viewpoint, with the measurands of the characteristics drawn on it, as SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..palette import probability_colour
from ..templating import Markup, render

__all__ = ["REASON_WORDS", "SeenCharacteristic", "ViewpointView", "unseen_table", "view_picture"]

REASON_WORDS = {
    "behind_camera": "behind the camera",
    "out_of_view": "outside the image",
    "facing_away": "its faces are turned away",
    "too_short": "too short in the image",
    "out_of_focus": "out of focus",
    "occluded": "hidden by the part",
}
"""What each observability condition that fails is called."""

_WIDTH = 480
"""Of the picture, in units of which strokes and letters have a few."""

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
        The probability from here; 0 where not visible.
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


@dataclass(frozen=True)
class _Mark:
    """A measurand as it is drawn; lengths are px of the full image.

    Parameters
    ----------
    ends
        (u, v) of both.
    label_at
        Where its name stands; None for no name.
    """

    id: str
    probability: float
    met: bool
    colour: str
    ends: tuple[tuple[float, float], ...]
    width: float
    radius: float
    broken: bool
    label_at: tuple[float, float] | None


def view_picture(view: ViewpointView, required: float, *, chosen: str | None = None) -> Markup:
    """The image with the measurands on it, coloured by probability; the chosen one is drawn stronger.

    Parameters
    ----------
    required
        The required probability.
    """
    columns, rows = view.resolution
    unit = columns / _WIDTH
    seen = [characteristic for characteristic in view.characteristics if characteristic.ends_px is not None]
    seen.sort(key=lambda characteristic: (characteristic.id == chosen, characteristic.planned))
    named = {characteristic.id for characteristic in seen[-_LABELS:]}
    planned = sum(characteristic.planned for characteristic in seen)
    return render(
        "view_picture.svg",
        description=f"Simulated view of {view.viewpoint}: {len(seen)} characteristics visible, {planned} measured "
        "from here",
        columns=columns,
        rows=rows,
        png=base64.b64encode(view.png).decode(),
        unit=unit,
        marks=[_mark(d, required, unit, chosen=d.id == chosen, named=d.id in named) for d in seen],
    )


def _mark(characteristic: SeenCharacteristic, required: float, unit: float, *, chosen: bool, named: bool) -> _Mark:
    assert characteristic.ends_px is not None  # the caller's condition
    u, v = characteristic.ends_px.mean(axis=0)
    return _Mark(
        characteristic.id,
        characteristic.probability,
        characteristic.probability >= required,
        probability_colour(characteristic.probability, required),
        tuple((float(u), float(v)) for u, v in np.round(characteristic.ends_px, 1)),
        unit * (4.0 if chosen else 2.6 if characteristic.planned else 1.4),
        unit * (4.5 if chosen else 3.2),
        not (chosen or characteristic.planned),
        (float(u) + 5 * unit, float(v) - 5 * unit) if named else None,
    )


def unseen_table(characteristics: Sequence[SeenCharacteristic]) -> Markup:
    """Which characteristics cannot be measured from here, and why: one row for each reason."""
    by_reason: dict[str, list[str]] = {}
    for characteristic in characteristics:
        if characteristic.reason:
            words = REASON_WORDS.get(characteristic.reason, characteristic.reason)
            by_reason.setdefault(words, []).append(characteristic.id)
    return render("unseen.html", names_by_reason={reason: ", ".join(names) for reason, names in by_reason.items()})
