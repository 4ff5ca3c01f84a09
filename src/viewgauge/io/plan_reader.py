"""A plan's file read back: which dimensions are measured from which settings, by which points."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from .text import read_text

__all__ = ["PlannedMeasurement", "read_plan"]


@dataclass(frozen=True)
class PlannedMeasurement:
    """One dimension from one setting.

    Parameters
    ----------
    T_part_camera
        ``(4, 4)`` mm: of the setting.
    gauge
        ``(2, 3)`` mm, part frame.
    uncertainty_mm
        Standard uncertainty that the plan predicts of one measurement; None where it states none.
    looks
        From how many settings the dimension is measured and averaged.
    """

    dimension: str
    setting: str
    T_part_camera: NDArray[np.float64]
    gauge: NDArray[np.float64]
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    uncertainty_mm: float | None
    looks: int


def read_plan(folder: Path) -> tuple[PlannedMeasurement, ...]:
    """What ``plan.json`` in a folder, or a file of that content, plans to measure.

    Raises
    ------
    InputError
        If the file is missing, or not a plan.
    """
    path = folder / "plan.json" if folder.is_dir() else folder
    try:
        document = json.loads(read_text(path, InputError))
        poses = {s["id"]: np.array(s["T_part_camera"], dtype=float).reshape(4, 4) for s in document["settings"]}
        entries = [d for d in document["dimensions"] if d["status"] == "met"]
        return tuple(found for entry in entries for found in _of(entry, poses))
    except json.JSONDecodeError as error:
        raise InputError(f"not JSON: {error.msg}", file=path, line=error.lineno) from error
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("not a plan", file=path, got=repr(error), expected="plan.json of viewgauge plan") from error


def _of(entry: dict[str, Any], poses: dict[str, NDArray[np.float64]]) -> list[PlannedMeasurement]:
    looks = entry.get("looks") or [{"setting": entry["setting"], "gauge": entry["gauge"]}]
    budget = entry.get("budget")
    tolerance = entry["tolerance_mm"]
    return [
        PlannedMeasurement(
            dimension=entry["id"],
            setting=look["setting"],
            T_part_camera=poses[look["setting"]],
            gauge=np.array(look["gauge"], dtype=float).reshape(2, 3),
            nominal_mm=float(entry["nominal_mm"]),
            tolerance_mm=None if tolerance is None else (float(tolerance[0]), float(tolerance[1])),
            uncertainty_mm=None if budget is None else float(budget["combined_uncertainty_mm"]),
            looks=len(looks),
        )
        for look in looks
    ]
