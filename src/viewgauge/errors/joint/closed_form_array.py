"""P(|error| <= x) of the closed form for arrays: 15 times as fast as the scalar code, to 1e-11 instead of 1e-15.

The law is that of :mod:`closed_form`: a normal error of standard deviation sigma plus two triangular errors of
half-widths a and b. What makes it fast is that each pair is put to the cheapest of three forms, and that all pairs of
a form go through one loop without branches, which the compiler turns into vector instructions:

- both half-widths small (at most 0.7 sigma): the variance of the triangular laws, h²/6 each, is folded into the normal
  law; what is left of their cumulants (of order 4, 6, 8, …) is a short series of Hermite functions. One evaluation of
  the normal law.
- the narrower one small: it is folded in the same way, and the wider one is the second difference over its half-width
  of the twice integrated law. Three evaluations.
- none small: the second difference over both of the four times integrated law. Nine evaluations.

The cumulants of a triangular law of half-width h are ``kappa_2k = 2 B_2k h^(2k) / (2k)`` with the Bernoulli numbers
B: it is the sum of two uniform errors of width h. As in the scalar code everything is evaluated at -x <= 0, the
differences of the wide half-width cancel nothing there, and those of the narrow one are taken over its reach only.

The normal law comes from two polynomials: ``exp`` on [-81/2, 0] as the 64th power of one of degree 10, and the ratio
of Mills, Phi(-z)/phi(z), on [0, 9] of degree 16 in 1/(z + 4): no table, no branch, relative error 4e-14.

References
----------
Kendall and Stuart, *The Advanced Theory of Statistics*, vol. 1, ch. 6 (cumulants, Edgeworth's form of the series).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError

__all__ = ["central_probability_into"]

_SMALL = 0.7
"""Half-widths up to this many sigma are folded into the normal law: the series' error is then 5e-12."""
_NEGLIGIBLE = 1e-7
"""A narrow half-width below this share of the wide one is folded too: its square is all that counts."""
_REACH = 9.0
"""Beyond this many sigma a normal law is 0 or 1."""
_SURE = 7.5
"""An allowed error of this many sigma beyond the widest quantization error is certain, to 1e-13."""
_DONE = 3
"""Comes after the three forms: nothing to compute."""
_TILE = 1024
"""Pairs sorted by form at once: enough to fill the groups of every form, few enough to stay in the nearest caches."""
_LANES = 32
"""The forms run over whole groups of so many pairs. The few that a loop leaves over would be computed one by one:
slowly, and rounded otherwise, so that a result would depend on its neighbours."""

_BERNOULLI = [Fraction(*r) for r in ((1, 6), (-1, 30), (1, 42), (-1, 30), (5, 66), (-691, 2730), (7, 6), (-3617, 510))]
# kappa_2k / (2k)! for h = 1, k = 2 … 8
_K2, _K3, _K4, _K5, _K6, _K7, _K8 = (
    float(2 * _BERNOULLI[k - 1] / (2 * k) / math.factorial(2 * k)) for k in range(2, 9)
)

# Chebyshev interpolants, written as powers of a variable in [-1, 1]; a test makes them anew with 50 digits.
_MILLS = (
    0.4035808455450232,
    -0.47077952951656576,
    0.25302060615480687,
    -0.09798323261516662,
    0.025279631662552423,
    -0.003158250706809638,
    -0.0003333693565202397,
    0.00016538505273861926,
    3.159123459535732e-06,
    -8.23490996505473e-06,
    -1.9918890870879016e-07,
    4.595757540109275e-07,
    4.0908099268552345e-08,
    -2.5244667680665378e-08,
    -5.300990238889198e-09,
    9.96086328752994e-10,
    3.993826288774801e-10,
)
_MILLS_SHIFT, _MILLS_SCALE = 17 / 9, 104 / 9  # variable 17/9 - (104/9)/(z + 4) for z in [0, 9]
_ROOT_EXP = (
    0.7287633299194912,
    0.23058527235733964,
    0.036479310665907164,
    0.003847427296782392,
    0.00030433751078129786,
    1.9258858174158845e-05,
    1.0156038471815329e-06,
    4.590604060437114e-08,
    1.8156218801867682e-09,
    6.399054124095643e-11,
    2.0238566285792023e-12,
)
"""exp(w (t - 1)) with w = 81/256 for t in [-1, 1]; with t = 1 - z²/40.5 its 64th power is exp(-z²/2)."""
_PER_ROOT_TWO_PI = 1 / math.sqrt(2 * math.pi)

_Function = TypeVar("_Function", bound=Callable[..., object])
_FLOATS = {"contract", "nsz"}  # multiply and add in one instruction; nothing that changes the order of a sum


def _inlined(function: _Function) -> _Function:
    """Compile into every caller: a loop with a call left in it is not turned into vector instructions."""
    compiled: _Function = numba.njit(error_model="numpy", fastmath=_FLOATS, forceinline=True)(function)
    return compiled


@_inlined
def _normal(z: float) -> tuple[float, float]:
    """phi(z) and the ratio of Mills Phi(-z)/phi(z) for 0 <= z <= 9."""
    t = 1.0 - z * z * (1 / 40.5)
    value = _ROOT_EXP[-1]
    for k in range(len(_ROOT_EXP) - 2, -1, -1):
        value = value * t + _ROOT_EXP[k]
    for _ in range(6):
        value *= value
    t = _MILLS_SHIFT - _MILLS_SCALE / (z + 4.0)
    mills = _MILLS[-1]
    for k in range(len(_MILLS) - 2, -1, -1):
        mills = mills * t + _MILLS[k]
    return value * _PER_ROOT_TWO_PI, mills


@_inlined
def _coefficients(u: float, v: float) -> tuple[float, float, float, float, float, float, float]:
    """C_2 … C_8 in ``exp(sum q_k t^k) = 1 + sum C_k t^k``, q_k = kappa_2k/(2k)! (u^k + v^k), k from 2 on.

    u, v are the squares of the half-widths in units of the folded standard deviation.
    """
    u2, v2 = u * u, v * v
    u3, v3 = u2 * u, v2 * v
    u4, v4 = u2 * u2, v2 * v2
    q2, q3, q4 = _K2 * (u2 + v2), _K3 * (u3 + v3), _K4 * (u4 + v4)
    q5, q6 = _K5 * (u2 * u3 + v2 * v3), _K6 * (u3 * u3 + v3 * v3)
    q7, q8 = _K7 * (u3 * u4 + v3 * v4), _K8 * (u4 * u4 + v4 * v4)
    half = 0.5 * q2 * q2
    c6 = q6 + q2 * (q4 + q2 * q2 * (1 / 6)) + 0.5 * q3 * q3
    c7 = q7 + q2 * q5 + q3 * (q4 + half)
    c8 = q8 + q2 * q6 + q3 * q5 + 0.5 * q4 * q4 + half * q4 + 0.5 * q2 * q3 * q3 + half * half * (1 / 6)
    return q2, q3, q4 + half, q5 + q2 * q3, c6, c7, c8


@_inlined
def _hermite_sum(coefficients: tuple[float, ...], z: float, first: int) -> float:
    """``sum_k coefficients[k] He_(first + 2k)(z)`` for an odd first order."""
    even, odd = 1.0, z  # He_0, He_1
    for order in range(2, first, 2):
        even = z * odd - (order - 1) * even
        odd = z * even - order * odd
    total = coefficients[0] * odd
    for k in range(1, len(coefficients)):
        order = first + 2 * k - 1
        even = z * odd - (order - 1) * even
        odd = z * even - order * odd
        total += coefficients[k] * odd
    return total


@_inlined
def _both_small(x: float, sigma: float, a: float, b: float) -> float:
    variance = sigma * sigma + (a * a + b * b) * (1 / 6)
    scale = 1.0 / variance
    z = min(x * math.sqrt(scale), _REACH)
    density, mills = _normal(z)
    return 1.0 - 2.0 * density * (mills + _hermite_sum(_coefficients(a * a * scale, b * b * scale), z, 3))


@_inlined
def _twice_integrated(y: float, per_sigma: float, coefficients: tuple[float, ...]) -> float:
    """The twice integrated law of a normal error with a folded triangular one, at y, in units of its variance."""
    z = y * per_sigma
    size = abs(z)
    density, mills = _normal(min(size, _REACH))
    whole = 0.5 * (size * size + 1.0)
    tail = density * (whole * mills - 0.5 * size + _hermite_sum(coefficients, size, 1))
    tail = tail if size < _REACH else 0.0
    return whole - tail if z > 0.0 else tail


@_inlined
def _narrow_small(x: float, sigma: float, wide: float, narrow: float) -> float:
    variance = max(sigma * sigma + narrow * narrow * (1 / 6), _NEGLIGIBLE * _NEGLIGIBLE * wide * wide)
    per_sigma = 1.0 / math.sqrt(variance)
    c = _coefficients(narrow * narrow / variance, 0.0)[:6]
    difference = _twice_integrated(wide - x, per_sigma, c) - 2.0 * _twice_integrated(-x, per_sigma, c)
    difference += _twice_integrated(-wide - x, per_sigma, c)
    return 1.0 - 2.0 * difference * variance / (wide * wide)


@_inlined
def _four_times_integrated(z: float) -> float:
    """24 times the four times integrated standard normal law."""
    size = abs(z)
    density, mills = _normal(min(size, _REACH))
    square = size * size
    whole = (square + 6.0) * square + 3.0
    tail = density * (whole * mills - (square + 5.0) * size)
    tail = tail if size < _REACH else 0.0
    return whole - tail if z > 0.0 else tail


@_inlined
def _spread(y: float, sigma: float, narrow: float) -> float:
    """The twice integrated law of a normal and the narrow triangular error at y."""
    z, step = y / sigma, narrow / sigma
    difference = _four_times_integrated(z + step) - 2.0 * _four_times_integrated(z) + _four_times_integrated(z - step)
    near = difference * (sigma * sigma / (24.0 * step * step))
    # outside its reach the law lies on one side, and two moments say all
    beyond = 0.5 * (y * y + sigma * sigma + narrow * narrow * (1 / 6)) if y > 0.0 else 0.0
    return beyond if abs(y) >= narrow + _REACH * sigma else near


@_inlined
def _none_small(x: float, sigma: float, wide: float, narrow: float) -> float:
    sigma = max(sigma, 1e-6 * narrow)  # the square of what it is raised to changes the value by 1e-12 at most
    difference = _spread(wide - x, sigma, narrow) - 2.0 * _spread(-x, sigma, narrow) + _spread(-wide - x, sigma, narrow)
    return 1.0 - 2.0 * difference / (wide * wide)


def _loop(form: Callable[..., float]) -> Callable[..., None]:
    """A form over the first n entries of separate arrays, which the compiler may assume to be without overlap."""

    @numba.njit(error_model="numpy", fastmath=_FLOATS)
    def loop(x, sigma, wide, narrow, out, n):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
        for k in range(n):
            out[k] = form(x[k], sigma[k], wide[k], narrow[k])

    compiled: Callable[..., None] = loop
    return compiled


_loop_both, _loop_narrow, _loop_none = (_loop(form) for form in (_both_small, _narrow_small, _none_small))


@numba.njit(error_model="numpy")  # not _FLOATS: a pair at a border must get the same form in every place
def _sort(x, sigma, a, b, form, scaled, out):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    """The form of each pair, its numbers in a unit of its own, and its value where that is known already."""
    for k in range(x.size):
        here, spread, wide, narrow = x[k], sigma[k], max(a[k], b[k]), min(a[k], b[k])
        total = here + spread + a[k] + b[k]
        certain = (here >= 0.0) & (here >= wide + narrow + _SURE * spread)
        undefined = total != total  # NaN
        wide_counts = wide > _SMALL * spread
        narrow_counts = wide_counts & (narrow > _SMALL * spread) & (narrow > _NEGLIGIBLE * wide)
        computed = np.int64(wide_counts) + np.int64(narrow_counts)
        form[k] = _DONE if certain | undefined | (here < 0.0) else computed
        unit = 1.0 / max(max(wide, spread), 1e-300)  # in this unit no square under- or overflows
        scaled[0, k], scaled[1, k] = here * unit, spread * unit
        scaled[2, k], scaled[3, k] = wide * unit, narrow * unit
        out[k] = total if undefined else (1.0 if certain else 0.0)


_PAIRS_IN = numba.types.Array(numba.float64, 1, "C", readonly=True)  # takes writable arrays as well
_PAIRS_OUT = numba.types.Array(numba.float64, 1, "C")


@numba.njit(
    numba.void(_PAIRS_IN, _PAIRS_IN, _PAIRS_IN, _PAIRS_IN, _PAIRS_OUT),
    cache=True,
    nogil=True,
    error_model="numpy",
    fastmath=_FLOATS,
)
def _central_into(x, sigma, a, b, out):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    form, scaled, known = np.empty(_TILE, np.uint64), np.empty((4, _TILE)), np.empty(_TILE)
    where = np.empty((4, _TILE), np.uint64)
    values = np.ones((4, 5, _TILE))
    counts = np.empty(4, np.uint64)
    for first in range(0, x.size, _TILE):
        last = min(first + _TILE, x.size)
        _sort(x[first:last], sigma[first:last], a[first:last], b[first:last], form, scaled, known)
        counts[:] = 0
        for k in range(last - first):  # without branches: which form comes next is hard to foresee
            f = form[k]
            n = counts[f]
            counts[f] = n + np.uint64(1)
            where[f, n] = k
            values[f, 0, n], values[f, 1, n] = scaled[0, k], scaled[1, k]
            values[f, 2, n], values[f, 3, n] = scaled[2, k], scaled[3, k]
        v = values[0]
        _loop_both(v[0], v[1], v[2], v[3], v[4], -(-np.int64(counts[0]) // _LANES) * _LANES)
        v = values[1]
        _loop_narrow(v[0], v[1], v[2], v[3], v[4], -(-np.int64(counts[1]) // _LANES) * _LANES)
        v = values[2]
        _loop_none(v[0], v[1], v[2], v[3], v[4], -(-np.int64(counts[2]) // _LANES) * _LANES)
        for f in range(_DONE):
            for k in range(np.int64(counts[f])):
                known[where[f, k]] = min(max(values[f, 4, k], 0.0), 1.0)
        out[first:last] = known[: last - first]


def central_probability_into(
    x: NDArray[np.float64],
    sigma: NDArray[np.float64],
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """P(|error| <= x) to an absolute 1e-11, written to ``out``; 0 for negative x, NaN where an argument is NaN.

    All arguments are contiguous float64 arrays of one shape ``(n,)`` and one unit; sigma, a, b finite, not negative.
    ``out`` may be one of the arguments. Other Python threads run meanwhile; each value depends on its own four
    arguments only, to the last bit. :func:`closed_form.central_probability` is the reference, exact to 1e-15.

    Raises
    ------
    InputError
        If the shapes differ: the compiled loop would read or write beyond an array's end.
    """
    shapes = [argument.shape for argument in (x, sigma, a, b, out)]
    if shapes.count(shapes[0]) != len(shapes):
        raise InputError("must have one shape", key="x, sigma, a, b, out", got=str(shapes), expected="five times (n,)")
    _central_into(x, sigma, a, b, out)
