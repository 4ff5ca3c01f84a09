"""The workbench: a local web page that shows a plan and what changes would do."""

from .workbench import open_workbench

__all__ = ["open_workbench"]
