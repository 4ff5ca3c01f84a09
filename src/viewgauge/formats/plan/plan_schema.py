"""What ``plan.json`` must hold: models that a plan's document is checked against before anything of it is used.

Further keys are allowed: a plan may hold more than is read of it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StrictBool, StrictInt, StrictStr, ValidationError

from ...exceptions import InputError
from ...geometry import require_poses
from ...planning import Status
from ..files.problems import dotted
from ..files.text import unusable_character

__all__ = ["PlanDocument", "checksum", "require_plan"]

_MOST = 1e9


def _rigid(rows: list[list[float]]) -> list[list[float]]:
    require_poses(np.array(rows), "pose")
    return rows


def _deviations_in_order(limits: list[float]) -> list[float]:
    if not limits[0] < limits[1]:
        raise InputError("the lower deviation must be less than the upper", got=limits)
    return limits


def _usable(text: str) -> str:
    wrong = unusable_character(text)
    if wrong is not None:
        raise InputError(f"the text holds {wrong}", got=ascii(text))
    return text


Number = Annotated[float, Field(strict=True, ge=-_MOST, le=_MOST, allow_inf_nan=False)]
Share = Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)]
Name = Annotated[StrictStr, Field(min_length=1), AfterValidator(_usable)]
Row = Annotated[list[Number], Field(min_length=4, max_length=4)]
Pose = Annotated[list[Row], Field(min_length=4, max_length=4), AfterValidator(_rigid)]
Point = Annotated[list[Number], Field(min_length=3, max_length=3)]
PointPair = Annotated[list[Point], Field(min_length=2, max_length=2)]
Deviations = Annotated[list[Number], Field(min_length=2, max_length=2), AfterValidator(_deviations_in_order)]
Count = Annotated[StrictInt, Field(ge=0, le=10**12)]


class _Document(BaseModel):
    model_config = ConfigDict(extra="allow", frozen=True, protected_namespaces=())


class _Viewpoint(_Document):
    id: Name
    T_part_camera: Pose
    observes: list[Name]


class _Acquisition(_Document):
    viewpoint: Name
    measurand: PointPair


class _Certificate(_Document):
    model_config = ConfigDict(extra="forbid")

    upper_bound: Share
    proven: StrictBool
    cause: StrictStr | None


class _Budget(_Document):
    combined_uncertainty_mm: Annotated[Number, Field(ge=0)]


class _Characteristic(_Document):
    id: Name
    kind: Name
    nominal_mm: Number | None
    tolerance_mm: Deviations | None
    allowed_error_mm: Number | None
    status: Status
    probability: Share
    expected_accuracy: Number
    viewpoint: Name | None
    measurand: PointPair | None
    limit: StrictStr
    proof: StrictStr
    warning: StrictStr
    T_part_camera: Pose | None
    acquisitions: list[_Acquisition]
    single_probability: Share | None
    certificate: _Certificate | None
    budget: _Budget | None = None


class _Step(_Document):
    model_config = ConfigDict(extra="forbid")

    name: StrictStr
    count: Count
    met: Count
    weakest: Share


class _Refinement(_Document):
    steps: Annotated[list[_Step], Field(min_length=1)]
    reached: list[Name]
    generated: Count
    finished: StrictBool


class _Anywhere(_Document):
    lower_bound: Count
    apart: list[Any]


class PlanDocument(_Document):
    """The whole of ``plan.json``."""

    seed: Count
    inputs: dict[str, StrictStr] = {}
    viewpoints: list[_Viewpoint]
    characteristics: list[_Characteristic]
    lower_bound: Count
    candidates: Count
    interrupted: StrictBool
    anywhere: _Anywhere | None
    refinement: _Refinement | None


def require_plan(document: Any, path: Path) -> dict[str, Any]:
    """The document itself; raises InputError, with the key, where it is no plan or was changed after it was written."""
    if not isinstance(document, dict):
        raise InputError("not a plan", file=path, got=type(document).__name__, expected="plan.json of viewgauge plan")
    try:
        plan = PlanDocument.model_validate(document)
    except ValidationError as error:
        raise _first(error, path) from error
    known = [viewpoint.id for viewpoint in plan.viewpoints]
    if len(set(known)) < len(known):
        raise InputError("an id is used twice", file=path, key="viewpoints", got=", ".join(known))
    for place, characteristic in enumerate(plan.characteristics):
        named = [characteristic.viewpoint, *(acquisition.viewpoint for acquisition in characteristic.acquisitions)]
        unknown = [name for name in named if name is not None and name not in known]
        if unknown or (characteristic.status == Status.MET and characteristic.viewpoint is None):
            raise InputError(
                "not a viewpoint of the plan",
                file=path,
                key=f"characteristics[{place}].viewpoint",
                got=", ".join(unknown) or "none",
                expected=", ".join(known) or "no viewpoint: the plan has none",
            )
        if characteristic.status == Status.MET and characteristic.measurand is None:
            raise InputError(
                "what is measured is missing", file=path, key=f"characteristics[{place}].measurand", got="nothing"
            )
    stated = document.get("checksum")
    if stated is not None and stated != checksum(document):
        raise InputError(
            "the plan was changed after it was written",
            file=path,
            key="checksum",
            hint="plan again with viewgauge plan: what a plan says was computed together",
        )
    return document


def checksum(document: Mapping[str, Any]) -> str:
    """SHA-256 of a plan's document without its checksum."""
    rest = {name: value for name, value in document.items() if name != "checksum"}
    text = json.dumps(rest, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _first(error: ValidationError, path: Path) -> InputError:
    """The first of what is wrong, in the words of house style."""
    details = error.errors(include_url=False)
    detail = details[0]
    cause = detail.get("ctx", {}).get("error")
    problem = cause.problem if isinstance(cause, InputError) else f"not a plan: {detail['msg'].lower()}"
    got = None if detail["type"] == "missing" else _short(detail["input"])
    return InputError(
        problem,
        file=path,
        key=dotted(tuple(step for step in detail["loc"] if not str(step).startswith("function-"))),
        got=got,
        expected="plan.json as viewgauge plan wrote it",
        hint="plan again with viewgauge plan" + (f"; {len(details) - 1} more are wrong" if details[1:] else ""),
    )


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:60]}... ({len(text)} characters)"
