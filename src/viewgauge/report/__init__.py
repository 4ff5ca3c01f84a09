"""Showing a plan, and what to improve: self-contained HTML files that work offline, and charts."""

from .page.answer_pages import render_improvement, render_specification
from .page.chart_page import render_chart
from .page.details import PlanDetails
from .page.report_page import render_report
from .pictures.view_picture import SeenCharacteristic, ViewpointView, view_picture

__all__ = [
    "PlanDetails",
    "SeenCharacteristic",
    "ViewpointView",
    "render_chart",
    "render_improvement",
    "render_report",
    "render_specification",
    "view_picture",
]
