"""The largest uncertainty of measurement at which the global risks are still within limits.

The target measurement uncertainty (VIM, 2.34) of conformity assessment: JCGM 106:2012, clause 9.5, solved for u.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .decision_risks import acceptance_limits, global_risks

__all__ = ["largest_uncertainty"]

# u over half the width of the zone: where the first crossing is looked for, a hundred places a decade, and how often
# what lies between two places is divided again into a hundred
_LOWEST, _HIGHEST, _PLACES = 1e-9, 1e3, 1201
_ROUNDS, _PARTS = 6, 100


@lru_cache(maxsize=4096)
def largest_uncertainty(
    half_width: float,
    offset: float,
    standard_deviation: float,
    multiplier: float,
    consumer_risk: float | None,
    producer_risk: float | None,
) -> float:
    """The largest u such that at it and at every smaller one the global risks are within their limits.

    The guard band grows with u (``w = r U``, U = 2 u). A perfect measurement (u = 0) has no risks, so u is positive.
    The consumer's risk need not grow with u: with a very uncertain measurement little is accepted at all, and
    so little that does not conform. Only what lies below the first crossing counts.

    Parameters
    ----------
    half_width
        Of the tolerance zone, positive.
    offset
        Of the process's mean from the middle of the zone.
    standard_deviation
        Of the process, positive.
    multiplier
        r of the guard band (:func:`~viewgauge.evaluation.requirement.decision_risks.guard_multiplier`).
    consumer_risk, producer_risk
        Limits, positive; None where there is none.

    Returns
    -------
    u in the unit of the lengths; infinite where the risks stay within their limits whatever the uncertainty.
    """
    limits = consumer_risk, producer_risk
    process = offset / half_width, standard_deviation / half_width

    places = np.concatenate([[0.0], np.geomspace(_LOWEST, _HIGHEST, _PLACES)])
    exceeded = _exceeded(places, process, multiplier, limits)
    if not exceeded.any():
        return float("inf")
    for _ in range(_ROUNDS):
        first = max(int(np.argmax(exceeded)), 1)
        places = np.linspace(places[first - 1], places[first], _PARTS + 1)
        exceeded = _exceeded(places, process, multiplier, limits)
        exceeded[-1] = True  # as it was found before, whatever rounding says now
    return float(places[max(int(np.argmax(exceeded)), 1) - 1] * half_width)


def _exceeded(
    u: NDArray[np.float64],
    process: tuple[float, float],
    multiplier: float,
    limits: tuple[float | None, float | None],
) -> NDArray[np.bool_]:
    """Where a risk is over its limit, the tolerance zone being [-1, 1]."""
    accept = acceptance_limits(-1.0, 1.0, 2 * u, multiplier)
    risks = global_risks(u, -1.0, 1.0, *accept, *process)
    over = [risk > limit for risk, limit in zip(risks, limits, strict=True) if limit is not None]
    return np.asarray(np.any(over, axis=0))
