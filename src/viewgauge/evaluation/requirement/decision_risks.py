"""Does a measured item conform, and how often is the answer wrong? JCGM 106:2012 for normal laws.

The true value of an item is Y, the measured one Y + E with E normal about 0, standard deviation u (the standard
uncertainty). An item conforms where Y lies in the tolerance zone; it is accepted where its measured value lies in the
acceptance zone. Two decisions are wrong:

- a nonconforming item is accepted: consumer's risk (false acceptance);
- a conforming item is rejected: producer's risk (false rejection).

*Specific* risks are those of one item with its measured value known (clause 7), *global* ones those of an item yet to
be measured (clause 9.5); for these the law of Y, here a normal one, describes the process that makes the items.

**Decision rules** (clause 8): the acceptance zone is the tolerance zone made smaller by a guard band ``w = r U`` at
either end, with U = 2 u the expanded uncertainty. Simple acceptance, also called shared risk: r = 0. Guarded
acceptance: r > 0; r = 1 was the default rule of ISO 14253-1 for proving conformity until its edition of 2017, whose
default of 95 % conformance probability is r = 0.82. Guarded rejection: r < 0, the acceptance zone is the larger one.

**Global risks in closed form.** With the process N(m, s), measured values are N(m, S), S² = s² + u², their
correlation with the true ones s/S. ``P(Y > t, Y + E <= a)`` is a quadrant of a bivariate normal law, which Owen's
function T gives. With h = -(t - m)/s and k = (a - m)/S it is, ::

    [Phi(h) + Phi(k)] / 2 - T(h, p/h) - T(k, q/k) - [1/2 where the signs of h and k differ]

    p = (a - t) / u            q = (s p - u (t - m)/s) / S

in which no difference of nearly equal numbers is left as u -> 0. Absolute error about 1e-15.

References: JCGM 106:2012 (also OIML G 1-106, ISO/IEC Guide 98-4); Owen, Ann. Math. Stat. 27 (1956) 1075.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, owens_t

__all__ = [
    "GlobalRisks",
    "Rule",
    "acceptance_limits",
    "conformance_probability",
    "global_risks",
    "guard_multiplier",
    "true_value_given",
]

_Array = NDArray[np.float64]

Rule = Literal["simple", "guarded", "guarded_rejection"]
"""Simple acceptance, guarded acceptance, guarded rejection (JCGM 106, clause 8)."""


class GlobalRisks(NamedTuple):
    """Of an item drawn from the process: that it is accepted and does not conform, rejected and conforms."""

    consumer: _Array
    producer: _Array


def guard_multiplier(rule: Rule, guard: float = 1.0) -> float:
    """r in the guard band ``w = r U``: 0, guard, or -guard."""
    return {"simple": 0.0, "guarded": guard, "guarded_rejection": -guard}[rule]


def acceptance_limits(
    lower: ArrayLike, upper: ArrayLike, expanded_uncertainty: ArrayLike, multiplier: ArrayLike
) -> tuple[_Array, _Array]:
    """Limits of the acceptance zone (clause 8): those of the tolerance zone, moved inwards by ``w = r U``.

    Where the lower one is not below the upper one nothing is accepted.

    Parameters
    ----------
    lower, upper
        Limits of the tolerance zone.
    expanded_uncertainty
        U, with a coverage factor of 2.
    multiplier
        r, see :func:`guard_multiplier`.
    """
    w = np.multiply(multiplier, expanded_uncertainty)
    return np.asarray(np.add(lower, w)), np.asarray(np.subtract(upper, w))


def conformance_probability(value: ArrayLike, uncertainty: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> _Array:
    """The probability p_c that an item conforms, its true value being normal (clause 7)::

        p_c = Phi((T_U - y)/u) - Phi((T_L - y)/u)

    1 - p_c is the specific consumer's risk if the item is accepted, p_c the specific producer's risk if it is rejected.

    Parameters
    ----------
    value, uncertainty
        y and u: of the true value, given all that is known. These are the measured value and its standard uncertainty
        where nothing else is known, or those of :func:`true_value_given`.
    lower, upper
        Limits of the tolerance zone; an infinite one for a one-sided tolerance.
    """
    u = np.asarray(uncertainty, dtype=float)
    above, below = _standard(np.subtract(value, lower), u), _standard(np.subtract(upper, value), u)
    # in the tail both are taken from the near side, where nothing cancels
    flip = above < below
    near, far = np.where(flip, above, below), np.where(flip, below, above)
    return np.asarray(np.maximum(ndtr(near) - ndtr(-far), 0.0))


def true_value_given(
    measured: ArrayLike, uncertainty: ArrayLike, mean: ArrayLike, standard_deviation: ArrayLike
) -> tuple[_Array, _Array]:
    """What is known of the true value after a measurement, the process being known: two normal laws by Bayes' rule.

    ::

        y = (m u² + y_m s²) / (s² + u²)          1 / u_y² = 1 / s² + 1 / u²

    Parameters
    ----------
    measured, uncertainty
        Measured value y_m and its standard uncertainty u.
    mean, standard_deviation
        m and s of the process.

    Returns
    -------
    Best estimate y and its standard uncertainty u_y.
    """
    m, s, u = (np.asarray(v, dtype=float) for v in (mean, standard_deviation, uncertainty))
    weight = s**2 / (s**2 + u**2)
    return np.asarray(m + weight * (measured - m)), np.asarray(u * np.sqrt(weight))


def global_risks(
    uncertainty: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    accept_lower: ArrayLike,
    accept_upper: ArrayLike,
    mean: ArrayLike,
    standard_deviation: ArrayLike,
) -> GlobalRisks:
    """Global consumer's and producer's risk, R_C and R_P (clause 9.5), of a normal process measured with normal errors.

    Parameters
    ----------
    uncertainty
        Standard uncertainty u of the measurement; 0 is a perfect one.
    lower, upper
        Limits of the tolerance zone, finite.
    accept_lower, accept_upper
        Limits of the acceptance zone (:func:`acceptance_limits`); where they are reversed nothing is accepted.
    mean, standard_deviation
        m and s > 0 of the process.
    """
    u, m, s = (np.asarray(v, dtype=float) for v in (uncertainty, mean, standard_deviation))
    t_low, t_up, a_low, a_up = (np.subtract(v, m) for v in (lower, upper, accept_lower, accept_upper))
    consumer = _quadrant(t_up, a_up, s, u) - _quadrant(t_up, a_low, s, u)  # over the zone; then under it, mirrored
    consumer = consumer + _quadrant(-t_low, -a_low, s, u) - _quadrant(-t_low, -a_up, s, u)
    producer = _quadrant(t_low, a_low, s, u) - _quadrant(t_up, a_low, s, u)  # rejected as too small, then too large
    producer = producer + _quadrant(-t_up, -a_up, s, u) - _quadrant(-t_low, -a_up, s, u)
    none = np.asarray(a_low >= a_up)
    consumer = np.where(none, 0.0, np.maximum(consumer, 0.0))
    producer = np.where(none, conformance_probability(0.0, s, t_low, t_up), np.maximum(producer, 0.0))
    return GlobalRisks(np.asarray(consumer), np.asarray(producer))


def _quadrant(t: ArrayLike, a: ArrayLike, s: ArrayLike, u: ArrayLike) -> _Array:
    """``P(Y > t, Y + E <= a)`` with Y ~ N(0, s), E ~ N(0, u); the closed form of the module's text."""
    t, a, s, u = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (t, a, s, u)))
    total = np.hypot(s, u)
    h, k = 0.0 - t / s, a / total + 0.0  # without negative zeros
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        step = (a - t) / u
        value = (ndtr(h) + ndtr(k)) / 2 - owens_t(h, step / h) - owens_t(k, (s * step - u * (t / s)) / (total * k))
    value = value - np.where((h < 0) != (k < 0), 0.5, 0.0)
    value = np.where((h == 0) & (k == 0), 0.25 - np.arctan2(s, u) / (2 * np.pi), value)
    return np.asarray(np.where(u == 0, np.where(a > t, conformance_probability(0.0, s, t, a), 0.0), value))


def _standard(difference: ArrayLike, u: _Array) -> _Array:
    """difference / u; where u is 0, infinite with the sign of the difference, a limit counting as inside."""
    with np.errstate(divide="ignore", invalid="ignore"):
        z = np.divide(difference, u)
    return np.asarray(np.where(np.isnan(z), np.inf, z))
