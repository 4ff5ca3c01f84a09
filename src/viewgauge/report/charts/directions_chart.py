"""The sphere of directions as a map of probability."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...planning.candidates.direction_map import DirectionMap
from ..palette import UNSEEN_COLOUR, probability_scale
from .style import COLOUR_BAR, Figure, figure, plain, theme_of

__all__ = ["directions_chart"]

_CIRCLES_DEG = (30, 60, 90, 120, 150)


def directions_chart(
    found: DirectionMap,
    required: float,
    cameras: Mapping[str, Sequence[float]] | None = None,
    *,
    dark: bool = False,
) -> Figure:
    """The whole sphere in one disc, in true areas, with +z in its middle and −z as its rim.

    Parameters
    ----------
    cameras
        Directions from the part, part frame, of cameras to mark, by name.

    References
    ----------
    Lambert's azimuthal equal-area projection: Snyder, *Map Projections: A Working Manual*, 1987, eq. 24-1 to 24-4.
    """
    theme = theme_of(dark)
    data = _map_traces(found, required)
    if cameras:
        data.append(_camera_trace(cameras, theme.ink))
    hidden = {"visible": False, "range": [-2.2, 2.2], "fixedrange": True}
    most_probable = float(found.probability.max(initial=0.0))
    return figure(
        data,
        theme,
        f"{plain(found.characteristic)} from all directions, {found.distance_mm:.0f} mm away: at best "
        f"{most_probable:.4f}",
        hovermode="closest",
        xaxis={**hidden, "scaleanchor": "y"},
        yaxis=hidden,
        shapes=_circles(theme.soft),
        annotations=_names(theme.soft),
        margin={"l": 8, "r": 8, "t": 40, "b": 8},
    )


def _map_traces(found: DirectionMap, required: float) -> list[Figure]:
    """The directions that do not see the characteristic, in grey, and those that do, in the colours of probability."""
    seen = found.reason == ""
    places = _projected(found.directions)
    size = 380.0 / np.sqrt(len(places))
    reported = [_reported(*row) for row in zip(found.directions, found.probability, found.reason, strict=True)]
    coloured = {
        "color": [round(float(p), 6) for p in found.probability[seen]],
        "colorscale": [list(stop) for stop in probability_scale(required)],
        "cmin": 0,
        "cmax": 1,
        "size": size,
        "colorbar": COLOUR_BAR,
    }
    grey = {"color": UNSEEN_COLOUR, "opacity": 0.35, "size": size}
    return [
        {
            "type": "scatter",
            "mode": "markers",
            "name": words,
            "x": np.round(places[where, 0], 4).tolist(),
            "y": np.round(places[where, 1], 4).tolist(),
            "text": [text for text, shown in zip(reported, where, strict=True) if shown],
            "marker": marker,
            "hovertemplate": "%{text}<extra></extra>",
            "showlegend": False,
        }
        for where, words, marker in ((~seen, "not seen", grey), (seen, "probability", coloured))
    ]


def _camera_trace(cameras: Mapping[str, Sequence[float]], ink: str) -> Figure:
    """Stars, with their names, in the directions of cameras."""
    at = _projected(np.array(list(cameras.values()), dtype=float))
    return {
        "type": "scatter",
        "mode": "markers+text",
        "x": np.round(at[:, 0], 4).tolist(),
        "y": np.round(at[:, 1], 4).tolist(),
        "text": [plain(name) for name in cameras],
        "textposition": "top center",
        "textfont": {"color": ink, "size": 13},
        "marker": {"symbol": "star", "size": 15, "color": "#ffffff", "line": {"color": "#000000", "width": 1.5}},
        "hovertemplate": "camera %{text}<extra></extra>",
        "showlegend": False,
    }


def _projected(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 2)`` of unit vectors ``(n, 3)``; the disc has radius 2."""
    x, y, z = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).T
    stretch = np.sqrt(2 / np.maximum(1 + z, 1e-12))
    return np.stack([x * stretch, y * stretch], axis=1)


def _reported(direction: NDArray[np.float64], probability: float, reason: str) -> str:
    tilt = np.degrees(np.arccos(np.clip(direction[2], -1, 1)))
    turn = np.degrees(np.arctan2(direction[1], direction[0]))
    what = f"probability {probability:.4f}" if not reason else f"not seen: {reason.replace('_', ' ')}"
    return f"{what}<br>{tilt:.0f}° from +z, {turn:.0f}° around it".replace("-", "−")


def _circles(colour: str) -> list[Figure]:
    radii = [2 * np.sin(np.radians(angle) / 2) for angle in _CIRCLES_DEG] + [2.0]
    line = {"color": colour, "width": 0.8, "dash": "dot"}
    return [
        {"type": "circle", "x0": -r, "x1": r, "y0": -r, "y1": r, "line": {**line, "dash": "solid"} if r == 2 else line}
        for r in map(float, radii)
    ]


def _names(colour: str) -> list[Figure]:
    words = {"showarrow": False, "font": {"size": 12, "color": colour}}
    ends = [("+x", 2.12, 0), ("−x", -2.12, 0), ("+y", 0, 2.12), ("−y", 0, -2.12)]
    tilts = [(f"{a}°", 0.0, float(2 * np.sin(np.radians(a) / 2))) for a in (30, 60, 90)]
    return [{**words, "text": text, "x": x, "y": y} for text, x, y in [*ends, *tilts]]
