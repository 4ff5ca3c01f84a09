"""Densities of what the error of one characteristic is made of (paper, Fig. 8 a-c)."""

from __future__ import annotations

import numpy as np

from ...evaluation import MeasurandLaws
from ..wording import length
from .style import Figure, axis, figure, plain, theme_of, washed

__all__ = ["laws_chart"]

_POINTS = 161
CURVES = {
    "camera": ("pixels", "#E69F00", "dash"),
    "displacement": ("camera pose", "#009E73", "dashdot"),
    "total": ("together", "#2184C7", "solid"),
    "independent": ("together, ends taken as independent (1998)", "#CC79A7", "dot"),
}
"""Words, colour and stroke of each law."""


def laws_chart(name: str, laws: MeasurandLaws, allowed_error_mm: float, *, dark: bool = False) -> Figure:
    """The laws of a characteristic, with the errors that are allowed as a band.

    Parameters
    ----------
    name
        The characteristic's name.
    allowed_error_mm
        The largest allowed error.
    """
    theme = theme_of(dark)
    spread = max(laws.standard_uncertainty_mm, 1e-9)
    reach = min(max(4 * spread, 1.3 * allowed_error_mm), 12 * spread)
    x = np.linspace(-reach, reach, _POINTS)
    curves = {"total": laws.total.pdf(x)}
    for part in ("camera", "displacement"):
        law = getattr(laws, part)
        if float(law.std()) > 0:  # an error that is always nought has no density
            curves[part] = law.pdf(x)
    independent = laws.independent_density(x)
    if independent is not None:
        curves["independent"] = independent
    highest = 1.08 * float(np.max(curves["total"]))
    data = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": CURVES[part][0],
            "x0": -1000 * reach,
            "dx": 2000 * reach / (_POINTS - 1),
            "y": [float(f"{value:.4g}") for value in np.minimum(curves[part], 4 * highest) / 1000],
            "line": {"color": CURVES[part][1], "width": 3 if part == "total" else 1.8, "dash": CURVES[part][2]},
            "hovertemplate": "%{y:.3g} per µm<extra>" + CURVES[part][0] + "</extra>",
        }
        for part in CURVES
        if part in curves
    ]
    band = {
        "type": "rect",
        "x0": -1000 * allowed_error_mm,
        "x1": 1000 * allowed_error_mm,
        "yref": "paper",
        "y0": 0,
        "y1": 1,
        "fillcolor": washed(theme.good, 0.1),
        "line": {"width": 0},
        "layer": "below",
    }
    allowed = f"allowed ±{length(1000 * allowed_error_mm)} µm"
    words = {
        "text": allowed,
        "x": 0.99,
        "xref": "paper",
        "xanchor": "right",
        "y": 1,
        "yref": "paper",
        "yanchor": "top",
        "showarrow": False,
        "font": {"size": 12, "color": theme.good},
    }
    return figure(
        data,
        theme,
        f"Error of {plain(name)}: what it is made of",
        xaxis=axis("measured − true length / µm", theme, range=[-1000 * reach, 1000 * reach]),
        yaxis=axis("density / µm⁻¹", theme, range=[0, highest / 1000], rangemode="tozero"),
        shapes=[band],
        annotations=[words],
    )
