"""Charts as plain Plotly figures (``data`` and ``layout``), the same in the report, the workbench and notebooks."""

from .accuracy import accuracy_chart
from .budget import budget_chart
from .directions import directions_chart
from .laws import laws_chart
from .style import Figure
from .table import table_chart

__all__ = ["Figure", "accuracy_chart", "budget_chart", "directions_chart", "laws_chart", "table_chart"]
