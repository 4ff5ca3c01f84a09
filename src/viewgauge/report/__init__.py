"""Showing a plan, and what to improve: self-contained HTML files that work offline."""

from .answers import render_improvement, render_specification
from .page import render_report

__all__ = ["render_improvement", "render_report", "render_specification"]
