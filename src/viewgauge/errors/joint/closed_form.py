"""Closed form of a normal error plus two triangular quantization errors, right in every limit.

The total error is ``sigma Z + a (U1 + U2 - 1) + b (U3 + U4 - 1)``: Z standard normal, U uniform on (0, 1), all
independent (paper, eq. 2, 3, 18, 19; theory sections 4 and 6). Adding a triangular variable of half-width h to
a smooth law with cdf G acts as the operator ::

    S_h = (exp(hD) - 2 + exp(-hD)) / (hD)²  =  sum_k  2 h^(2k) / (2k+2)!  D^(2k)

so that the cdf is ``S_a S_b Phi(x/sigma)`` and the pdf its derivative. Two exact forms of S_h:

- the *difference*: second central difference of the twice integrated law, divided by h². It cancels when h is
  small against the scale on which the law varies.
- the *series* in h²: converges fast exactly there.

With a >= b the difference over a never cancels unless a < sigma/2, and below x <= 0 its arguments stay below a;
there the series is used. The same choice is made for b. The repeated integrals and derivatives of the normal
law, ``G_m = sigma^m I^m Phi(y/sigma)``, obey one recurrence, ``m G_m = y G_(m-1) + sigma² G_(m-2)``.

All functions take scalars, are compiled by numba, and know nothing of images: a, b, sigma and x share any unit.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["central_probability", "mean_absolute", "total_cdf", "total_pdf"]

# S_h by the series below this ratio of h to sigma: the first neglected term is then under 1e-15.
_SERIES_RATIO = 0.5
_SERIES_TERMS = 11
# Beyond this many sigma a normal law is 0 or 1 to double precision.
_NORMAL_REACH = 9.0
# A part below this share of the widest one changes nothing, and its square would underflow.
_NEGLIGIBLE = 1e-100

_S_COEFFICIENTS = np.array([2.0 / math.factorial(2 * k + 2) for k in range(_SERIES_TERMS)])

_Scalar = TypeVar("_Scalar", bound=Callable[..., float])


def _scalar(function: _Scalar) -> _Scalar:
    """Compile by numba, which ships no types of its own."""
    compiled: _Scalar = numba.njit(cache=True, error_model="numpy")(function)
    return compiled


@_scalar
def _integrated_normal(y: float, sigma: float, order: int) -> float:
    """``G_order(y)`` for order -1 (the pdf), 0 (the cdf), 1, 2, … (its repeated integrals)."""
    if sigma > 0.0 and abs(y) < _NORMAL_REACH * sigma:
        z = y / sigma
        before = math.exp(-0.5 * z * z) / (sigma * math.sqrt(2.0 * math.pi))
        current = 0.5 * math.erfc(-z / math.sqrt(2.0))
    else:
        before = 0.0
        current = 1.0 if y >= 0.0 else 0.0
    if order < 0:
        return before
    for m in range(1, order + 1):
        before, current = current, (y * current + sigma * sigma * before) / m
    return current


@_scalar
def _series(y: float, sigma: float, a: float, b: float, order: int) -> float:
    """``S_a S_b G_order`` by the product of the two series: a and b at most sigma / 2, sigma > 0."""
    z = y / sigma
    alpha, beta = (a / sigma) ** 2, (b / sigma) ** 2
    total = _integrated_normal(y, sigma, order)
    if alpha == 0.0 and beta == 0.0:
        return total
    density = math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)
    scale = sigma**order
    # He_(j-1)(z) with j the order of derivative of Phi, advanced as n grows
    hermite_before, hermite, j = 0.0, 1.0, 1
    for n in range(1, _SERIES_TERMS):
        coefficient = 0.0
        for k in range(n + 1):
            coefficient += _S_COEFFICIENTS[k] * alpha**k * _S_COEFFICIENTS[n - k] * beta ** (n - k)
        derivative = 2 * n - order
        if derivative <= 0:
            term = _integrated_normal(y, sigma, -derivative) / sigma ** (-derivative)
        else:
            while j < derivative:
                hermite_before, hermite = hermite, z * hermite - (j - 1) * hermite_before
                j += 1
            term = density * hermite if derivative % 2 == 1 else -density * hermite
        total += coefficient * term * scale
    return total


@_scalar
def _spread_by_b(y: float, sigma: float, b: float, order: int) -> float:
    """``S_b G_order(y)`` for order 1, 2 or 3."""
    if abs(y) >= b + _NORMAL_REACH * sigma:  # the whole law lies on one side: its first three moments say all
        if y < 0.0:
            return 0.0
        variance = sigma * sigma + b * b / 6.0
        if order == 1:
            return y
        return 0.5 * (y * y + variance) if order == 2 else y * (y * y + 3.0 * variance) / 6.0
    if b <= _SERIES_RATIO * sigma:
        return _series(y, sigma, 0.0, b, order)
    upper = _integrated_normal(y + b, sigma, order + 2)
    middle = _integrated_normal(y, sigma, order + 2)
    lower = _integrated_normal(y - b, sigma, order + 2)
    return (upper - 2.0 * middle + lower) / (b * b)


@_scalar
def _total(x: float, sigma: float, a: float, b: float, order: int) -> float:
    """``S_a S_b G_order(x)`` for x <= 0 and order -1 (pdf), 0 (cdf) or 1 (the cdf's integral up to x)."""
    if math.isnan(x) or math.isnan(sigma) or math.isnan(a) or math.isnan(b):
        return math.nan
    wide, narrow = abs(a), abs(b)
    if wide < narrow:
        wide, narrow = narrow, wide
    if narrow < _NEGLIGIBLE * wide:
        narrow = 0.0
    if sigma < _NEGLIGIBLE * wide:
        sigma = 0.0
    if wide == 0.0 and sigma == 0.0:  # no error at all
        if order == 0:
            return 1.0 if x >= 0.0 else 0.0
        return math.inf if order < 0 and x == 0.0 else 0.0
    if x <= -(wide + narrow + _NORMAL_REACH * sigma):
        return 0.0
    if wide <= _SERIES_RATIO * sigma:
        # in units of sigma, so that nothing under- or overflows
        return _series(x / sigma, 1.0, wide / sigma, narrow / sigma, order) * sigma**order
    # in units of the wide half-width, so that nothing under- or overflows
    x, sigma, narrow = x / wide, sigma / wide, narrow / wide
    value = (
        _spread_by_b(x + 1.0, sigma, narrow, order + 2)
        - 2.0 * _spread_by_b(x, sigma, narrow, order + 2)
        + _spread_by_b(x - 1.0, sigma, narrow, order + 2)
    )
    return max(value, 0.0) * wide**order


def _cdf(x, sigma, a, b):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    if x > 0.0:
        return 1.0 - _total(-x, sigma, a, b, 0)
    return _total(x, sigma, a, b, 0)


def _pdf(x, sigma, a, b):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    return _total(-abs(x), sigma, a, b, -1)


def _central(x, sigma, a, b):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    if x < 0.0:
        return 0.0
    if sigma == 0.0 and a == 0.0 and b == 0.0:
        return 1.0
    return max(1.0 - 2.0 * _total(-x, sigma, a, b, 0), 0.0)  # at x = 0 rounding can leave -2e-16


def _mean_absolute(sigma, a, b):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    return 2.0 * _total(0.0, sigma, a, b, 1)


@functools.cache
def _ufunc(law: Callable[..., object]) -> Callable[..., object]:
    """Made when it is first used: even from the cache that takes a sixth of a second each."""
    signature = f"float64({', '.join(['float64'] * law.__code__.co_argcount)})"
    made: Callable[..., object] = numba.vectorize([signature], cache=True)(law)
    return made


def _silently(law: Callable[..., object], *arguments: object) -> NDArray[np.float64]:
    """The ufunc's value; LLVM evaluates branches that are not taken, whose flags mean nothing."""
    with np.errstate(all="ignore"):
        return np.asarray(_ufunc(law)(*arguments), dtype=float)


def total_cdf(x: object, sigma: object, a: object, b: object) -> NDArray[np.float64]:
    """P(error <= x); all arguments broadcast; sigma, a, b not negative, any of them or all may be zero."""
    return _silently(_cdf, x, sigma, a, b)


def total_pdf(x: object, sigma: object, a: object, b: object) -> NDArray[np.float64]:
    """Density of the error at x, per unit of x; infinite at 0 where there is no error at all."""
    return _silently(_pdf, x, sigma, a, b)


def central_probability(x: object, sigma: object, a: object, b: object) -> NDArray[np.float64]:
    """P(|error| <= x): 0 for negative x."""
    return _silently(_central, x, sigma, a, b)


def mean_absolute(sigma: object, a: object, b: object) -> NDArray[np.float64]:
    """E|error| = 2 E[max(-error, 0)], twice the cdf's integral up to 0."""
    return _silently(_mean_absolute, sigma, a, b)
