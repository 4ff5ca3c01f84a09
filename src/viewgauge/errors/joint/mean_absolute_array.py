"""E|error| of the closed form for arrays: the three forms of :mod:`closed_form_array` at the centre of the law.

``E|error| = 2 S_a S_b G_1(0)`` with the operators of :mod:`closed_form`: one order of integration more than a
probability. At the centre the law's symmetry leaves little to evaluate:

- both half-widths small: the Hermite functions are numbers there, and the whole is a polynomial;
- the narrower one small: one evaluation of the normal law, at the wide half-width;
- none small: four.

So few that the pairs need not be sorted by form to be put through vector instructions.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .closed_form_array import (
    _FLOATS,
    _NEGLIGIBLE,
    _PAIRS_IN,
    _PAIRS_OUT,
    _REACH,
    _SMALL,
    _coefficients,
    _inlined,
    _normal,
)

__all__ = ["mean_absolute_into"]

# Compiled code of that file is part of this one's, but numba's cache watches this file alone: a change there must
# change this line (sha256 of closed_form_array.py; a test compares).
_INLINED = "7419c631fa109aae"

_PEAK = 1 / math.sqrt(2 * math.pi)


@_inlined
def _both_small(sigma: float, a: float, b: float) -> float:
    variance = sigma * sigma + (a * a + b * b) * (1 / 6)
    c2, c3, c4, c5, c6, c7, c8 = _coefficients(a * a / variance, b * b / variance)
    # He_2, He_4, … at 0: plus or minus 1, 3, 15 = 3 · 5, …
    series = 1.0 - c2 + 3.0 * (c3 - 5.0 * (c4 - 7.0 * (c5 - 9.0 * (c6 - 11.0 * (c7 - 13.0 * c8)))))
    return 2.0 * _PEAK * math.sqrt(variance) * series


@_inlined
def _narrow_small(sigma: float, wide: float, narrow: float) -> float:
    variance = max(sigma * sigma + narrow * narrow * (1 / 6), _NEGLIGIBLE * _NEGLIGIBLE * wide * wide)
    spread = math.sqrt(variance)
    z = wide / spread
    square = z * z
    c2, c3, c4, c5, c6, c7, _ = _coefficients(narrow * narrow / variance, 0.0)
    centre = _PEAK * (1 / 3 + c2 - c3 + 3.0 * (c4 - 5.0 * (c5 - 7.0 * (c6 - 9.0 * c7))))
    tail = 0.0  # the three times integrated law at -wide
    if z < _REACH:
        density, mills = _normal(z)
        he2 = square - 1.0  # He_(2m+2) = (z² - 4m - 1) He_2m - 2m (2m - 1) He_(2m-2)
        he4 = (square - 5.0) * he2 - 2.0
        he6 = (square - 9.0) * he4 - 12.0 * he2
        he8 = (square - 13.0) * he6 - 30.0 * he4
        he10 = (square - 17.0) * he8 - 56.0 * he6
        series = c2 + c3 * he2 + c4 * he4 + c5 * he6 + c6 * he8 + c7 * he10
        tail = density * ((square + 2.0 - (square + 3.0) * z * mills) * (1 / 6) + series)
    return 2.0 * spread * ((square + 3.0) * z * (1 / 6) + 2.0 * (tail - centre)) / square


@_inlined
def _five_times_integrated(z: float) -> float:
    """120 times the five times integrated standard normal law at -z, z not negative."""
    if z >= _REACH:
        return 0.0
    density, mills = _normal(z)
    square = z * z
    return density * ((square + 9.0) * square + 8.0 - ((square + 10.0) * square + 15.0) * z * mills)


@_inlined
def _none_small(sigma: float, wide: float, narrow: float) -> float:
    sigma = max(sigma, 1e-6 * narrow)  # the square of what it is raised to changes the value by 1e-12 at most
    z, step = wide / sigma, narrow / sigma
    square = step * step
    tail = _five_times_integrated(z - step) - 2.0 * _five_times_integrated(z) + _five_times_integrated(z + step)
    whole = ((square + 10.0) * square + 15.0) * step
    centre = whole + 2.0 * (_five_times_integrated(step) - 8.0 * _PEAK)
    far = z * (z * z + 3.0 + 0.5 * square) * (1 / 6)
    return 2.0 * sigma * (far + (tail - centre) * (1 / 60) / square) / (z * z)


@numba.njit(
    numba.void(_PAIRS_IN, _PAIRS_IN, _PAIRS_IN, _PAIRS_OUT),
    cache=True,
    nogil=True,
    error_model="numpy",
    fastmath=_FLOATS,
)
def _mean_absolute_into(sigma, a, b, out):  # type: ignore[no-untyped-def] # numba's decorator needs a bare function
    for k in range(sigma.size):
        spread, wide, narrow = sigma[k], max(a[k], b[k]), min(a[k], b[k])
        total, unit = spread + a[k] + b[k], max(spread, wide)  # in this unit no square under- or overflows
        if not total > 0.0:  # no error, or NaN
            out[k] = total
            continue
        spread, wide, narrow = spread / unit, wide / unit, narrow / unit
        if wide <= _SMALL * spread:
            out[k] = unit * _both_small(spread, wide, narrow)
        elif narrow <= _SMALL * spread or narrow <= _NEGLIGIBLE * wide:
            out[k] = unit * _narrow_small(spread, wide, narrow)
        else:
            out[k] = unit * _none_small(spread, wide, narrow)


def mean_absolute_into(
    sigma: NDArray[np.float64], a: NDArray[np.float64], b: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """E|error| to 3e-12 of its standard deviation, written to ``out``; NaN where an argument is NaN.

    All arguments are contiguous float64 arrays of one shape ``(n,)`` and one unit, not negative. ``out`` may be one of
    them. Other Python threads run meanwhile. :func:`closed_form.mean_absolute` is the reference, exact to 1e-15.

    Raises
    ------
    InputError
        If the shapes differ: the compiled loop would read or write beyond an array's end.
    """
    shapes = [argument.shape for argument in (sigma, a, b, out)]
    if shapes.count(shapes[0]) != len(shapes):
        raise InputError("must have one shape", key="sigma, a, b, out", got=str(shapes), expected="four times (n,)")
    _mean_absolute_into(sigma, a, b, out)
