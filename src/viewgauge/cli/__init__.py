"""The command ``viewgauge``: one file for each command or group of commands, and what they print."""

from .app import main

__all__ = ["main"]
