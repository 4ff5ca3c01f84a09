"""A plan that was written, read back."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from ..exceptions import InputError
from ..findings import Finding, admit
from ..formats.plan.plan_reader import read_whole_plan
from ..part import Characteristic
from ..planning import Plan, PlannedCharacteristic
from ..planning.inspection import Inspection

__all__ = ["read_plan", "require_plan_of"]

_AGAIN = "plan it again with viewgauge plan"


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
    """Raise InputError unless a plan is of an inspection: of its files, part, characteristics and tolerances."""
    admit(_other_inputs(plan, inspection), inspection.accepted)
    known = {characteristic.id: characteristic for characteristic in inspection.part.characteristics}
    for place, planned in enumerate(plan.characteristics):
        measurands = [planned.measurand] if planned.measurand is not None and not planned.acquisitions else []
        measurands += [acquisition.measurand for acquisition in planned.acquisitions]
        for measurand in measurands:
            characteristic = known.get(planned.id)
            if characteristic is None or characteristic.measurand_at(measurand) is None:
                raise InputError(
                    "the plan is of another part, or of other characteristics",
                    key=planned.id,
                    expected="a plan of this inspection",
                    hint=_AGAIN,
                )
            _require_same_values(planned, characteristic, f"characteristics[{place}]")


def _other_inputs(plan: Plan, inspection: Inspection) -> list[Finding]:
    """Which files a plan was made from and an inspection is not; what has no files is not compared."""
    if not plan.inputs or not inspection.inputs or {*plan.inputs.values()} == {*inspection.inputs.values()}:
        return []
    changed = [
        f"{name} (SHA-256 {digest[:12]}, in the plan {plan.inputs[name][:12]})"
        for name, digest in inspection.inputs.items()
        if name in plan.inputs and plan.inputs[name] != digest
    ]
    known = {*plan.inputs.values()}
    added = [n for n, digest in inspection.inputs.items() if n not in plan.inputs and digest not in known]
    known = {*inspection.inputs.values()}
    missing = [n for n, digest in plan.inputs.items() if n not in inspection.inputs and digest not in known]
    differ = [f"changed: {', '.join(changed)}"] if changed else []
    differ += [f"not of the plan: {', '.join(added)}"] if added else []
    differ += [f"of the plan alone: {', '.join(missing)}"] if missing else []
    return [
        Finding(
            "plan_inputs",
            f"the plan was made from other files; {'; '.join(differ)}",
            "the files that the plan was made from",
            f"the plan is of another inspection, or a file was changed since; {_AGAIN}",
            "plan.json: inputs",
            refused=True,
        )
    ]


def _require_same_values(planned: PlannedCharacteristic, characteristic: Characteristic, key: str) -> None:
    """Raise InputError where nominal value and tolerance are not those of the inspection."""
    pairs = (
        ("nominal_mm", planned.nominal_mm, characteristic.nominal_mm),
        ("tolerance_mm", planned.tolerance_mm, characteristic.tolerance_mm),
    )
    for name, of_plan, of_inspection in pairs:
        same = (of_plan is None) == (of_inspection is None)
        if same and of_plan is not None and of_inspection is not None:
            same = bool(np.allclose(of_plan, of_inspection, rtol=1e-9, atol=1e-9, equal_nan=True))
        if not same:
            raise InputError(
                f"the plan's value of {planned.id} is not the inspection's",
                key=f"{key}.{name}",
                got=of_plan,
                expected=str(of_inspection),
                hint=_AGAIN,
            )
