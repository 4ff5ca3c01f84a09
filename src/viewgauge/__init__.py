"""Plan camera poses that measure every toleranced dimension of a part accurately enough.

>>> import viewgauge as vg
>>> inspection = vg.load("inspection.yaml")  # doctest: +SKIP
>>> plan = vg.plan(inspection)  # doctest: +SKIP
>>> table = vg.evaluate(inspection, "settings.csv")  # doctest: +SKIP

Lengths are mm, angles rad, image positions px; ``T_a_b`` maps coordinates in b to coordinates in a.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import errors
    from .evaluation import Requirement
    from .exceptions import (
        InputError,
        InspectionFileError,
        NoCandidateError,
        PartFileError,
        SettingsFileError,
        ViewgaugeError,
    )
    from .geometry import Camera, EdgeLocator, Lens, PoseError
    from .planning import CandidateOptions, Plan
    from .workflow import (
        Evaluation,
        Inspection,
        check,
        error_budgets,
        evaluate,
        evaluate_into,
        gauge_laws,
        improve,
        load,
        measure,
        open_executor,
        plan,
        plan_chart,
        read_plan,
        simulate,
        specify,
        success_probability,
        validate,
        write_chart,
        write_evaluation,
        write_plan,
    )

_HOME = {
    "errors": "",
    **dict.fromkeys(("Camera", "EdgeLocator", "Lens", "PoseError"), "geometry"),
    "Requirement": "evaluation",
    **dict.fromkeys(("CandidateOptions", "Plan"), "planning"),
    **dict.fromkeys(
        (
            "InputError",
            "InspectionFileError",
            "NoCandidateError",
            "PartFileError",
            "SettingsFileError",
            "ViewgaugeError",
        ),
        "exceptions",
    ),
    **dict.fromkeys(
        (
            "Evaluation",
            "Inspection",
            "check",
            "error_budgets",
            "evaluate",
            "evaluate_into",
            "gauge_laws",
            "improve",
            "load",
            "measure",
            "open_executor",
            "plan",
            "plan_chart",
            "read_plan",
            "simulate",
            "specify",
            "success_probability",
            "validate",
            "write_chart",
            "write_evaluation",
            "write_plan",
        ),
        "workflow",
    ),
}

__all__ = [
    "Camera",
    "CandidateOptions",
    "EdgeLocator",
    "Evaluation",
    "InputError",
    "Inspection",
    "InspectionFileError",
    "Lens",
    "NoCandidateError",
    "PartFileError",
    "Plan",
    "PoseError",
    "Requirement",
    "SettingsFileError",
    "ViewgaugeError",
    "check",
    "error_budgets",
    "errors",
    "evaluate",
    "evaluate_into",
    "gauge_laws",
    "improve",
    "load",
    "measure",
    "open_executor",
    "plan",
    "plan_chart",
    "read_plan",
    "simulate",
    "specify",
    "success_probability",
    "validate",
    "write_chart",
    "write_evaluation",
    "write_plan",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used: starting is fast, and nothing unused is loaded."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = _HOME[name]
    value = import_module(f".{name}", __name__) if not home else getattr(import_module(f".{home}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
