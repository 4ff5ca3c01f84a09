"""The table viewpoint x characteristic as a map of probabilities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..palette import UNSEEN_COLOUR, probability_scale
from .style import COLOUR_BAR, Figure, axis, figure, plain, theme_of

__all__ = ["table_chart"]


def table_chart(
    viewpoints: Sequence[str],
    characteristics: Sequence[str],
    probability: NDArray[np.float64],
    reason: NDArray[np.str_],
    required: float,
    *,
    dark: bool = False,
) -> Figure:
    """Probabilities ``(n, d)``; grey where not seen, for the reason ``(n, d)`` that the pointer tells."""
    theme = theme_of(dark)
    seen = reason == ""
    rows = [[float(p) if s else None for p, s in zip(*row, strict=True)] for row in zip(probability, seen, strict=True)]
    reported = [
        [f"probability {p:.4f}" if not why else f"not seen: {why.replace('_', ' ')}" for p, why in zip(*r, strict=True)]
        for r in zip(probability, reason, strict=True)
    ]
    data = [
        {
            "type": "heatmap",
            "x": [plain(name) for name in characteristics],
            "y": [plain(name) for name in viewpoints],
            "z": rows,
            "text": reported,
            "zmin": 0,
            "zmax": 1,
            "colorscale": [list(stop) for stop in probability_scale(required)],
            "colorbar": COLOUR_BAR,
            "xgap": 1,
            "ygap": 1,
            "hovertemplate": "%{x} from %{y}<br>%{text}<extra></extra>",
        }
    ]
    return figure(
        data,
        theme,
        f"Probability at each viewpoint (blue: ≥ {required:g})",
        hovermode="closest",
        plot_bgcolor=UNSEEN_COLOUR,
        xaxis={**axis("characteristic", theme, type="category"), "showgrid": False},
        yaxis={**axis("viewpoint", theme, type="category", autorange="reversed"), "showgrid": False},
    )
