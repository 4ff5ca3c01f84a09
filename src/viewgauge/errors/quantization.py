"""Spatial quantization error of a segment's length (paper, eq. 1-3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from .joint.closed_form import total_cdf, total_pdf
from .law import Law, require_finite, require_not_negative

__all__ = ["SpatialQuantization", "quantization_half_widths"]


def quantization_half_widths(
    pixel_pitch_mm: ArrayLike, angle_rad: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Half-widths a = r_x |cos gamma|, b = r_y |sin gamma| of the two triangular errors, unit of the pitch.

    ``pixel_pitch_mm`` is one number for square pixels or ``(..., 2)`` for width and height.
    """
    pitch = require_not_negative("pixel_pitch_mm", pixel_pitch_mm)
    if pitch.ndim > 0 and pitch.shape[-1] != 2:
        raise InputError(
            "must be one number or have width and height in its last axis",
            key="pixel_pitch_mm",
            got=f"shape {pitch.shape}",
            expected="shape () or (..., 2)",
        )
    width, height = (pitch, pitch) if pitch.ndim == 0 else (pitch[..., 0], pitch[..., 1])
    angle = require_finite("angle_rad", angle_rad)
    return np.abs(width * np.cos(angle)), np.abs(height * np.sin(angle))


class SpatialQuantization(Law):
    """Error of an image segment's length when each end is located to a whole pixel.

    eps_q = cos(gamma) eps_x + sin(gamma) eps_y (eq. 1), each of eps_x, eps_y the difference of two uniform errors,
    that is triangular (eq. 2). The pdf (eq. 3) and cdf are piecewise polynomials, evaluated without
    cancellation at every angle.

    Parameters
    ----------
    pixel_pitch_mm
        Quantization step: one number, or ``(..., 2)`` for width and height, mm (any unit; the error is in it).
    angle_rad
        Direction gamma of the imaged segment from +u, rad.

    Raises
    ------
    InputError
        If a pitch is negative, or a parameter is not finite.
    """

    def __init__(self, pixel_pitch_mm: ArrayLike, angle_rad: ArrayLike) -> None:
        self.half_width_u, self.half_width_v = quantization_half_widths(pixel_pitch_mm, angle_rad)

    @classmethod
    def of_half_widths(cls, half_widths: ArrayLike) -> SpatialQuantization:
        """The law with the half-widths ``(..., 2)`` of the two triangular errors, where they are known already."""
        law = cls(0.0, 0.0)
        widths = require_not_negative("half_widths", half_widths)
        law.half_width_u, law.half_width_v = widths[..., 0], widths[..., 1]
        return law

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x (eq. 3)."""
        return total_pdf(x, 0.0, self.half_width_u, self.half_width_v)

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x)."""
        return total_cdf(x, 0.0, self.half_width_u, self.half_width_v)

    def mean(self) -> NDArray[np.float64]:
        """Zero."""
        return np.zeros(np.broadcast_shapes(self.half_width_u.shape, self.half_width_v.shape))

    def var(self) -> NDArray[np.float64]:
        """(cos² gamma r_x² + sin² gamma r_y²) / 6."""
        return np.asarray((self.half_width_u**2 + self.half_width_v**2) / 6)

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """±(r_x |cos gamma| + r_y |sin gamma|)."""
        reach = np.asarray(self.half_width_u + self.half_width_v)
        return -reach, reach

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Draws from the four uniform errors themselves."""
        rng = np.random.default_rng(random_state)
        shape = self.var().shape if size is None else size
        u = rng.random((4, *np.atleast_1d(np.asarray(shape, dtype=int)))) if shape != () else rng.random(4)
        return np.asarray(self.half_width_u * (u[0] - u[1]) + self.half_width_v * (u[2] - u[3]))

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        low, high = self.support()
        return np.broadcast_arrays(low + 0 * q, high + 0 * q)  # type: ignore[return-value] # a tuple of two
