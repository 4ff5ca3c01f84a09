"""A plan as files: plan.json, settings.csv, assignments.csv."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ..evaluation import Requirement
from ..planning import Plan, PlannedDimension, Refinement
from .atomic import write_text_atomically
from .settings import write_settings

__all__ = ["plan_document", "write_plan_files"]


def plan_document(plan: Plan, requirement: Requirement, inputs: Mapping[str, str]) -> dict[str, Any]:
    """The plan as JSON-ready data (lengths mm; what is not defined is null)."""
    return {
        "version": version("viewgauge"),
        "seed": plan.seed,
        "inputs": dict(inputs),
        "requirement": asdict(requirement),
        "settings": [
            {"id": s.id, "T_part_camera": np.asarray(s.T_part_camera).tolist(), "observes": list(s.observes)}
            for s in plan.settings
        ],
        "dimensions": [_dimension_document(dimension) for dimension in plan.dimensions],
        "count": plan.count,
        "lower_bound": plan.lower_bound,
        "gap": plan.gap,
        "proven": plan.proven,
        "candidates": plan.candidate_count,
        "refinement": None if plan.refinement is None else _refinement_document(plan.refinement, plan.dimensions),
    }


def _refinement_document(refinement: Refinement, dimensions: Sequence[PlannedDimension]) -> dict[str, Any]:
    return {
        "steps": [asdict(step) for step in refinement.steps],
        "reached": [dimensions[j].id for j in refinement.reached],
        "generated": refinement.generated,
        "finished": refinement.finished,
    }


def _dimension_document(dimension: PlannedDimension) -> dict[str, Any]:
    is_length = dimension.kind != "angle"  # whose values are rad
    return {
        "id": dimension.id,
        "kind": dimension.kind,
        "nominal_mm": _number(dimension.nominal_mm) if is_length else None,
        "tolerance_mm": list(dimension.tolerance_mm) if dimension.tolerance_mm and is_length else None,
        "allowed_error_mm": _number(dimension.allowed_error_mm),
        "status": dimension.status,
        "probability": dimension.probability,
        "expected_accuracy": dimension.expected_accuracy,
        "setting": dimension.setting,
        "gauge": None if dimension.gauge is None else dimension.gauge.tolist(),
        "limit": dimension.limit,
        "warning": dimension.warning,
    }


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def write_plan_files(plan: Plan, requirement: Requirement, inputs: Mapping[str, str], folder: Path) -> None:
    """Write ``settings.csv``, ``assignments.csv`` and, last, ``plan.json`` into an existing folder."""
    poses = np.array([s.T_part_camera for s in plan.settings]).reshape(-1, 4, 4)  # also where there is none
    write_settings(folder / "settings.csv", [s.id for s in plan.settings], poses)
    write_text_atomically(folder / "assignments.csv", _assignments(plan))
    document = json.dumps(plan_document(plan, requirement, inputs), indent=2, ensure_ascii=False, allow_nan=False)
    write_text_atomically(folder / "plan.json", document + "\n")


def _assignments(plan: Plan) -> str:
    """One row for each dimension that is met: its setting, how sure, and the two points measured."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    points = [f"{end}_{axis}" for end in ("start", "end") for axis in "xyz"]
    writer.writerow(["dimension", "setting", "probability", "expected_accuracy", *points])
    for dimension in plan.dimensions:
        if dimension.setting is not None and dimension.gauge is not None:
            writer.writerow(
                [dimension.id, dimension.setting, repr(dimension.probability), repr(dimension.expected_accuracy)]
                + [repr(float(x)) for x in dimension.gauge.ravel()]
            )
    return text.getvalue()
