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

    What the file does not hold is lost: angles of dimensions that cannot be measured, and how many cells of the region
    a bound looked into.

    Raises
    ------
    InputError
        If there is none, or it is not a plan.
    """
    return read_whole_plan(Path(folder))


def require_plan_of(plan: Plan, inspection: Inspection) -> None:
    """Raise InputError unless a plan is of an inspection's part and dimensions."""
    known = {dimension.id: dimension for dimension in inspection.part.dimensions}
    for planned in plan.dimensions:
        gauges = [planned.gauge] if planned.gauge is not None and not planned.looks else []
        gauges += [look.gauge for look in planned.looks]
        for gauge in gauges:
            dimension = known.get(planned.id)
            if dimension is None or dimension.gauge_at(gauge) is None:
                raise InputError(
                    "the plan is of another part, or of other dimensions",
                    key=planned.id,
                    expected="a plan of this inspection",
                    hint="plan it again with viewgauge plan",
                )
