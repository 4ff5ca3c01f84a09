"""What causes the uncertainty of characteristics, as stacked bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...evaluation.error_budget import ErrorBudget
from ..budget_parts import shares_of, shown_parts
from ..palette import OTHER_SOURCE_COLOUR, SOURCE_COLOURS
from .style import Figure, axis, figure, plain, theme_of

__all__ = ["budget_chart"]


def budget_chart(budgets: Mapping[str, ErrorBudget], order: Sequence[str] = (), *, dark: bool = False) -> Figure:
    """Shares of the variance, one bar for each characteristic; negative ones offset others.

    Parameters
    ----------
    order
        Ids, from the top; by default as the budgets come.
    """
    theme = theme_of(dark)
    names = [name for name in order or budgets if name in budgets]
    shares = {name: shares_of(budgets[name]) for name in names}
    data: list[dict[str, Any]] = [
        {
            "type": "bar",
            "orientation": "h",
            "name": words,
            "y": [plain(name) for name in names],
            "x": [round(100 * shares[name].get(part, 0.0), 4) for name in names],
            "marker": {
                "color": SOURCE_COLOURS.get(part, OTHER_SOURCE_COLOUR),
                "line": {"color": theme.paper, "width": 1},
            },
            "hovertemplate": "%{x:.1f} %<extra>" + words + "</extra>",
        }
        for part, words in shown_parts(budgets.values()).items()
    ]
    title = f"Sources of the uncertainty of {plain(names[0])}" if len(names) == 1 else "Error budget"
    return figure(
        data,
        theme,
        title,
        barmode="relative",
        hovermode="closest",
        height=150 + 24 * len(names),
        legend={"orientation": "h", "x": 0, "y": 0, "yref": "container", "yanchor": "bottom", "font": {"size": 12}},
        margin={"l": 58, "r": 16, "t": 40, "b": 92},
        xaxis=axis("share of the variance / %", theme, zeroline=True, zerolinecolor=theme.soft),
        yaxis={**axis("", theme, autorange="reversed", type="category"), "showgrid": False},
    )
