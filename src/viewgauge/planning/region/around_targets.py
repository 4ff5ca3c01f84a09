"""The distances and directions from the points that are aimed at, within which candidates are sampled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .box_distances import box_distances
from .protocol import eyes_of

__all__ = ["AroundTargets"]

_ROUNDING = 1e-9
"""Relative, of distances and angles: a candidate at the very end of the range is allowed."""


@dataclass(frozen=True, eq=False)
class AroundTargets:
    """The poses whose eye has, from some target, a distance in a range and a direction in a cone.

    Parameters
    ----------
    targets
        ``(t, 3)`` mm: points that may be aimed at.
    distance_mm
        Nearest and farthest.
    cone_axis, cone_half_angle_rad
        The cone of directions from a target to the eye.
    """

    targets: NDArray[np.float64]
    distance_mm: tuple[float, float]
    cone_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    cone_half_angle_rad: float = np.pi

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: the farthest distance beyond the outermost targets."""
        _, far = self._range
        return np.stack([self.targets.min(axis=0) - far, self.targets.max(axis=0) + far])

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether the eyes of poses ``(n, 4, 4)`` mm are around some target."""
        eyes = eyes_of(T_part_camera)
        (near, far), axis = self._range, self._axis
        cosine = np.cos(self.cone_half_angle_rad)
        found = np.zeros(len(eyes), dtype=bool)
        for target in self.targets:
            offset = eyes - target
            distance = np.linalg.norm(offset, axis=1)
            found |= (distance >= near) & (distance <= far) & (offset @ axis >= (cosine - _ROUNDING) * distance)
        return found

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: False only where no point of the box between corners ``(n, 3)`` mm is around a target."""
        (near, far), axis = self._range, self._axis
        middle, radius = (low + high) / 2, np.linalg.norm(high - low, axis=1) / 2
        around = np.zeros(len(low), dtype=bool)
        for target in self.targets:
            nearest, farthest = box_distances(target, low, high)
            offset = middle - target
            distance = np.linalg.norm(offset, axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                angle = np.arccos(np.clip((offset @ axis) / distance, -1, 1))
                spread = np.arcsin(np.minimum(radius / distance, 1))
            cone = (distance <= radius) | (angle - spread <= self.cone_half_angle_rad + 1e-6)
            around |= (nearest <= far) & (farthest >= near) & cone
        return around

    @property
    def _range(self) -> tuple[float, float]:
        return self.distance_mm[0] * (1 - _ROUNDING), self.distance_mm[1] * (1 + _ROUNDING)

    @property
    def _axis(self) -> NDArray[np.float64]:
        return np.asarray(np.asarray(self.cone_axis) / np.linalg.norm(self.cone_axis))
