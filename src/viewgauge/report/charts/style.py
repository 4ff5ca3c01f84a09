"""What all charts share: type, spacing, axes, legends, and how a required value is marked."""

from __future__ import annotations

from typing import Any

from ..palette import DARK, LIGHT, Theme

__all__ = ["COLOUR_BAR", "FONT", "Figure", "axis", "figure", "marked", "plain", "theme_of", "washed"]

Figure = dict[str, Any]
"""``data`` and ``layout`` of a Plotly figure, JSON-ready."""

FONT = "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', sans-serif"
_SIZE = 13
COLOUR_BAR = {
    "title": {"text": "probability", "font": {"size": 12}},
    "tickfont": {"size": 11},
    "thickness": 12,
    "outlinewidth": 0,
}
"""The colour bar of a chart of probabilities."""


def theme_of(dark: bool) -> Theme:
    """The paper and inks of light or dark surroundings."""
    return DARK if dark else LIGHT


def plain(text: str) -> str:
    """Text from a file, without the angle brackets in which Plotly reads markup."""
    return text.replace("<", "‹").replace(">", "›")


def washed(colour: str, opacity: float) -> str:
    """A hexadecimal colour that lets what is behind it through."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity:g})"


def axis(title: str, theme: Theme, **more: Any) -> dict[str, Any]:
    """A quiet axis with its title and unit."""
    return {
        "title": {"text": title, "font": {"size": _SIZE, "color": theme.soft}, "standoff": 8},
        "gridcolor": theme.line,
        "linecolor": theme.line,
        "zeroline": False,
        "tickfont": {"size": 12, "color": theme.soft},
        "automargin": True,
        **more,
    }


def figure(data: list[dict[str, Any]], theme: Theme, title: str, **layout: Any) -> Figure:
    """A chart with its heading; ``layout`` is added to what all share."""
    return {
        "data": data,
        "layout": {
            "title": {"text": title, "font": {"size": 14, "color": theme.ink}, "x": 0.01, "xanchor": "left"},
            "font": {"family": FONT, "size": _SIZE, "color": theme.ink},
            "paper_bgcolor": theme.paper,
            "plot_bgcolor": theme.paper,
            "margin": {"l": 58, "r": 16, "t": 40, "b": 48},
            "legend": {"orientation": "h", "x": 0, "y": -0.17, "yanchor": "top", "font": {"size": 12}},
            "hoverlabel": {"align": "left", "font": {"family": FONT}},
            "hovermode": "x",
            **layout,
        },
    }


def marked(theme: Theme, text: str, *, x: float | None = None, y: float | None = None) -> tuple[Figure, Figure]:
    """A dashed line at a value of x or y over the whole chart, and its words: a shape and an annotation."""
    line = {"color": theme.soft, "width": 1.2, "dash": "dash"}
    words = {"text": text, "showarrow": False, "font": {"size": 12, "color": theme.soft}}
    if x is not None:
        shape = {"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1, "line": line}
        return shape, {**words, "x": x, "yref": "paper", "y": 1, "xanchor": "left", "yanchor": "top", "xshift": 4}
    shape = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": y, "y1": y, "line": line}
    return shape, {**words, "xref": "paper", "x": 0, "y": y, "xanchor": "left", "yanchor": "top", "xshift": 4}
