"""Error of the mean of several measurements: a normal error plus the triangular ones of all acquisitions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from ...exceptions import InputError
from ..law import Law, require_not_negative
from .closed_form import central_probability, mean_absolute, total_pdf
from .cosine_series import CENTRAL, DENSITY, MEAN_ABSOLUTE, cosine_series

__all__ = ["AveragedError"]

_FOLDED = 1e-12
"""Half-widths that are together so small are told from a normal error of their variance by nobody: see ``_folded``."""


class AveragedError(Law):
    """Normal error plus any number of independent triangular ones: ``sigma Z + sum_r w_r (U_r + U'_r - 1)``.

    The law of the mean of k acquisitions: sigma is the standard deviation of what the pose errors leave of the mean,
    and each acquisition brings two triangular errors of quantization (eq. 2) of 1/k of their half-widths. With one
    acquisition it is :class:`TotalError`.

    With at most two triangular errors the closed form; with more a series
    (:mod:`~viewgauge.errors.joint.cosine_series`). Probabilities are right to 1e-10, whatever the widths, and to 1e-13
    where none is far smaller than the others. The density is right to 1e-10 of its peak, but only to 2e-6 of it
    within the kink of one half-width that is more than 1e4 times all others and sigma. Quantiles closer to 0 or 1
    than 1e-10 are bounds.

    Parameters
    ----------
    sigma
        ``(...)`` standard deviation of the normal error, any unit.
    half_widths
        ``(..., r)`` half-widths w_r, same unit; the leading axes broadcast against ``sigma``.

    Raises
    ------
    InputError
        If a parameter is negative or not finite, or ``half_widths`` has no axis.
    """

    def __init__(self, sigma: ArrayLike, half_widths: ArrayLike) -> None:
        self.sigma = require_not_negative("sigma", sigma)
        self.half_widths = require_not_negative("half_widths", half_widths)
        if self.half_widths.ndim == 0:
            raise InputError(
                "must have the half-widths of one law in its last axis",
                key="half_widths",
                got="shape ()",
                expected="shape (..., r)",
            )
        self._folded_sigma, self._folded_widths = _folded(self.sigma, self.half_widths)

    @property
    def _shape(self) -> tuple[int, ...]:
        return self._folded_sigma.shape

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x."""
        value = self._evaluated(x, total_pdf, DENSITY)
        return np.maximum(value, 0.0)

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x)."""
        x = np.asarray(x, dtype=float)
        half = self.central_probability(np.abs(x)) / 2
        without_error = (self.sigma == 0) & (self.half_widths == 0).all(axis=-1)
        return np.where((x == 0) & without_error, 1.0, 0.5 + np.sign(x) * half)

    def central_probability(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(|error| <= x): 0 for negative x."""
        x = np.asarray(x, dtype=float)
        value = self._evaluated(np.maximum(x, 0.0), central_probability, CENTRAL)
        return np.where(x < 0, 0.0, np.clip(value, 0.0, 1.0))

    def mean(self) -> NDArray[np.float64]:
        """Zero."""
        return np.zeros(self._shape)

    def var(self) -> NDArray[np.float64]:
        """``sigma² + sum_r w_r² / 6``."""
        return np.asarray(self.sigma**2 + (self.half_widths**2).sum(axis=-1) / 6)

    def mean_absolute(self) -> NDArray[np.float64]:
        """E|error|."""

        def closed(_: object, sigma: object, a: object, b: object) -> NDArray[np.float64]:
            return mean_absolute(sigma, a, b)

        return self._evaluated(0.0, closed, MEAN_ABSOLUTE)

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line, or ± the sum of the half-widths where sigma is 0."""
        reach = np.where(self.sigma > 0, np.inf, self.half_widths.sum(axis=-1))
        return -reach, reach

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Draws of the normal and of all uniform errors."""
        rng = np.random.default_rng(random_state)
        shape = self._shape if size is None else tuple(np.atleast_1d(np.asarray(size, dtype=int)))
        uniform = rng.random((2, *shape, self.half_widths.shape[-1]))
        triangular = (self.half_widths * (uniform[0] - uniform[1])).sum(axis=-1)
        return np.asarray(self.sigma * rng.standard_normal(shape) + triangular)

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        reach = self.half_widths.sum(axis=-1)
        centre = self.sigma * ndtri(q)
        return np.asarray(centre - reach), np.asarray(centre + reach)

    def _evaluated(
        self, x: ArrayLike, closed_form: Callable[..., NDArray[np.float64]], what: int
    ) -> NDArray[np.float64]:
        """Of each law the closed form where it has at most two widths, else the series, in units of its spread."""
        x = np.asarray(x, dtype=float)
        shape = np.broadcast_shapes(x.shape, self._shape)
        x, sigma = (np.broadcast_to(v, shape).ravel() for v in (x, self._folded_sigma))
        widths = np.broadcast_to(self._folded_widths, (*shape, self._folded_widths.shape[-1]))
        widths = widths.reshape(len(x), -1)
        value = np.asarray(closed_form(x, sigma, widths[:, 0], widths[:, 1]), dtype=float)
        many = np.flatnonzero((widths[:, 2:] > 0).any(axis=1) & ~np.isnan(x))
        if len(many):
            unit = np.maximum(widths[many, 0], sigma[many])
            characteristic = {CENTRAL: 0, DENSITY: -1, MEAN_ABSOLUTE: 1}[what]
            series = cosine_series(x[many] / unit, sigma[many] / unit, widths[many] / unit[:, None], what)
            value[many] = series * unit**characteristic
        return value.reshape(shape)


def _folded(
    sigma: NDArray[np.float64], half_widths: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sigma, and the half-widths in descending order, at least two; the smallest ones as part of sigma.

    A law that contains a triangular error of half-width w or a normal one has a cdf F with ``|F''| <= 1 / w²`` or
    ``0.25 / sigma²``. Adding to it any error of mean 0 and variance v moves F by at most v/2 times that; so two
    errors of the same variance differ by no more than 1e-12 where ``v <= 1e-12 max(w², 4 sigma²)``. What the two
    widest leave is folded as far as that goes.
    """
    shape = np.broadcast_shapes(sigma.shape, half_widths.shape[:-1])
    sigma = np.broadcast_to(sigma, shape)
    widths = np.zeros((*shape, max(half_widths.shape[-1], 2)))
    widths[..., : half_widths.shape[-1]] = half_widths
    widths = -np.sort(-widths, axis=-1)
    unit = np.maximum(np.maximum(widths[..., 0], sigma), np.finfo(float).tiny)
    share, own = widths / unit[..., None], sigma / unit
    variance = share**2 / 6
    rest = np.cumsum(variance[..., ::-1], axis=-1)[..., ::-1]  # of this width and all that are narrower
    small = rest <= _FOLDED * np.maximum(share[..., :1] ** 2, 4 * own[..., None] ** 2)
    small[..., :2] = False  # the closed form takes two of any size
    folded = np.where(small, variance, 0.0).sum(axis=-1)
    # where nothing is folded sigma stays what it is, to the last digit
    return np.where(folded > 0, unit * np.sqrt(own**2 + folded), sigma), np.where(small, 0.0, widths)
