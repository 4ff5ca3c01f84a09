"""Marsaglia's standard form of a ratio of normal variables with any means, and his practical moments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError
from ..law import require_finite, require_not_negative

__all__ = ["MarsagliaForm", "marsaglia_form"]


@dataclass(frozen=True, eq=False)  # arrays do not compare to one truth value
class MarsagliaForm:
    """``r (z/w - s)`` is distributed as ``(a + x) / (b + y)``, x and y independent standard normal, a, b >= 0.

    References: Marsaglia, Ratios of normal variables, J. Stat. Software 16 (4), 2006.
    """

    a: NDArray[np.float64]
    b: NDArray[np.float64]
    r: NDArray[np.float64]
    s: NDArray[np.float64]

    def practical_mean(self) -> NDArray[np.float64]:
        """Marsaglia's fit ``a / (1.01 b - 0.2713)``, brought back to z/w; NaN unless a < 2.5 and b > 4.

        Accurate to about 1 %: :meth:`NormalRatio.mean` is exact in the sense it states.
        """
        return np.asarray(np.where(self._valid, self.s + self._mean / self.r, np.nan))

    def practical_std(self) -> NDArray[np.float64]:
        """Marsaglia's fit ``sqrt((a² + 1) / (b² + 0.108 b - 3.795) - mean²)``, as :meth:`practical_mean`."""
        with np.errstate(invalid="ignore", divide="ignore"):
            second = (self.a**2 + 1) / (self.b**2 + 0.108 * self.b - 3.795)
            return np.asarray(np.where(self._valid, np.sqrt(second - self._mean**2) / np.abs(self.r), np.nan))

    @property
    def _valid(self) -> NDArray[np.bool_]:
        return np.asarray((self.a < 2.5) & (self.b > 4))

    @property
    def _mean(self) -> NDArray[np.float64]:
        with np.errstate(divide="ignore"):
            return np.asarray(self.a / (1.01 * self.b - 0.2713))


def marsaglia_form(
    mean_numerator: ArrayLike,
    mean_denominator: ArrayLike,
    sigma_numerator: ArrayLike,
    sigma_denominator: ArrayLike,
    correlation: ArrayLike,
) -> MarsagliaForm:
    """Standard form (a, b, r, s) of z/w for jointly normal z, w with any means; all arguments broadcast.

    With q = sqrt(1 - rho²): ``s = rho s_z/s_w``, ``b = |mu_w|/s_w``, ``|a| = |mu_z/s_z - rho mu_w/s_w| / q``,
    ``|r| = s_w/(s_z q)``; r is negative where a and b would have opposite signs.

    Raises
    ------
    InputError
        If a standard deviation is not positive, or the correlation not inside (-1, 1): no such form exists then.
    """
    z, w = require_finite("mean_numerator", mean_numerator), require_finite("mean_denominator", mean_denominator)
    s_z = require_not_negative("sigma_numerator", sigma_numerator)
    s_w = require_not_negative("sigma_denominator", sigma_denominator)
    rho = require_finite("correlation", correlation)
    for name, value in (("sigma_numerator", s_z), ("sigma_denominator", s_w)):
        if (value == 0).any():
            raise InputError("must be positive", key=name, got=value)
    if (np.abs(rho) >= 1).any():
        raise InputError("must lie inside (-1, 1)", key="correlation", got=correlation)
    q = np.sqrt((1 - rho) * (1 + rho))
    a, b = (z / s_z - rho * w / s_w) / q, w / s_w
    sign = np.where(np.where(a < 0, -1, 1) == np.where(b < 0, -1, 1), 1.0, -1.0)
    parts = np.broadcast_arrays(np.abs(a), np.abs(b), sign * s_w / (s_z * q), rho * s_z / s_w)
    return MarsagliaForm(*(np.asarray(part) for part in parts))
