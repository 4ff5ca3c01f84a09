"""What the search for measurands finds for one feature, and whether it agrees with the PMI record."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan

from ..brep import PmiRecord
from ..indication import Measurability
from ..measurands import PointPair

__all__ = ["NO_REFERENCE", "Derived", "NotDerived", "Outcome", "agrees", "closest", "disagreement"]

_RELATIVE_LIMIT = 0.01  # without a tolerance, the file's value may be rounded by this much
_RELATIVE_FLOOR = 1e-6  # digits of the nominal value in inch files


@dataclass(frozen=True)
class Derived:
    """One feature with its measurands, all of length ``value_mm``: the characteristic's value in the geometry."""

    value_mm: float
    measurands: tuple[PointPair, ...]


@dataclass(frozen=True)
class NotDerived:
    """One feature that offers no measurand, and why."""

    reason: str
    status: Measurability = Measurability.NOT_MEASURABLE


Outcome = Derived | NotDerived

NO_REFERENCE = NotDerived("the PMI record refers to no face or edge")


def agrees(value_mm: float, pmi_record: PmiRecord) -> bool:
    """Whether the geometry's value is the PMI record's nominal within its tolerance (1 % where it has none).

    A PMI record without a nominal value agrees with any.
    """
    if isnan(pmi_record.nominal_mm):
        return True
    nominal = abs(pmi_record.nominal_mm)
    if pmi_record.tolerance_mm is None:
        limit = _RELATIVE_LIMIT * nominal
    else:
        limit = max(max(abs(deviation) for deviation in pmi_record.tolerance_mm), _RELATIVE_FLOOR * nominal)
    return abs(value_mm - nominal) <= limit * (1 + 1e-9)


def closest(values_mm: list[float], pmi_record: PmiRecord) -> float:
    """The value nearest to the PMI record's nominal (the first where it has none)."""
    if isnan(pmi_record.nominal_mm):
        return values_mm[0]
    return min(values_mm, key=lambda value: abs(value - abs(pmi_record.nominal_mm)))


def disagreement(value_mm: float, pmi_record: PmiRecord) -> str:
    """The reason that names both values, mm."""
    return f"the nominal value {pmi_record.nominal_mm:.6g} mm disagrees with the geometry, {value_mm:.6g} mm"
