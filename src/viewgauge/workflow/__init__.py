"""The jobs a user asks for: load, check, evaluate, plan, write."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..io.table_store import require_table_suffix
    from ..simulation.sensor import Sensor
    from .budget import error_budgets, figures_of_gauges
    from .camera import describe_calibration, read_calibration, write_opencv_camera
    from .characterize import (
        Characterization,
        characterize,
        describe_characterization,
        write_calibration,
        write_head,
    )
    from .check import check
    from .evaluate import Evaluation, Method, evaluate, evaluate_into, success_probability
    from .execution import open_executor
    from .improve import improve
    from .inspection import ExplicitSettings, Inspection
    from .load import load
    from .measure import Measured, measure
    from .plan import plan
    from .progress import Progress, Silent
    from .simulate import simulate
    from .specify import specify
    from .validate import Validation, describe_validation, validate, write_validation
    from .write import (
        describe_answers,
        describe_plan,
        output_folder,
        require_answer_suffix,
        write_answers,
        write_evaluation,
        write_plan,
    )

_HOME = {
    **dict.fromkeys(("error_budgets", "figures_of_gauges"), ".budget"),
    **dict.fromkeys(("describe_calibration", "read_calibration", "write_opencv_camera"), ".camera"),
    **dict.fromkeys(
        ("Characterization", "characterize", "describe_characterization", "write_calibration", "write_head"),
        ".characterize",
    ),
    "check": ".check",
    **dict.fromkeys(("Evaluation", "Method", "evaluate", "evaluate_into", "success_probability"), ".evaluate"),
    **dict.fromkeys(("ExplicitSettings", "Inspection"), ".inspection"),
    "improve": ".improve",
    "load": ".load",
    **dict.fromkeys(("Measured", "measure"), ".measure"),
    "open_executor": ".execution",
    "plan": ".plan",
    "simulate": ".simulate",
    "specify": ".specify",
    **dict.fromkeys(("Progress", "Silent"), ".progress"),
    **dict.fromkeys(("Validation", "describe_validation", "validate", "write_validation"), ".validate"),
    **dict.fromkeys(
        (
            "describe_answers",
            "describe_plan",
            "output_folder",
            "require_answer_suffix",
            "write_answers",
            "write_evaluation",
            "write_plan",
        ),
        ".write",
    ),
    "require_table_suffix": "..io.table_store",
    "Sensor": "..simulation.sensor",
}

__all__ = [
    "Characterization",
    "Evaluation",
    "ExplicitSettings",
    "Inspection",
    "Measured",
    "Method",
    "Progress",
    "Sensor",
    "Silent",
    "Validation",
    "characterize",
    "check",
    "describe_answers",
    "describe_calibration",
    "describe_characterization",
    "describe_plan",
    "describe_validation",
    "error_budgets",
    "evaluate",
    "evaluate_into",
    "figures_of_gauges",
    "improve",
    "load",
    "measure",
    "open_executor",
    "output_folder",
    "plan",
    "read_calibration",
    "require_answer_suffix",
    "require_table_suffix",
    "simulate",
    "specify",
    "success_probability",
    "validate",
    "write_answers",
    "write_calibration",
    "write_evaluation",
    "write_head",
    "write_opencv_camera",
    "write_plan",
    "write_validation",
]


def __getattr__(name: str) -> object:
    """Import a job when it is first asked for: one that reads a part does not wait for another's libraries."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


class _Package(ModuleType):
    """This package, in which ``load`` is the function also after the module of that name has been imported."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
