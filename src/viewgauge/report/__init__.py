"""Showing a plan: one self-contained HTML file that works offline."""

from .page import render_report

__all__ = ["render_report"]
