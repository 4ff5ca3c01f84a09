"""One chart as a page of its own."""

from __future__ import annotations

from ..charts import Figure
from ..templating import render_page

__all__ = ["render_chart"]


def render_chart(chart: Figure, title: str) -> str:
    """The chart as one HTML text that works offline, as large as the window."""
    paper = str(chart["layout"].get("paper_bgcolor", "#ffffff"))
    return render_page("chart.html", chart, title=title, paper=paper)
