"""A plan that was written, read back."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from ..exceptions import InputError
from ..formats.plan.plan_reader import read_whole_plan
from ..planning import Plan
from ..planning.inspection import Inspection

__all__ = ["read_plan", "require_plan_of"]


def read_plan(folder: str | PathLike[str]) -> Plan:
    """The plan that :func:`~viewgauge.write_plan` wrote into a folder, or into a ``plan.json``.

    What the file does not hold is lost: angles of characteristics that cannot be measured, and how many cells of the
    region a bound looked into.

    Raises
    ------
    InputError
        If there is none, or it is not a plan.
    """
    return read_whole_plan(Path(folder))


def require_plan_of(plan: Plan, inspection: Inspection) -> None:
    """Raise InputError unless a plan is of an inspection's part and characteristics."""
    known = {characteristic.id: characteristic for characteristic in inspection.part.characteristics}
    for planned in plan.characteristics:
        measurands = [planned.measurand] if planned.measurand is not None and not planned.acquisitions else []
        measurands += [acquisition.measurand for acquisition in planned.acquisitions]
        for measurand in measurands:
            characteristic = known.get(planned.id)
            if characteristic is None or characteristic.measurand_at(measurand) is None:
                raise InputError(
                    "the plan is of another part, or of other characteristics",
                    key=planned.id,
                    expected="a plan of this inspection",
                    hint="plan it again with viewgauge plan",
                )
