"""A plan's file read back: the whole plan, or which characteristics are measured from which viewpoints, by which
points.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...planning import Acquisition, Plan, PlannedCharacteristic, PlannedViewpoint, Refinement, RefinementStep
from ...planning.bounds import Certificate, ViewpointsBound
from ..files.text import read_text
from .indication_document import read_indication
from .plan_schema import require_plan

__all__ = ["PlannedMeasurement", "read_plan", "read_whole_plan"]

_Read = TypeVar("_Read")


@dataclass(frozen=True)
class PlannedMeasurement:
    """One characteristic from one viewpoint.

    Parameters
    ----------
    T_part_camera
        ``(4, 4)`` mm: of the viewpoint.
    measurand
        ``(2, 3)`` mm, part frame.
    uncertainty_mm
        Standard uncertainty that the plan predicts of one measurement; None where it states none.
    acquisitions
        From how many viewpoints the characteristic is measured and averaged.
    """

    characteristic: str
    viewpoint: str
    T_part_camera: NDArray[np.float64]
    measurand: NDArray[np.float64]
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    uncertainty_mm: float | None
    acquisitions: int


def read_plan(folder: Path) -> tuple[PlannedMeasurement, ...]:
    """The measurements that ``plan.json`` in a folder, or a file of that content, plans.

    Raises
    ------
    InputError
        If the file is missing, or not a plan.
    """
    return _read(folder, _measurements)


def _read(folder: Path, take: Callable[[dict[str, Any]], _Read]) -> _Read:
    path = folder / "plan.json" if os.path.isdir(folder) else folder
    try:
        return take(require_plan(json.loads(read_text(path, InputError)), path))
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON: {error.msg}", file=path, line=error.lineno) from error
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            "not a plan", file=path, got=repr(error)[:200], expected="plan.json of viewgauge plan"
        ) from error


def _measurements(document: dict[str, Any]) -> tuple[PlannedMeasurement, ...]:
    poses = {s["id"]: np.array(s["T_part_camera"], dtype=float).reshape(4, 4) for s in document["viewpoints"]}
    entries = [d for d in document["characteristics"] if d["status"] == "met"]
    return tuple(found for entry in entries for found in _of(entry, poses))


def _of(entry: dict[str, Any], poses: dict[str, NDArray[np.float64]]) -> list[PlannedMeasurement]:
    acquisitions = entry.get("acquisitions") or [{"viewpoint": entry["viewpoint"], "measurand": entry["measurand"]}]
    budget = entry.get("budget")
    tolerance = entry["tolerance_mm"]
    return [
        PlannedMeasurement(
            characteristic=entry["id"],
            viewpoint=acquisition["viewpoint"],
            T_part_camera=poses[acquisition["viewpoint"]],
            measurand=np.array(acquisition["measurand"], dtype=float).reshape(2, 3),
            nominal_mm=float(entry["nominal_mm"]),
            tolerance_mm=None if tolerance is None else (float(tolerance[0]), float(tolerance[1])),
            uncertainty_mm=None if budget is None else float(budget["combined_uncertainty_mm"]),
            acquisitions=len(acquisitions),
        )
        for acquisition in acquisitions
    ]


def read_whole_plan(folder: Path) -> Plan:
    """The plan that ``plan.json`` in a folder, or a file of that content, holds.

    What a characteristic's angle was in rad is not in the file, and is not a number here.

    Raises
    ------
    InputError
        If the file is missing, or not a plan.
    """
    return _read(folder, _plan)


def _plan(document: dict[str, Any]) -> Plan:
    names = [entry["id"] for entry in document["characteristics"]]
    refinement = document["refinement"]
    if refinement is not None:
        steps = tuple(RefinementStep(**step) for step in refinement["steps"])
        reached = tuple(names.index(name) for name in refinement["reached"])
        refinement = Refinement(steps, reached, refinement["generated"], refinement["finished"])
    anywhere = document["anywhere"]
    return Plan(
        seed=int(document["seed"]),
        viewpoints=tuple(
            PlannedViewpoint(s["id"], np.array(s["T_part_camera"], dtype=float).reshape(4, 4), tuple(s["observes"]))
            for s in document["viewpoints"]
        ),
        characteristics=tuple(_characteristic(entry) for entry in document["characteristics"]),
        lower_bound=int(document["lower_bound"]),
        candidate_count=int(document["candidates"]),
        refinement=refinement,
        # how many cells were looked into is not in the file
        anywhere=None if anywhere is None else ViewpointsBound(anywhere["lower_bound"], tuple(anywhere["apart"]), 0),
        interrupted=bool(document["interrupted"]),
        without_tolerance=tuple(_characteristic(entry) for entry in document["without_tolerance"]),
        inputs=dict(document.get("inputs", {})),
    )


def _characteristic(entry: dict[str, Any]) -> PlannedCharacteristic:
    def number(name: str) -> float:
        return float("nan") if entry[name] is None else float(entry[name])

    def array(name: str, shape: tuple[int, int]) -> NDArray[np.float64] | None:
        return None if entry[name] is None else np.array(entry[name], dtype=float).reshape(shape)

    tolerance, certificate = entry["tolerance_mm"], entry["certificate"]
    return PlannedCharacteristic(
        id=entry["id"],
        kind=entry["kind"],
        nominal_mm=number("nominal_mm"),
        tolerance_mm=None if tolerance is None else (float(tolerance[0]), float(tolerance[1])),
        allowed_error_mm=number("allowed_error_mm"),
        status=entry["status"],
        probability=float(entry["probability"]),
        expected_accuracy=float(entry["expected_accuracy"]),
        viewpoint=entry["viewpoint"],
        measurand=array("measurand", (2, 3)),
        limit=entry["limit"],
        warning=entry["warning"],
        T_part_camera=array("T_part_camera", (4, 4)),
        acquisitions=tuple(
            Acquisition(acquisition["viewpoint"], np.array(acquisition["measurand"], dtype=float).reshape(2, 3))
            for acquisition in entry["acquisitions"]
        ),
        single_probability=entry["single_probability"],
        certificate=None if certificate is None else Certificate(entry["id"], **certificate),
        proof=entry["proof"],
        indication=read_indication(entry),
    )
