"""The law of an image point's displacement error: a ratio of correlated normal variables (paper, eq. 10-12)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError
from ..law import Law, require_finite, require_not_negative
from .ratio_closed_form import log_density, mode, practical_moments, ratio_cdf

__all__ = ["NormalRatio"]

_LARGEST_BRACKET = 1e300


class NormalRatio(Law):
    """N(0, s_1) / N(mu, s_2) with correlation r (eq. 10-12, with the erratum of the first exponent).

    The law has Cauchy tails of weight Phi(-|mu|/s_2): it has no moments. Special cases: mu = 0 (the paper's f = C3)
    is a Cauchy law, s_2 = 0 a normal one, and s_1 = 0, or mu = 0 with |r| = 1, a single value. The law for -mu is that
    for mu.

    Parameters
    ----------
    sigma_numerator, sigma_denominator
        Standard deviations s_1 and s_2, in any units; the ratio is in theirs.
    correlation
        r in [-1, 1]; of no effect where a standard deviation is 0.
    mean_denominator
        mu, unit of s_2.

    Raises
    ------
    InputError
        If a standard deviation is negative, a correlation outside [-1, 1], a parameter not finite, or the denominator
        always 0.
    """

    MOMENTS_FROM = 4.0
    """|mu|/s_2 below which mean and variance are NaN (Marsaglia 2006 sets the same bound)."""

    def __init__(
        self,
        sigma_numerator: ArrayLike,
        sigma_denominator: ArrayLike,
        correlation: ArrayLike,
        mean_denominator: ArrayLike,
    ) -> None:
        s1, s2, r, mu = np.broadcast_arrays(
            require_not_negative("sigma_numerator", sigma_numerator),
            require_not_negative("sigma_denominator", sigma_denominator),
            require_finite("correlation", correlation),
            require_finite("mean_denominator", mean_denominator),
        )
        if (np.abs(r) > 1).any():
            raise InputError("must lie in [-1, 1]", key="correlation", got=correlation)
        if ((s2 == 0) & (mu == 0)).any():
            raise InputError(
                "the denominator is always 0", key="mean_denominator", hint="give it a mean or a standard deviation"
            )
        self.sigma_numerator, self.sigma_denominator, self.correlation, self.mean_denominator = s1, s2, r, mu
        size = np.maximum(np.abs(mu), s2)
        effective = np.where((s1 > 0) & (s2 > 0), r, 0.0)
        self._standard = (s2 / size, effective, np.abs(mu) / size)
        self._scale = s1 / size
        self._single = (s1 == 0) | ((np.abs(effective) == 1) & (mu == 0))
        self._value = np.where(s1 == 0, 0.0, np.divide(effective * s1, s2, out=np.zeros(s1.shape), where=s2 > 0))

    def _standardised(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """x, and x in the standard scale (anything where the law is a single value)."""
        x = np.asarray(x, dtype=float)
        with np.errstate(over="ignore"):
            return x, np.asarray(x / np.where(self._scale > 0, self._scale, 1.0))

    def scaled_to_mean_one(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """``A, eps, r`` such that the law is that of ``A N(0, 1) / N(1, eps)``; eps is infinite for mu = 0."""
        s, r, m = self._standard
        with np.errstate(divide="ignore"):
            eps = np.where(self._scale > 0, np.where(m > 0, s / np.where(m > 0, m, 1.0), np.inf), 0.0)
        return np.asarray(self._scale / np.where(m > 0, m, 1.0)), eps, r

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x (eq. 11, 12); infinite at the value of a law that has only one."""
        return np.exp(self.logpdf(x))

    def logpdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Logarithm of the density at x: finite where the density itself underflows."""
        x, standard = self._standardised(x)
        with np.errstate(divide="ignore"):
            value = log_density(standard, *self._standard) - np.log(self._scale)
        return self._unless_single(x, value, np.where(x == self._value, np.inf, -np.inf))

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x), absolute error below 1e-14."""
        x, standard = self._standardised(x)
        value = ratio_cdf(standard, *self._standard)
        return self._unless_single(x, value, np.where(x >= self._value, 1.0, 0.0))

    def sf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error > x), computed in the tail itself: no digits are lost for large x."""
        x, standard = self._standardised(x)
        s, r, m = self._standard
        value = ratio_cdf(-standard, s, -r, m)
        return self._unless_single(x, value, np.where(x >= self._value, 0.0, 1.0))

    def _unless_single(
        self, x: NDArray[np.float64], value: NDArray[np.float64], single: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        return np.asarray(np.where(self._single & ~np.isnan(x), single, value))

    def mode(self) -> NDArray[np.float64]:
        """The most likely error: of the sign of the correlation, 0 without correlation (paper, III-B)."""
        shape = self._scale.shape
        peak = mode(*(np.ravel(p) for p in self._standard)).reshape(shape) * self._scale
        return np.asarray(np.where(self._single, self._value, peak))

    def mean(self) -> NDArray[np.float64]:
        """Practical mean: the Cauchy principal value of E[X/Y], in closed form; NaN for |mu|/s_2 < 4.

        In theory the mean does not exist. The principal value leaves out a window that shrinks onto Y = 0,
        alike on both sides; any cut of the denominator below a small share of its mean gives the same up to
        terms of order exp(-mu²/(2 s_2²)): for |mu|/s_2 > 6 all practical definitions agree to 1e-5.
        """
        return self._moment(0)

    def var(self) -> NDArray[np.float64]:
        """Practical variance: Hadamard's finite part of E[(X/Y)²], less the practical mean squared; NaN as the mean."""
        return self._moment(1)

    def _moment(self, which: int) -> NDArray[np.float64]:
        s, _, m = self._standard
        value = practical_moments(*self._standard)[which] * self._scale ** (which + 1)
        value = np.where(m >= self.MOMENTS_FROM * s, value, np.nan)
        return np.asarray(np.where(self._single, 0.0 if which else self._value, value))

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line, or the one value."""
        return np.where(self._single, self._value, -np.inf), np.where(self._single, self._value, np.inf)

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Draws of numerator and denominator, divided."""
        rng = np.random.default_rng(random_state)
        shape = self._scale.shape if size is None else size
        z, independent = rng.standard_normal(shape), rng.standard_normal(shape)
        s, r, m = self._standard
        draws = self._scale * (r * z + np.sqrt((1 - r) * (1 + r)) * independent) / (m + s * z)
        return np.asarray(np.where(self._single, self._value, draws))

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ten times wider until the quantile is inside: tails of 1/x take -log10(q) steps."""
        low = np.where(self._single, self._value, -self._scale + 0 * q)
        high = np.where(self._single, self._value, self._scale + 0 * q)
        for side, end in ((-1, low), (1, high)):
            for _ in range(600):
                outside = (self.cdf(end) > q) if side < 0 else (self.cdf(end) < q)
                outside &= ~self._single & (np.abs(end) < _LARGEST_BRACKET)
                if not outside.any():
                    break
                end[outside] *= 10
        return low, high
