"""How capable a measurand is of judging a tolerance zone: %P/T, Cg and Cgk, and the spread that each of them allows.

With T = upper - lower, the width of the tolerance zone, and k the number of standard deviations that stands for the
spread of the measurements (6; formerly 5.15)::

    P/T = k sigma / T                                      precision to tolerance (AIAG, MSA, 4th edition)
    Cg  = share T / (k sigma)                              share = 0.2
    Cgk = (share T / 2 - |bias|) / (k sigma / 2)

Cg and Cgk are those of a type 1 measurand study as Minitab defines them, and as the motor industry's guidelines do
(Bosch, booklet 10: share 0.2, k = 6, at least 1.33; others take a share of 0.15, or k = 4).

k sigma is the width of the interval that holds 2 Phi(k/2) - 1 of a normal law, 99.73 % for k = 6. For a law that is
not normal the interval that holds that share takes its place, as ISO 22514 does for capability: then each
condition "at least as capable as this" is one on the probability of a small error, ::

    P(|error| <= a) >= 2 Phi(k/2) - 1,     a = value T / 2,     share T / (2 Cg),     (share T / 2 - |bias|) / Cgk

All functions take scalars and arrays and broadcast; lengths in one unit.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

__all__ = [
    "SHARE",
    "SIGMAS",
    "cg",
    "cgk",
    "coverage",
    "percent_p_to_t",
    "spread_for_cg",
    "spread_for_cgk",
    "spread_for_percent_p_to_t",
]

SIGMAS = 6.0
"""Standard deviations that stand for the spread of the measurements."""

SHARE = 0.2
"""Share of the tolerance zone that Cg compares the spread with."""


def coverage(sigmas: float = SIGMAS) -> float:
    """The share of a normal law that lies within ``sigmas`` standard deviations: 0.9973 of 6, 0.98998 of 5.15."""
    return float(1 - 2 * ndtr(-sigmas / 2))


def percent_p_to_t(
    sigma: ArrayLike, lower: ArrayLike, upper: ArrayLike, sigmas: ArrayLike = SIGMAS
) -> NDArray[np.float64]:
    """Precision to tolerance, per cent: ``100 k sigma / T``; the smaller the better (often: 10 good, 30 the limit).

    Parameters
    ----------
    sigma
        Standard deviation of the measurement error.
    lower, upper
        Limits of the tolerance zone.
    sigmas
        k: 6, or 5.15 as in older editions.
    """
    return np.asarray(100 * _ratio(np.multiply(sigmas, sigma), _width(lower, upper)))


def cg(
    sigma: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, share: ArrayLike = SHARE, sigmas: ArrayLike = SIGMAS
) -> NDArray[np.float64]:
    """Capability of the measurement without its bias: ``share T / (k sigma)``; the larger the better (often 1.33).

    Parameters
    ----------
    sigma, lower, upper, sigmas
        As in :func:`percent_p_to_t`.
    share
        Of the tolerance zone.
    """
    return _ratio(np.multiply(share, _width(lower, upper)), np.multiply(sigmas, sigma))


def cgk(
    sigma: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    bias: ArrayLike = 0.0,
    share: ArrayLike = SHARE,
    sigmas: ArrayLike = SIGMAS,
) -> NDArray[np.float64]:
    """Capability of the measurement with its bias: ``(share T / 2 - |bias|) / (k sigma / 2)``; Cg where there is none.

    Parameters
    ----------
    sigma, lower, upper, share, sigmas
        As in :func:`cg`.
    bias
        Systematic error of the measurement.
    """
    margin = np.multiply(share, _width(lower, upper)) / 2 - np.abs(bias)
    return _ratio(margin, np.multiply(sigmas, sigma) / 2)


def spread_for_percent_p_to_t(percent: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> NDArray[np.float64]:
    """Half the width of the spread, ``k sigma / 2``, at which P/T is as many per cent."""
    return np.asarray(np.multiply(percent, _width(lower, upper)) / 200)


def spread_for_cg(
    value: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, share: ArrayLike = SHARE
) -> NDArray[np.float64]:
    """Half the width of the spread, ``k sigma / 2``, at which Cg has this value."""
    return spread_for_cgk(value, lower, upper, share=share)


def spread_for_cgk(
    value: ArrayLike, lower: ArrayLike, upper: ArrayLike, *, bias: ArrayLike = 0.0, share: ArrayLike = SHARE
) -> NDArray[np.float64]:
    """Half the width of the spread, ``k sigma / 2``, at which Cgk has this value.

    Not positive where the bias uses up the share of the zone.
    """
    return np.asarray((np.multiply(share, _width(lower, upper)) / 2 - np.abs(bias)) / np.asarray(value, dtype=float))


def _width(lower: ArrayLike, upper: ArrayLike) -> NDArray[np.float64]:
    return np.asarray(np.subtract(upper, lower), dtype=float)


def _ratio(numerator: ArrayLike, denominator: ArrayLike) -> NDArray[np.float64]:
    """Infinite, with its sign, over nothing; NaN for nothing over nothing."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.divide(numerator, denominator))
