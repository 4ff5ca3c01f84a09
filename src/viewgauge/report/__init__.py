"""Showing a plan, and what to improve: self-contained HTML files that work offline, and charts."""

from .answers import render_improvement, render_specification
from .chart_page import render_chart
from .details import PlanDetails
from .page import render_report
from .view_picture import SeenDimension, SettingView, view_picture

__all__ = [
    "PlanDetails",
    "SeenDimension",
    "SettingView",
    "render_chart",
    "render_improvement",
    "render_report",
    "render_specification",
    "view_picture",
]
