"""What the search for gauges finds for one feature, and whether it agrees with the callout."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan

from ..brep import Callout
from ..characteristic import Gauge

__all__ = ["Measured", "Outcome", "Unmeasured", "agrees", "closest", "disagreement"]

_RELATIVE_LIMIT = 0.01  # without a tolerance, the file's value may be rounded by this much
_RELATIVE_FLOOR = 1e-6  # digits of the nominal value in inch files


@dataclass(frozen=True)
class Measured:
    """Gauges of one feature, all of length ``value_mm``: the dimension's value in the geometry."""

    value_mm: float
    gauges: tuple[Gauge, ...]


@dataclass(frozen=True)
class Unmeasured:
    """One feature that offers no gauge, and why."""

    reason: str


Outcome = Measured | Unmeasured


def agrees(value_mm: float, callout: Callout) -> bool:
    """Whether the geometry's value is the callout's nominal within its tolerance (1 % where it has none).

    A callout without a nominal value agrees with any.
    """
    if isnan(callout.nominal_mm):
        return True
    nominal = abs(callout.nominal_mm)
    if callout.tolerance_mm is None:
        limit = _RELATIVE_LIMIT * nominal
    else:
        limit = max(max(abs(deviation) for deviation in callout.tolerance_mm), _RELATIVE_FLOOR * nominal)
    return abs(value_mm - nominal) <= limit * (1 + 1e-9)


def closest(values_mm: list[float], callout: Callout) -> float:
    """The value nearest to the callout's nominal (the first where it has none)."""
    if isnan(callout.nominal_mm):
        return values_mm[0]
    return min(values_mm, key=lambda value: abs(value - abs(callout.nominal_mm)))


def disagreement(value_mm: float, callout: Callout) -> str:
    """The reason that names both values, mm."""
    return f"the nominal value {callout.nominal_mm:.6g} mm disagrees with the geometry, {value_mm:.6g} mm"
