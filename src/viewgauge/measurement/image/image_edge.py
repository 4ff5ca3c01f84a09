"""An edge that was found in an image: a straight or slightly bent line of pixels, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["BIAS_PX", "ImageEdge"]

BIAS_PX = 0.02
"""Standard uncertainty of where a clear edge is beside noise, px: pixels sample, and shading is not straight."""


@dataclass(frozen=True)
class ImageEdge:
    """A curve ``offset(t) = a + b t + c t²`` px across the expected direction, t px along it from the expected point.

    Parameters
    ----------
    point, along
        ``(2,)`` px: the expected point and direction.
    coefficients
        a, b, c.
    covariance
        ``(3, 3)`` of them, by the image's noise and :data:`BIAS_PX`.
    width_px
        Standard deviation of the blur, the pixel's own included; of wide blurs less.
    contrast
        Step of grey values across the edge, share of full scale.
    """

    point: NDArray[np.float64]
    along: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    covariance: NDArray[np.float64]
    width_px: float
    contrast: float

    @property
    def across(self) -> NDArray[np.float64]:
        """``(2,)``: to the left of ``along`` by a right angle."""
        return np.array([-self.along[1], self.along[0]])

    def variance_at(self, place: NDArray[np.float64]) -> float:
        """Of the edge across it, px², next to a place ``(2,)`` px."""
        t = float((place - self.point) @ self.along)
        powers = np.array([1.0, t, t * t])
        return float(powers @ self.covariance @ powers)

    def meets(self, point: NDArray[np.float64], direction: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Where a line through a point meets the edge, nearest to the expected point; None where it does not."""
        a, b, c = self.coefficients
        start = np.array([(point - self.point) @ self.along, (point - self.point) @ self.across])
        run = np.array([direction @ self.along, direction @ self.across])
        # across = a + b t + c t² with t = start0 + s run0
        quadratic = c * run[0] ** 2
        linear = b * run[0] + 2 * c * start[0] * run[0] - run[1]
        constant = a + b * start[0] + c * start[0] ** 2 - start[1]
        if abs(quadratic) < 1e-12:
            roots = [] if abs(linear) < 1e-12 else [-constant / linear]
        else:
            inside = linear**2 - 4 * quadratic * constant
            root = np.sqrt(inside) if inside >= 0 else np.nan
            roots = [(-linear + sign * root) / (2 * quadratic) for sign in (1, -1)] if inside >= 0 else []
        if not roots:
            return None
        places = [point + s * direction for s in roots]
        return np.asarray(min(places, key=lambda p: float(np.linalg.norm(p - self.point))))
