"""What every error law can do, in the words of scipy.stats."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..drawing import Drawable
from ..exceptions import InputError

__all__ = ["Law"]


class Law(Drawable, ABC):
    """A continuous law of one real error; parameters and arguments broadcast like NumPy arrays."""

    @abstractmethod
    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x."""

    @abstractmethod
    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x)."""

    @abstractmethod
    def mean(self) -> NDArray[np.float64]:
        """Expected value."""

    @abstractmethod
    def var(self) -> NDArray[np.float64]:
        """Variance."""

    @abstractmethod
    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ends of the smallest interval that holds the error."""

    @abstractmethod
    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Independent draws; ``size`` must broadcast with the parameters and defaults to their shape."""

    @abstractmethod
    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Two values that enclose the quantiles of 0 < q < 1."""

    def sf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error > x)."""
        return np.asarray(1.0 - self.cdf(x))

    def std(self) -> NDArray[np.float64]:
        """Standard deviation."""
        return np.sqrt(self.var())

    def ppf(self, q: ArrayLike) -> NDArray[np.float64]:
        """Quantile: the x with cdf(x) = q; the ends of the support for 0 and 1, NaN outside [0, 1].

        Where q is too small for the cdf to tell it from 0 (below about 1e-18), a lower bound of the quantile.
        """
        q = np.asarray(q, dtype=float)
        low, high = self.support()
        inside = np.where((q > 0) & (q < 1), q, 0.5)
        left, right = np.broadcast_arrays(*self._quantile_bracket(inside))
        # the parameters take part by broadcasting: every element keeps its index
        index = np.arange(left.size).reshape(left.shape)
        shape = left.shape
        target = np.broadcast_to(inside, shape).ravel()

        width = right - left

        def residual(t: NDArray[np.float64], k: NDArray[np.int64]) -> NDArray[np.float64]:
            full = np.zeros(left.size)
            flat = k.astype(int)
            full[flat] = left.ravel()[flat] + t * width.ravel()[flat]
            return np.asarray(self.cdf(full.reshape(shape)).ravel()[flat] - target[flat])

        root = np.asarray(left, dtype=float).copy()
        open_bracket = width > 0
        if open_bracket.any():
            from scipy.optimize.elementwise import find_root  # late: slow to import, and only quantiles need it

            found = find_root(
                residual,
                (np.zeros(open_bracket.sum()), np.ones(open_bracket.sum())),  # share of the bracket: any unit will do
                args=(index[open_bracket].astype(float),),
                tolerances={"xrtol": 1e-15, "fatol": 0.0, "xatol": 0.0, "frtol": 0.0},
                maxiter=200,
            )
            root[open_bracket] += np.where(np.isfinite(found.x), found.x, 0.0) * width[open_bracket]
        return np.asarray(
            np.select([q == 0, q == 1, (q > 0) & (q < 1)], [low, high, root], default=np.nan), dtype=float
        )

    def interval(self, confidence: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ends of the interval with equal tails that holds the error with a probability."""
        confidence = np.asarray(confidence, dtype=float)
        return self.ppf((1 - confidence) / 2), self.ppf((1 + confidence) / 2)

    def median(self) -> NDArray[np.float64]:
        """The quantile of 1/2."""
        return self.ppf(0.5)


def require_not_negative(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """The value as float64; raises InputError where an entry is negative, infinite, NaN or not a number."""
    array = require_finite(name, value)
    if (array < 0).any():
        raise InputError("must not be negative", key=name, got=value)
    return array


def require_finite(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """The value as float64; raises InputError where an entry is infinite, NaN or not a number."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError("must be a number or an array of numbers", key=name, got=value) from error
    if not np.isfinite(array).all():
        raise InputError("must be finite", key=name, got=value)
    return array
