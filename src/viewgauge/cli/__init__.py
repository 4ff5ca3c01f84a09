"""The command ``viewgauge``: plan, evaluate, check."""

from .app import main

__all__ = ["main"]
