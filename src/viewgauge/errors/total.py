"""Total error of a segment's length: displacement plus quantization (paper, eq. 18-19)."""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from .joint.closed_form import central_probability, mean_absolute, total_cdf, total_pdf
from .law import Law, require_not_negative
from .quantization import SpatialQuantization

_Total = TypeVar("_Total", bound=Law, covariant=True)

__all__ = ["TotalError"]


class _Displacement(Protocol[_Total]):
    def plus_quantization(self, pixel_pitch_mm: ArrayLike) -> _Total: ...


class TotalError(Law):
    """Normal displacement error plus spatial quantization error of a segment's image length.

    The convolution (eq. 19) of N(0, sigma) with the quantization law in closed form, right for every angle and
    every ratio of displacement to pixel: zero displacement, zero pixel, and both zero (then the error is 0).

    Parameters
    ----------
    sigma_displacement_mm
        Standard deviation of the displacement error, mm on the image.
    pixel_pitch_mm
        Quantization step: one number, or ``(..., 2)`` for width and height, mm.
    angle_rad
        Direction gamma of the imaged segment from +u, rad.

    Raises
    ------
    InputError
        If a standard deviation or a pitch is negative, or a parameter is not finite.
    """

    def __init__(self, sigma_displacement_mm: ArrayLike, pixel_pitch_mm: ArrayLike, angle_rad: ArrayLike) -> None:
        self.sigma_displacement_mm = require_not_negative("sigma_displacement_mm", sigma_displacement_mm)
        self.quantization = SpatialQuantization(pixel_pitch_mm, angle_rad)

    @classmethod
    def of_half_widths(cls, sigma: ArrayLike, half_widths: ArrayLike) -> TotalError:
        """The law with a normal error and the half-widths ``(..., 2)`` of the two triangular errors of quantization."""
        law = cls(sigma, 0.0, 0.0)
        law.quantization = SpatialQuantization.of_half_widths(half_widths)
        return law

    @staticmethod
    def of(displacement: _Displacement[_Total], pixel_pitch_mm: ArrayLike) -> _Total:
        """Total error of a displacement law of either model: closed form for joint, by series for independent."""
        return displacement.plus_quantization(pixel_pitch_mm)

    @property
    def _parameters(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        return self.sigma_displacement_mm, self.quantization.half_width_u, self.quantization.half_width_v

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x (eq. 19)."""
        return total_pdf(x, *self._parameters)

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x)."""
        return total_cdf(x, *self._parameters)

    def central_probability(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(|error| <= x): with x = T L it is Pr{Accuracy >= 1 - T} (eq. 20)."""
        return central_probability(x, *self._parameters)

    def mean(self) -> NDArray[np.float64]:
        """Zero."""
        return np.zeros(np.broadcast_shapes(*(p.shape for p in self._parameters)))

    def var(self) -> NDArray[np.float64]:
        """Sum of the displacement's and the quantization's variance."""
        return np.asarray(self.sigma_displacement_mm**2 + self.quantization.var())

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line, or the quantization's range where there is no displacement."""
        low, high = self.quantization.support()
        unbounded = self.sigma_displacement_mm > 0
        return np.where(unbounded, -np.inf, low), np.where(unbounded, np.inf, high)

    def mean_absolute(self) -> NDArray[np.float64]:
        """E|error|, in closed form: the expected accuracy (eq. 20) is 1 - E|error| / L."""
        return mean_absolute(*self._parameters)

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Draws of the normal and the four uniform errors."""
        rng = np.random.default_rng(random_state)
        shape = self.var().shape if size is None else size
        return np.asarray(self.sigma_displacement_mm * rng.standard_normal(shape) + self.quantization.rvs(shape, rng))

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        _, reach = self.quantization.support()
        centre = self.sigma_displacement_mm * ndtri(q)
        return np.asarray(centre - reach), np.asarray(centre + reach)
