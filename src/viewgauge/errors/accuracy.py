"""Law of the accuracy of a measured characteristic (paper, eq. 20)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from .independent.independent_total import IndependentTotalError
from .law import Law, require_finite, require_not_negative
from .total import TotalError

__all__ = ["Accuracy"]


class Accuracy(Law):
    """Accuracy = 1 - |eps|/L of a characteristic whose image has length L and total error eps (eq. 20).

    At most 1, and negative where the error exceeds the length itself.

    Parameters
    ----------
    error
        Law of the total error eps, mm on the image; its shape broadcasts with that of the length.
    length_mm
        Nominal image length L, mm, positive.

    Raises
    ------
    InputError
        If a length is not positive and finite.
    """

    def __init__(self, error: TotalError | IndependentTotalError, length_mm: ArrayLike) -> None:
        self.error = error
        self.length_mm = require_finite("length_mm", length_mm)
        if (self.length_mm <= 0).any():
            raise InputError("must be positive", key="length_mm", got=length_mm)

    def success_probability(self, relative_tolerance: ArrayLike) -> NDArray[np.float64]:
        """Pr{Accuracy >= 1 - T} = P(|eps| <= T L)."""
        return self.error.central_probability(
            require_not_negative("relative_tolerance", relative_tolerance) * self.length_mm
        )

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at accuracy x: ``L (f(L (1 - x)) + f(-L (1 - x)))``, 0 above 1."""
        x, absolute = self._absolute_error(x)
        value = self.length_mm * (self.error.pdf(absolute) + self.error.pdf(-absolute))
        return np.asarray(np.where(x > 1, 0.0, value))

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(Accuracy <= x)."""
        return np.asarray(1 - self.sf(x))

    def sf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(Accuracy > x) = P(|eps| < L (1 - x))."""
        x, absolute = self._absolute_error(x)
        return np.asarray(np.where(x >= 1, 0.0, self.error.central_probability(absolute)))

    def mean(self) -> NDArray[np.float64]:
        """Expected accuracy, 1 - E|eps|/L."""
        return np.asarray(1 - self.error.mean_absolute() / self.length_mm)

    def var(self) -> NDArray[np.float64]:
        """(E eps² - (E|eps|)²) / L²."""
        second = self.error.var() + self.error.mean() ** 2
        return np.asarray(np.maximum(second - self.error.mean_absolute() ** 2, 0.0) / self.length_mm**2)

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """From 1 - max|eps|/L, or minus infinity, to 1."""
        low, high = self.error.support()
        lowest = np.asarray(1 - np.maximum(np.abs(low), np.abs(high)) / self.length_mm)
        return lowest, np.ones(lowest.shape)

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """From draws of the total error."""
        shape = self.support()[1].shape if size is None else size
        return np.asarray(1 - np.abs(self.error.rvs(shape, random_state)) / self.length_mm)

    def _absolute_error(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        x = np.asarray(x, dtype=float)
        return x, np.asarray(np.maximum(1 - x, 0.0) * self.length_mm)

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        # |eps| exceeds its quantile of q with the share q of both tails: between the nearer and the farther of them
        tails = np.abs(self.error.ppf(q / 2)), np.abs(self.error.ppf(1 - q / 2))
        near, far = np.minimum(*tails) * (1 - 1e-9), np.maximum(*tails) * (1 + 1e-9)
        return np.asarray(1 - far / self.length_mm), np.asarray(1 - near / self.length_mm)
