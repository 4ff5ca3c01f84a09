"""The allowed region: what all of several conditions allow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .protocol import UNLIMITED, Region

__all__ = ["AllowedRegion"]


@dataclass(frozen=True, eq=False)
class AllowedRegion:
    """The poses that every member allows; each member is asked only about what those before it allow."""

    members: tuple[Region, ...]

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: no allowed eye is outside; where low is above high there is none."""
        each = np.array([UNLIMITED, *(member.bounds for member in self.members)])
        return np.stack([each[:, 0].max(axis=0), each[:, 1].min(axis=0)])

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether every member allows poses ``(n, 4, 4)`` mm."""
        T_part_camera = np.asarray(T_part_camera, dtype=float)
        left = np.ones(len(T_part_camera), dtype=bool)
        for member in self.members:
            left[left] = member.allows(T_part_camera[left])
        return left

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: False only where some member allows no pose with the eye between corners ``(n, 3)`` mm."""
        left = np.ones(len(low), dtype=bool)
        for member in self.members:
            left[left] = member.possible(low[left], high[left])
        return left
