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

from ...evaluation import GaugeFigures, Requirement
from ...evaluation.error_budget import GROUPS, SOURCES, ErrorBudget
from ...planning import Look, Plan, PlannedDimension, Refinement
from ...planning.bounds import Certificate, SettingsBound
from ..files.atomic import write_text_atomically
from ..poses.viewpoints_file import write_settings

__all__ = ["plan_document", "write_plan_files"]


def plan_document(
    plan: Plan,
    requirement: Requirement,
    inputs: Mapping[str, str],
    budgets: Mapping[str, ErrorBudget],
    figures: Mapping[str, GaugeFigures],
) -> dict[str, Any]:
    """The plan as JSON-ready data (lengths mm; what is not defined is null)."""
    dimensions = [
        {
            **_dimension_document(dimension),
            "budget": _budget_document(budgets[dimension.id]) if dimension.id in budgets else None,
            "figures": asdict(figures[dimension.id]) if dimension.id in figures else None,
        }
        for dimension in plan.dimensions
    ]
    return {
        "version": version("viewgauge"),
        "seed": plan.seed,
        "inputs": dict(inputs),
        "requirement": asdict(requirement),
        "settings": [
            {"id": s.id, "T_part_camera": np.asarray(s.T_part_camera).tolist(), "observes": list(s.observes)}
            for s in plan.settings
        ],
        "dimensions": dimensions,
        "count": plan.count,
        "lower_bound": plan.lower_bound,
        "gap": plan.gap,
        "proven": plan.proven,
        "anywhere": None if plan.anywhere is None else _bound_document(plan.anywhere, plan.proven_anywhere),
        "interrupted": plan.interrupted,
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


def _bound_document(bound: SettingsBound, proven: bool) -> dict[str, Any]:
    return {"lower_bound": bound.count, "proven": proven, "apart": list(bound.apart)}


def _budget_document(budget: ErrorBudget) -> dict[str, Any]:
    """For each source and group its share of the variance, and the probability without it."""
    return {
        "combined_uncertainty_mm": float(budget.combined_uncertainty_mm),
        "probability": float(budget.probability),
        "sources": {
            name: {
                "sensitivity": float(budget.sensitivity[k]),
                "standard_uncertainty": float(budget.standard_uncertainty[k]),
                "own_share": float(budget.own_share[k]),
                "correlation_share": float(budget.correlation_share[k]),
                "probability_without": float(budget.probability_without[k]),
            }
            for k, name in enumerate(SOURCES)
        },
        "groups": {
            name: {
                "share": float(budget.group_share[name]),
                "probability_without": float(budget.group_probability_without[name]),
            }
            for name in GROUPS
        },
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
        "proof": dimension.proof,
        "warning": dimension.warning,
        "T_part_camera": None if dimension.T_part_camera is None else dimension.T_part_camera.tolist(),
        "looks": [{"setting": look.setting, "gauge": look.gauge.tolist()} for look in dimension.looks],
        "single_probability": dimension.single_probability,
        "certificate": None if dimension.certificate is None else _certificate_document(dimension.certificate),
    }


def _certificate_document(certificate: Certificate) -> dict[str, Any]:
    return {"upper_bound": certificate.upper_bound, "proven": certificate.proven, "cause": certificate.cause}


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def write_plan_files(plan: Plan, document: Mapping[str, Any], folder: Path) -> None:
    """Write ``settings.csv``, ``assignments.csv`` and, last, ``plan.json`` into an existing folder.

    Parameters
    ----------
    document
        Of the plan (:func:`plan_document`).
    """
    poses = np.array([s.T_part_camera for s in plan.settings]).reshape(-1, 4, 4)  # also where there is none
    write_settings(folder / "settings.csv", [s.id for s in plan.settings], poses)
    write_text_atomically(folder / "assignments.csv", _assignments(plan))
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    write_text_atomically(folder / "plan.json", text + "\n")


def _assignments(plan: Plan) -> str:
    """Of each dimension that is met one row for each look: its setting, how sure, and the two points measured."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    points = [f"{end}_{axis}" for end in ("start", "end") for axis in "xyz"]
    writer.writerow(["dimension", "setting", "probability", "expected_accuracy", *points])
    for dimension in plan.dimensions:
        if dimension.setting is not None and dimension.gauge is not None:
            for look in dimension.looks or (Look(dimension.setting, dimension.gauge),):
                writer.writerow(
                    [dimension.id, look.setting, repr(dimension.probability), repr(dimension.expected_accuracy)]
                    + [repr(float(x)) for x in look.gauge.ravel()]
                )
    return text.getvalue()
