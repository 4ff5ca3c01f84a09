"""Closed forms of the ratio of two correlated normal variables, free of cancellation, in a standard scale.

The standard ratio is ``x = N(0, 1) / N(m, s)`` with correlation r, where m >= 0, s >= 0 and max(m, s) = 1: every
ratio of the paper's eq. 10 is one after a change of scale, and after a change of both signs where its mean is
negative. With ``q² = (1 - r)(1 + r)``::

    G² = (s x - r)² + q²      g_2 = 1 - r s x      e = m x / G      k = m |g_2| / G      t = k / (sqrt(2) s q)

    pdf = exp(-e²/2) / G² · [ s q exp(-t²) / pi + k erf(t) / sqrt(2 pi) ]                              (eq. 11, 12)

Erratum: the printed first exponent lacks the factor 1/(1 - r²); with it ``m²/(2 s² q²) = e²/2 + t²`` takes exp(-e²/2)
out of both terms, and both are positive. The cdf follows from ``P(V <= 0) + P(Y < 0) - 2 P(V <= 0, Y < 0)`` with
V = X - x Y and Owen's T function, whose arguments simplify::

    cdf = [x >= 0] + 2 T(e, -g_2 / (s q x)) - 2 T(m / s, r / q)

All arguments are arrays that broadcast; no ratio here is a single point (see ``NormalRatio``).

References: Hinkley, Biometrika 56 (1969) 635; Owen, Ann. Math. Stat. 27 (1956) 1075.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import dawsn, erf, owens_t

__all__ = ["log_density", "mode", "practical_moments", "ratio_cdf"]

_Array = NDArray[np.float64]

# Above this mean in standard deviations the asymptotic series of the moments is exact to rounding.
_SERIES_FROM = 12.0
_SERIES_TERMS = 20


def _shape_terms(x: _Array, s: _Array, r: _Array, m: _Array) -> tuple[_Array, ...]:
    """``q, G, g_2, e, k`` at x; where G = 0 (|r| = 1 at the value that is never taken) e is infinite."""
    q = np.sqrt((1 - r) * (1 + r))
    G = np.hypot(s * x - r, q)
    g2 = 1 - r * s * x
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        e = np.where(G > 0, m * (x / G), np.inf)
        k = np.where(G > 0, m * (np.abs(g2) / G), m)
    return q, G, g2, e, k


def _bracket(s: _Array, q: _Array, k: _Array) -> tuple[_Array, _Array]:
    """The bracket of the density, and ``erf(t)``."""
    width = s * q
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        t = np.where(width > 0, k / (np.sqrt(2) * width), np.where(k > 0, np.inf, 0.0))
        error = erf(t)
        return width / np.pi * np.exp(-t * t) + k * error / np.sqrt(2 * np.pi), error


def log_density(x: _Array, s: _Array, r: _Array, m: _Array) -> _Array:
    """Logarithm of the density at x, finite far beyond the underflow of the density itself."""
    q, G, _, e, k = _shape_terms(np.where(np.isinf(x), 0.0, x), s, r, m)
    bracket, _ = _bracket(s, q, k)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.log(bracket) - 2 * np.log(G) - e * e / 2
    # G = 0 with m > 0 sends exp(-e²/2) to 0 faster than 1/G² grows
    return np.asarray(np.where(np.isinf(x) | np.isinf(e), -np.inf, value))


def ratio_cdf(x: _Array, s: _Array, r: _Array, m: _Array) -> _Array:
    """P(ratio <= x), absolute error about 1e-15."""
    infinite, far = np.isinf(x), np.where(x > 0, 1.0, 0.0)
    x = np.where(infinite, 0.0, x)
    q, _, g2, e, _ = _shape_terms(x, s, r, m)
    right = x >= 0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slope = -g2 / (s * q * x)
        # g_2 = 0 leaves no angle; 1/0 is infinite with the sign that the limit from x -> 0 has
        slope = np.where(g2 == 0, 0.0, np.where(s * q * x == 0, np.where(right, -1, 1) * np.sign(g2) * np.inf, slope))
        constant = owens_t(np.where(s > 0, m / s, np.inf), np.where(q > 0, r / q, np.sign(r) * np.inf))
    value = np.where(right, 1.0, 0.0) + 2 * owens_t(e, slope) - 2 * constant
    return np.asarray(np.where(infinite, far, np.clip(value, 0.0, 1.0)))


def _score(x: _Array, s: _Array, r: _Array, m: _Array) -> _Array:
    """``G⁴ d(log pdf)/dx``, from de/dx = m g_2 / G³ and dk/dx = -m s² q² x sign(g_2) / G³."""
    q, G, g2, _, k = _shape_terms(x, s, r, m)
    bracket, error = _bracket(s, q, k)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(bracket > 0, error * np.sign(g2) / (np.sqrt(2 * np.pi) * bracket), 0.0)
    return np.asarray(-m * m * x * g2 - 2 * s * (s * x - r) * G * G - share * m * s * s * q * q * x * G)


def mode(s: _Array, r: _Array, m: _Array) -> _Array:
    """Place of the highest density, ``(n,)`` of parameters ``(n,)``: of the sign of r, and 0 for r = 0.

    The density can have two peaks (Marsaglia 2006), so it is looked up on a grid first: logarithmic about 0 (mean
    of the numerator) and about r/s (where both variables vanish together); the zero of the slope is then exact.
    """
    from scipy.optimize.elementwise import find_root  # late: slow to import, and only the mode needs it

    steps = np.concatenate([[0.0], np.logspace(-10, 4, 400)])
    steps = np.concatenate([-steps[:0:-1], steps])
    with np.errstate(divide="ignore"):
        second = np.where(s > 0, r / np.maximum(s, 1e-100), 0.0)
    grid = np.sort(np.concatenate([steps + 0 * s[:, None], second[:, None] + steps], axis=1), axis=1)
    best = log_density(grid, s[:, None], r[:, None], m[:, None]).argmax(axis=1).clip(1, grid.shape[1] - 2)
    rows = np.arange(len(s))
    low, high = best - 1, best + 1
    for _ in range(grid.shape[1]):  # a top that is flat to rounding: out to where the slope has a sign
        rises = (_score(grid[rows, low], s, r, m) <= 0) & (low > 0)
        falls = (_score(grid[rows, high], s, r, m) >= 0) & (high < grid.shape[1] - 1)
        if not (rises | falls).any():
            break
        low, high = low - rises, high + falls
    found = find_root(
        _score,
        (grid[rows, low], grid[rows, high]),
        args=(s, r, m),
        tolerances={"xrtol": 1e-15, "fatol": 0.0, "xatol": 0.0, "frtol": 0.0},
        maxiter=300,
    )
    value = np.where(np.isfinite(found.x), found.x, grid[rows, best])
    return np.asarray(np.where(np.sign(value) == np.sign(r), value, 0.0))


def practical_moments(s: _Array, r: _Array, m: _Array) -> tuple[_Array, _Array]:
    """Mean and variance in the sense of principal value and finite part; meaningful for m/s >= 4 only.

    With b = m/s and kappa = FP E[1/(b + Z)²] = sqrt(2) b D(b/sqrt(2)) - 1 (D: Dawson's function)::

        mean = -r kappa / s      var = [ r² (b² kappa - 1 - 2 kappa) + (1 - r²) kappa - r² kappa² ] / s²

    For large b by the series kappa = sum (2n - 1)!! b^(-2n), n >= 1.
    """
    b_inverse = np.where(m > 0, s / np.where(m > 0, m, 1.0), np.inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        b = 1 / b_inverse
        kappa = np.sqrt(2) * b * dawsn(b / np.sqrt(2)) - 1
        first, second = b * b * kappa, b * b * (b * b * kappa - 1 - 2 * kappa)  # both tend to 1
    y = np.minimum(b_inverse, 1 / _SERIES_FROM) ** 2
    term = np.ones_like(y)
    first_series, second_series = np.zeros_like(y), np.zeros_like(y)
    for n in range(1, _SERIES_TERMS + 1):  # term = (2n - 1)!! y^(n - 1)
        first_series += term
        second_series += (2 * n - 1) * term
        term = term * (2 * n + 1) * y
    far = b_inverse <= 1 / _SERIES_FROM
    first, second = np.where(far, first_series, first), np.where(far, second_series, second)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = -r * s / m**2 * first
        variance = (r * r * second + (1 - r) * (1 + r) * first) / m**2 - mean**2
    return np.asarray(mean), np.asarray(variance)
