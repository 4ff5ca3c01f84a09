"""How far from the principal point a lens shows directions one by one: up to where its distortion turns back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....geometry import Lens

__all__ = ["LensReach", "corner_distance", "lens_reach"]

_STEPS = 20_000
_WIDEST_TANGENT = 30.0  # 88 deg from the axis


@dataclass(frozen=True)
class LensReach:
    """Up to where a lens can be used.

    Parameters
    ----------
    turns_back_at
        Distance from the principal point in the image, as a tangent, at which the lens turns back; infinite where it
        does not.
    corner
        Distance of the farthest corner of the image, as a tangent.
    corner_angle_rad
        Angle of that corner from the optical axis; NaN where the lens does not reach it.
    """

    turns_back_at: float
    corner: float
    corner_angle_rad: float

    @property
    def share(self) -> float:
        """Share of the corner's distance that can be used; 1 for the whole image."""
        return min(self.turns_back_at / self.corner, 1.0)


def corner_distance(
    focal_length_px: tuple[float, float], principal_point_px: tuple[float, float], resolution: tuple[int, int]
) -> float:
    """Distance of the farthest corner of the image from the principal point, as a tangent."""
    columns, rows = resolution
    corners = np.array([[u, v] for u in (-0.5, columns - 0.5) for v in (-0.5, rows - 0.5)])
    seen = (corners - np.asarray(principal_point_px)) / np.asarray(focal_length_px)
    return float(np.linalg.norm(seen, axis=1).max())


def lens_reach(lens: Lens | None, corner: float) -> LensReach:
    """Up to where a lens can be used, from its radial part alone.

    Parameters
    ----------
    corner
        Distance of the farthest corner, as :func:`corner_distance` gives it.
    """
    if lens is None:
        return LensReach(math.inf, corner, math.atan(corner))
    if lens.model == "equidistant":
        angle = np.linspace(0.0, math.pi, _STEPS)
        powers = np.stack([angle**power for power in (3, 5, 7, 9)])
        radius = angle + np.asarray(lens.coefficients) @ powers
        return _reach(angle, radius, corner)
    tangent = np.linspace(0.0, _WIDEST_TANGENT, _STEPS)
    k1, k2, _, _, k3, k4, k5, k6 = (*lens.coefficients, *(0.0,) * 8)[:8]
    square = tangent**2
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        below = 1 + square * (k4 + square * (k5 + square * k6))
        radius = np.where(below > 0, tangent * (1 + square * (k1 + square * (k2 + square * k3))) / below, -1.0)
    return _reach(np.arctan(tangent), radius, corner)


def _reach(angle: NDArray[np.float64], radius: NDArray[np.float64], corner: float) -> LensReach:
    falls = np.flatnonzero(~(np.diff(radius) > 0))
    last = int(falls[0]) if len(falls) else len(radius) - 1
    turns_back_at = float(radius[last]) if len(falls) else math.inf
    reached = corner <= radius[last]
    return LensReach(
        turns_back_at, corner, float(np.interp(corner, radius[: last + 1], angle[: last + 1])) if reached else math.nan
    )
