"""The jobs a user asks for: load, check, evaluate, plan, write."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..geometry import pose_from_quaternion, quaternion_from_pose
    from ..io.table_store import require_table_suffix
    from ..planning import Plan
    from ..planning.answers import Answers
    from ..planning.direction_map import DirectionMap
    from ..planning.turned import KnobValues
    from ..report.bench import (
        answer_table,
        bench_style,
        dimension_facts,
        legend,
        message,
        refused_table,
        verdict_markup,
    )
    from ..report.charts import accuracy_chart, budget_chart, directions_chart, laws_chart, table_chart
    from ..report.palette import DARK, LIGHT, UNMET_COLOUR, UNSEEN_COLOUR, colours_of, probability_colour
    from ..report.simplify import picture_mesh
    from ..report.view_picture import unseen_table, view_picture
    from ..simulation.sensor import Sensor
    from .bench_jobs import load_uploaded, plan_again
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
    from .export import plan_archive, settings_text
    from .improve import improve
    from .inspection import ExplicitSettings, Inspection
    from .job import Job, Stage
    from .laws import gauge_laws
    from .load import load
    from .measure import Measured, measure
    from .plan import plan
    from .plot import plan_chart, write_chart
    from .progress import Progress, Silent
    from .read_plan import read_plan, require_plan_of
    from .report import plan_report
    from .save import turned_inspection_text
    from .simulate import simulate
    from .specify import specify
    from .validate import Validation, describe_validation, validate, write_validation
    from .what_if import WhatIf
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
    "Plan": "..planning",
    **dict.fromkeys(("Answers",), "..planning.answers"),
    **dict.fromkeys(("DirectionMap",), "..planning.direction_map"),
    **dict.fromkeys(("KnobValues",), "..planning.turned"),
    **dict.fromkeys(
        ("accuracy_chart", "budget_chart", "directions_chart", "laws_chart", "table_chart"), "..report.charts"
    ),
    **dict.fromkeys(
        ("answer_table", "bench_style", "dimension_facts", "legend", "message", "refused_table", "verdict_markup"),
        "..report.bench",
    ),
    **dict.fromkeys(
        ("DARK", "LIGHT", "UNMET_COLOUR", "UNSEEN_COLOUR", "colours_of", "probability_colour"), "..report.palette"
    ),
    **dict.fromkeys(("picture_mesh",), "..report.simplify"),
    **dict.fromkeys(("unseen_table", "view_picture"), "..report.view_picture"),
    **dict.fromkeys(("pose_from_quaternion", "quaternion_from_pose"), "..geometry"),
    **dict.fromkeys(("load_uploaded", "plan_again"), ".bench_jobs"),
    **dict.fromkeys(("Job", "Stage"), ".job"),
    **dict.fromkeys(("plan_archive", "settings_text"), ".export"),
    **dict.fromkeys(("read_plan", "require_plan_of"), ".read_plan"),
    **dict.fromkeys(("plan_report",), ".report"),
    **dict.fromkeys(("turned_inspection_text",), ".save"),
    **dict.fromkeys(("WhatIf",), ".what_if"),
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
    **dict.fromkeys(("plan_chart", "write_chart"), ".plot"),
    "gauge_laws": ".laws",
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
    "DARK",
    "LIGHT",
    "UNMET_COLOUR",
    "UNSEEN_COLOUR",
    "Answers",
    "Characterization",
    "DirectionMap",
    "Evaluation",
    "ExplicitSettings",
    "Inspection",
    "Job",
    "KnobValues",
    "Measured",
    "Method",
    "Plan",
    "Progress",
    "Sensor",
    "Silent",
    "Stage",
    "Validation",
    "WhatIf",
    "accuracy_chart",
    "answer_table",
    "bench_style",
    "budget_chart",
    "characterize",
    "check",
    "colours_of",
    "describe_answers",
    "describe_calibration",
    "describe_characterization",
    "describe_plan",
    "describe_validation",
    "dimension_facts",
    "directions_chart",
    "error_budgets",
    "evaluate",
    "evaluate_into",
    "figures_of_gauges",
    "gauge_laws",
    "improve",
    "laws_chart",
    "legend",
    "load",
    "load_uploaded",
    "measure",
    "message",
    "open_executor",
    "output_folder",
    "picture_mesh",
    "plan",
    "plan_again",
    "plan_archive",
    "plan_chart",
    "plan_report",
    "pose_from_quaternion",
    "probability_colour",
    "quaternion_from_pose",
    "read_calibration",
    "read_plan",
    "refused_table",
    "require_answer_suffix",
    "require_plan_of",
    "require_table_suffix",
    "settings_text",
    "simulate",
    "specify",
    "success_probability",
    "table_chart",
    "turned_inspection_text",
    "unseen_table",
    "validate",
    "verdict_markup",
    "view_picture",
    "write_answers",
    "write_calibration",
    "write_chart",
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
