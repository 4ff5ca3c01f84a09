"""A normal error plus any number of triangular ones, by the cosine series of its characteristic function.

The law of ``sigma Z + sum_r w_r T_r``, T_r triangular on [-1, 1], all independent, has the characteristic function ::

    c(t) = exp(-sigma² t² / 2) · prod_r (sin(w_r t / 2) / (w_r t / 2))²

On [-R, R], outside which the law has next to no mass, with ``t_n = n pi / R``::

    P(|error| <= x) = x / R + sum_n 2 c(t_n) sin(t_n x) / (n pi)
    pdf(x)          = 1 / (2 R) + sum_n c(t_n) cos(t_n x) / R
    E|error|        = R / 2 - sum_(n odd) 4 R c(t_n) / (n pi)²

What is neglected is bounded. *Mass outside R*: each triangular law is strictly sub-Gaussian (that of a uniform one,
``sinh(s)/s <= exp(s²/6)``, squared), so is the sum, and ``P(|error| > r) <= 2 exp(-r² / (2 var))``; R is 8.5 standard
deviations (4e-16), or the end of the support if that is nearer. *Terms left out*: beyond t_N ``|c(t)|`` is at most
``B(t) = exp(-sigma² t² / 2) prod_r min(1, 2 / (w_r t))²``, which falls at least like ``t^-q`` with q twice the number
of w_r t_N > 2, plus sigma² t_N²; so their sum is at most ``2 B(t_N) / (pi q)``, and terms are added until that is below
1e-11.

All functions take scalars and one list of half-widths, are compiled by numba, and share any unit. The series is that
of Fourier; for laws given by c see Fang and Oosterlee, *SIAM J. Sci. Comput.* 31 (2008) 826.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["CENTRAL", "DENSITY", "MEAN_ABSOLUTE", "cosine_series"]

CENTRAL, DENSITY, MEAN_ABSOLUTE = 0, 1, 2
"""What is summed: P(|error| <= x), the density at x, E|error|."""

_REACH = 8.5  # standard deviations
_LEFT_OUT = 1e-11
_MOST_TERMS = 2_000_000  # bounds the time; reached by no probability, and by a density only next to a kink

_Compiled = TypeVar("_Compiled", bound=Callable[..., object])


def _compiled(function: _Compiled) -> _Compiled:
    """Compile by numba, which ships no types of its own."""
    result: _Compiled = numba.njit(cache=True, error_model="numpy", nogil=True)(function)
    return result


@_compiled
def _half_period(sigma: float, widths: NDArray[np.float64]) -> float:
    variance, reach = sigma * sigma, 9.0 * sigma
    for w in widths:
        variance += w * w / 6.0
        reach += w
    return min(_REACH * math.sqrt(variance), reach)


@_compiled
def _sum(x: float, sigma: float, widths: NDArray[np.float64], what: int) -> float:
    R = _half_period(sigma, widths)
    if what == CENTRAL and x >= R:
        return 1.0
    if what == DENSITY and abs(x) >= R:
        return 0.0
    total = x / R if what == CENTRAL else 0.5
    for n in range(1, _MOST_TERMS):
        t = n * math.pi / R
        spread = sigma * sigma * t * t
        value = math.exp(-0.5 * spread)
        bound, order = value, spread
        for w in widths:
            half = 0.5 * w * t
            sinc = math.sin(half) / half
            value *= sinc * sinc
            if half > 1.0:
                bound /= half * half
                order += 2.0
        if what == CENTRAL:
            total += value * 2.0 * math.sin(t * x) / (n * math.pi)
        elif what == DENSITY:
            total += value * math.cos(t * x)
            bound, order = bound * n, order - 1.0  # terms are not divided by n
        elif n % 2 == 1:
            total -= value * 4.0 / (n * math.pi) ** 2
        if order > 0.0 and bound <= _LEFT_OUT * order:
            break
    return total if what == CENTRAL else total / R if what == DENSITY else total * R


@_compiled
def _sums(
    x: NDArray[np.float64],
    sigma: NDArray[np.float64],
    widths: NDArray[np.float64],
    what: int,
    out: NDArray[np.float64],
) -> None:
    for k in range(len(x)):
        out[k] = _sum(x[k], sigma[k], widths[k, : np.count_nonzero(widths[k])], what)


def cosine_series(
    x: NDArray[np.float64], sigma: NDArray[np.float64], widths: NDArray[np.float64], what: int
) -> NDArray[np.float64]:
    """The sum for each of n laws.

    Parameters
    ----------
    x, sigma
        ``(n,)``; x not negative for :data:`CENTRAL`, without meaning for :data:`MEAN_ABSOLUTE`.
    widths
        ``(n, r)`` half-widths, in descending order, zeros last; at least two are positive.
    what
        :data:`CENTRAL`, :data:`DENSITY` or :data:`MEAN_ABSOLUTE`.
    """
    out = np.empty(len(x))
    _sums(np.ascontiguousarray(x), np.ascontiguousarray(sigma), np.ascontiguousarray(widths), what, out)
    return out
