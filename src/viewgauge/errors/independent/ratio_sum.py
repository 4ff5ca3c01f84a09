"""The paper's independent model (eq. 15-19): up to four normal ratios and quantization, added as independent errors.

See :mod:`ratio_series` for the series and its error. A pixel that is wide against the displacement would need many
terms: there the displacement's density, by its own short series, is integrated against the exact piecewise quartic
law of the quantization error, between its kinks (Gauss-Legendre).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from ..joint.closed_form import _total
from .ratio_series import SMALLEST_MEAN, coefficients, displacement_reach

__all__ = ["CDF", "CENTRAL", "DENOMINATOR", "MEAN_ABSOLUTE", "OK", "PDF", "REACH", "SERIES", "evaluate_laws"]

PDF, CDF, CENTRAL, MEAN_ABSOLUTE, REACH = range(5)
OK, DENOMINATOR, SERIES = range(3)

# Compiled code of these files is part of this one's, but numba's cache watches this file alone: a change there must
# change this line (sha256 of closed_form.py and ratio_series.py; a test compares).
_INLINED = "cc5959440b868e16"

_WIDE = 8.0  # a half-width of Q in standard deviations of the displacement above which Q is integrated exactly
_NEGLIGIBLE = 1e-100
_PIECE = 4.0
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(24)

_compiled: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy")


@_compiled
def _series(kind: int, x: float, period: float, phi: Any) -> Any:
    """Density, cdf, central probability or mean absolute value of the law with Fourier coefficients phi."""
    if kind == PDF and abs(x) >= period:
        return 0.0
    if kind != MEAN_ABSOLUTE and abs(x) >= period:
        return 1.0 if x > 0.0 else 0.0
    if kind == CENTRAL and x < 0.0:
        return 0.0
    turn_re, turn_im = math.cos(math.pi * x / period), math.sin(math.pi * x / period)
    c, s, alternate = 1.0, 0.0, 1.0
    total = 0.0
    for n in range(1, phi.shape[1] + 1):
        c, s, alternate = c * turn_re - s * turn_im, c * turn_im + s * turn_re, -alternate
        if kind == PDF:
            total += phi[0, n - 1] * c + phi[1, n - 1] * s
        elif kind == CDF:
            total += (phi[0, n - 1] * s - phi[1, n - 1] * (c - alternate)) / n
        elif kind == CENTRAL:
            total += 2.0 * phi[0, n - 1] * s / n
        elif alternate < 0.0:
            total += phi[0, n - 1] / (n * n)
    if kind == PDF:
        return max((0.5 + total) / period, 0.0)
    if kind == MEAN_ABSOLUTE:
        return period * (0.5 - 4.0 * total / (math.pi * math.pi))
    start = 0.5 * (x / period + 1.0) if kind == CDF else x / period
    return min(max(start + total / math.pi, 0.0), 1.0)


@_compiled
def _quantized(kind: int, x: float, a: float, b: float) -> Any:
    """Density, cdf or E|x + Q| of the quantization error Q alone."""
    if kind == PDF:
        return _total(-abs(x), 0.0, a, b, -1)
    if kind == MEAN_ABSOLUTE:
        return abs(x) + 2.0 * _total(-abs(x), 0.0, a, b, 1)
    return 1.0 - _total(-x, 0.0, a, b, 0) if x > 0.0 else _total(x, 0.0, a, b, 0)


@_compiled
def _integrated(kind: int, x: float, a: float, b: float, period: float, phi: Any) -> Any:
    """E of :func:`_quantized` at x - D, D with Fourier coefficients phi: smooth between the kinks of Q."""
    if kind != MEAN_ABSOLUTE and abs(x) >= period + a + b:
        return 1.0 if kind == CDF and x > 0.0 else 0.0
    cuts = np.full(11, period)
    cuts[0] = -period
    for i in range(-1, 2):
        for j in range(-1, 2):
            cuts[1 + 3 * (i + 1) + (j + 1)] = min(max(x - i * a - j * b, -period), period)
    cuts = np.sort(cuts)
    total = 0.0
    for piece in range(10):
        width = cuts[piece + 1] - cuts[piece]
        parts = math.ceil(width / _PIECE)
        for part in range(parts):
            half = 0.5 * width / parts
            middle = cuts[piece] + half * (2 * part + 1)
            for node in range(_GAUSS_X.size):
                y = middle + half * _GAUSS_X[node]
                total += half * _GAUSS_W[node] * _series(PDF, y, period, phi) * _quantized(kind, x - y, a, b)
    return total


@_compiled
def _one_value(kind: int, x: float, a: float, b: float, period: float, phi: Any, exact: bool) -> Any:
    if math.isnan(x):
        return math.nan
    if phi.shape[1] == 0:  # no displacement
        if kind == CENTRAL:
            if x < 0.0:
                return 0.0
            return 1.0 if a == 0.0 else max(1.0 - 2.0 * _quantized(CDF, -x, a, b), 0.0)
        return _quantized(kind, x, a, b)
    if not exact:
        return _series(kind, x, period, phi)
    if kind == CENTRAL:
        if x < 0.0:
            return 0.0
        value = _integrated(CDF, x, a, b, period, phi) - _integrated(CDF, -x, a, b, period, phi)
    else:
        value = _integrated(kind, x, a, b, period, phi)
    value = max(value, 0.0)
    return min(value, 1.0) if kind in (CDF, CENTRAL) else value


@_compiled
def _prepared(amp: Any, eps: Any, r: Any, a: float, b: float) -> Any:
    """``status, unit, period, phi, exact`` of one law; lengths in units of ``unit``, no coefficients without ratios."""
    unit = 0.0
    nothing = np.zeros((2, 0))
    for k in range(amp.size):
        unit = math.hypot(unit, amp[k])
        if amp[k] != 0.0 and eps[k] * SMALLEST_MEAN > 1.0:
            return DENOMINATOR, 1.0, 0.0, nothing, False
    if unit <= _NEGLIGIBLE * max(a, b) or unit == 0.0:
        return OK, 1.0, 0.0, nothing, True
    scaled = amp / unit
    a, b = a / unit, b / unit
    period = displacement_reach(scaled, eps, r)
    exact = max(a, b) > _WIDE
    if exact:
        phi = coefficients(scaled, eps, r, 0.0, 0.0, period)
    else:
        period += a + b
        phi = coefficients(scaled, eps, r, a, b, period)
    return (OK if phi.shape[1] > 0 else SERIES), unit, period, phi, exact


@_compiled
def evaluate_laws(
    kind: int, x: Any, first: Any, amp: Any, eps: Any, r: Any, a: Any, b: Any, out: Any, status: Any
) -> None:
    """Values of n laws, the i-th at ``x[first[i]:first[i + 1]]``, written to ``out``; ``status`` ``(n,)`` says why NaN.

    ``amp, eps, r`` are ``(n, 4)`` (an amplitude of 0 is no ratio), ``a, b`` ``(n,)`` in the unit of amp and x.
    MEAN_ABSOLUTE and REACH (an interval about 0 that holds the law) take one x = 0 for each law.
    """
    for i in range(a.size):
        wide, narrow = max(a[i], b[i]), min(a[i], b[i])
        status[i], unit, period, phi, exact = _prepared(amp[i], eps[i], r[i], wide, narrow)
        for j in range(first[i], first[i + 1]):
            if status[i] != OK:
                out[j] = math.nan
            elif kind == REACH:
                out[j] = period * unit + (wide + narrow if exact else 0.0)
            else:
                value = _one_value(kind, x[j] / unit, wide / unit, narrow / unit, period, phi, exact)
                out[j] = value / unit if kind == PDF else (value * unit if kind == MEAN_ABSOLUTE else value)
