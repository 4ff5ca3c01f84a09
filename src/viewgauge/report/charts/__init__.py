"""Charts as plain Plotly figures (``data`` and ``layout``), the same in the report, the workbench and notebooks."""

from .accuracy_chart import accuracy_chart
from .budget_chart import budget_chart
from .directions_chart import directions_chart
from .laws_chart import laws_chart
from .style import Figure
from .table_chart import table_chart

__all__ = ["Figure", "accuracy_chart", "budget_chart", "directions_chart", "laws_chart", "table_chart"]
