"""The workbench: a local web page on which a plan is looked at and turned."""

from .workbench import open_workbench

__all__ = ["open_workbench"]
