"""One chart as a page of its own."""

from __future__ import annotations

from html import escape
from string import Template

from ..charts import Figure
from .report_page import resource, script_data

__all__ = ["render_chart"]


def render_chart(chart: Figure, title: str) -> str:
    """The chart as one HTML text that works offline, as large as the window."""
    from plotly.offline import get_plotlyjs  # here: 5 MB that only a page needs

    paper = str(chart["layout"].get("paper_bgcolor", "#ffffff"))
    return Template(resource("chart.html")).substitute(
        title=escape(title), paper=paper, chart=script_data(chart), plotly=get_plotlyjs()
    )
