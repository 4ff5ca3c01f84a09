"""Probability of reaching an accuracy, against the accuracy (paper, eq. 20 and Fig. 8 d)."""

from __future__ import annotations

import numpy as np

from ...evaluation import MeasurandLaws
from ..wording import length, probability
from .laws_chart import CURVES
from .style import Figure, axis, figure, marked, plain, theme_of

__all__ = ["accuracy_chart"]

_POINTS = 121


def accuracy_chart(
    name: str, laws: MeasurandLaws, allowed_error_mm: float, required: float, *, dark: bool = False
) -> Figure:
    """Pr{accuracy >= 1 - T} of a characteristic by both models, with what is required.

    Parameters
    ----------
    required
        Probability (Th).
    """
    theme = theme_of(dark)
    reach = max(2.5 * allowed_error_mm, 3.5 * laws.standard_uncertainty_mm)
    error = np.linspace(0, reach, _POINTS)
    accuracy = 100 * (1 - error / laws.length_mm)
    models = [("total", "both ends share the pose error", laws.probability(error))]
    independent = laws.independent_probability(error)
    if independent is not None:
        models.append(("independent", "ends taken as independent (1998)", independent))
    data = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": words,
            "x0": 100.0,
            "dx": float(accuracy[1] - accuracy[0]),
            "y": [float(f"{value:.5g}") for value in values],
            "line": {"color": CURVES[law][1], "width": 3 if law == "total" else 1.8, "dash": CURVES[law][2]},
            "hovertemplate": "%{y:.4f}<extra></extra>",
        }
        for law, words, values in models
    ]
    reached = float(laws.probability(allowed_error_mm))
    demanded = 100 * (1 - allowed_error_mm / laws.length_mm)
    met = reached >= required
    data.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": f"{'✓' if met else '✗'} here {probability(reached)}",
            "x": [demanded],
            "y": [reached],
            "marker": {
                "size": 12,
                "symbol": "circle" if met else "diamond",
                "color": theme.good if met else theme.bad,
                "line": {"color": theme.paper, "width": 1.5},
            },
            "hovertemplate": f"{probability(reached)}<extra></extra>",
        }
    )
    lines = [
        marked(theme, f"required {required:g}", y=required),
        marked(theme, f"within ±{length(1000 * allowed_error_mm)} µm", x=demanded),
    ]
    return figure(
        data,
        theme,
        f"Probability of each accuracy of {plain(name)}",
        xaxis=axis("accuracy at least / %", theme, range=[float(accuracy.min()), 100]),
        yaxis=axis("probability", theme, range=[0, 1.04]),
        shapes=[shape for shape, _ in lines],
        annotations=[words for _, words in lines],
    )
