"""A plan as files: plan.json, viewpoints.csv, assignments.csv."""

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

from ...evaluation import CapabilityFigures, Requirement
from ...evaluation.error_budget import ErrorBudget
from ...findings import Finding
from ...planning import Acquisition, Plan, PlannedCharacteristic, Refinement
from ...planning.bounds import Certificate, ViewpointsBound
from ..files.atomic import write_text_atomically
from ..files.spreadsheet_text import to_cell
from ..poses.viewpoints_file import write_viewpoints
from .indication_document import indication_document
from .plan_schema import checksum

__all__ = ["plan_document", "write_plan_files"]


def plan_document(
    plan: Plan,
    requirement: Requirement,
    inputs: Mapping[str, str],
    budgets: Mapping[str, ErrorBudget],
    figures: Mapping[str, CapabilityFigures],
    findings: Sequence[Finding] = (),
) -> dict[str, Any]:
    """The plan as JSON-ready data (lengths mm; what is not defined is null)."""
    characteristics = [
        {
            **_characteristic_document(characteristic),
            "budget": _budget_document(budgets[characteristic.id]) if characteristic.id in budgets else None,
            "figures": asdict(figures[characteristic.id]) if characteristic.id in figures else None,
        }
        for characteristic in plan.characteristics
    ]
    document = {
        "version": version("viewgauge"),
        "seed": plan.seed,
        "inputs": dict(inputs),
        "findings": [finding.document() for finding in findings],
        "requirement": asdict(requirement),
        "viewpoints": [
            {"id": s.id, "T_part_camera": np.asarray(s.T_part_camera).tolist(), "observes": list(s.observes)}
            for s in plan.viewpoints
        ],
        "characteristics": characteristics,
        "without_tolerance": [_characteristic_document(entry) for entry in plan.without_tolerance],
        "count": plan.count,
        "lower_bound": plan.lower_bound,
        "gap": plan.gap,
        "proven": plan.proven,
        "anywhere": None if plan.anywhere is None else _bound_document(plan.anywhere, plan.proven_anywhere),
        "interrupted": plan.interrupted,
        "candidates": plan.candidate_count,
        "refinement": None if plan.refinement is None else _refinement_document(plan.refinement, plan.characteristics),
    }
    return {**document, "checksum": checksum(document)}


def _refinement_document(refinement: Refinement, characteristics: Sequence[PlannedCharacteristic]) -> dict[str, Any]:
    return {
        "steps": [asdict(step) for step in refinement.steps],
        "reached": [characteristics[j].id for j in refinement.reached],
        "generated": refinement.generated,
        "finished": refinement.finished,
    }


def _bound_document(bound: ViewpointsBound, proven: bool) -> dict[str, Any]:
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
            for k, name in enumerate(component.name for component in budget.components)
        },
        "groups": {
            name: {
                "share": float(budget.group_share[name]),
                "probability_without": float(budget.group_probability_without[name]),
            }
            for name in budget.groups
        },
    }


def _characteristic_document(characteristic: PlannedCharacteristic) -> dict[str, Any]:
    is_length = characteristic.kind != "angle"  # whose values are rad
    return {
        "id": characteristic.id,
        "kind": characteristic.kind,
        "nominal_mm": _number(characteristic.nominal_mm) if is_length else None,
        "tolerance_mm": list(characteristic.tolerance_mm) if characteristic.tolerance_mm and is_length else None,
        **indication_document(
            characteristic.kind, characteristic.nominal_mm, characteristic.tolerance_mm, characteristic.indication
        ),
        "allowed_error_mm": _number(characteristic.allowed_error_mm),
        "status": characteristic.status,
        "probability": characteristic.probability,
        "expected_accuracy": characteristic.expected_accuracy,
        "viewpoint": characteristic.viewpoint,
        "measurand": None if characteristic.measurand is None else characteristic.measurand.tolist(),
        "limit": characteristic.limit,
        "proof": characteristic.proof,
        "warning": characteristic.warning,
        "T_part_camera": None if characteristic.T_part_camera is None else characteristic.T_part_camera.tolist(),
        "acquisitions": [
            {"viewpoint": acquisition.viewpoint, "measurand": acquisition.measurand.tolist()}
            for acquisition in characteristic.acquisitions
        ],
        "single_probability": characteristic.single_probability,
        "certificate": None
        if characteristic.certificate is None
        else _certificate_document(characteristic.certificate),
    }


def _certificate_document(certificate: Certificate) -> dict[str, Any]:
    return {"upper_bound": certificate.upper_bound, "proven": certificate.proven, "cause": certificate.cause}


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def write_plan_files(plan: Plan, document: Mapping[str, Any], folder: Path) -> None:
    """Write ``viewpoints.csv``, ``assignments.csv`` and, last, ``plan.json`` into an existing folder.

    Parameters
    ----------
    document
        The content of plan.json (:func:`plan_document`).
    """
    poses = np.array([s.T_part_camera for s in plan.viewpoints]).reshape(-1, 4, 4)  # also where there is none
    write_viewpoints(folder / "viewpoints.csv", [s.id for s in plan.viewpoints], poses)
    write_text_atomically(folder / "assignments.csv", _assignments(plan))
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    write_text_atomically(folder / "plan.json", text + "\n")


def _assignments(plan: Plan) -> str:
    """The CSV of assignments: for each characteristic that is met one row an acquisition, with its viewpoint, the
    probability, and the two points measured.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    points = [f"{end}_{axis}" for end in ("start", "end") for axis in "xyz"]
    writer.writerow(["characteristic", "viewpoint", "probability", "expected_accuracy", *points])
    for characteristic in plan.characteristics:
        if characteristic.viewpoint is not None and characteristic.measurand is not None:
            for acquisition in characteristic.acquisitions or (
                Acquisition(characteristic.viewpoint, characteristic.measurand),
            ):
                writer.writerow(
                    [
                        to_cell(characteristic.id),
                        to_cell(acquisition.viewpoint),
                        repr(characteristic.probability),
                        repr(characteristic.expected_accuracy),
                    ]
                    + [repr(float(x)) for x in acquisition.measurand.ravel()]
                )
    return text.getvalue()
