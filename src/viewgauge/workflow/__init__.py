"""The jobs a user asks for: load, check, evaluate, plan, write."""

from .check import check
from .evaluate import Method, best_of_each, evaluate, success_probability
from .inspection import ExplicitSettings, Inspection
from .load import load
from .plan import plan
from .progress import Progress, Silent
from .write import describe_plan, output_folder, require_table_suffix, write_evaluation, write_plan

__all__ = [
    "ExplicitSettings",
    "Inspection",
    "Method",
    "Progress",
    "Silent",
    "best_of_each",
    "check",
    "describe_plan",
    "evaluate",
    "load",
    "output_folder",
    "plan",
    "require_table_suffix",
    "success_probability",
    "write_evaluation",
    "write_plan",
]
