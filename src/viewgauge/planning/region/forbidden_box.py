"""A box in which the camera must not be, such as a clamp; it blocks no line of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .box import Corner, require_corners
from .protocol import UNLIMITED, Region, RegionMember, Workpiece, eyes_of

__all__ = ["ForbiddenBox"]


@dataclass(frozen=True)
class ForbiddenBox(RegionMember):
    """A box in which the camera must not be: its lowest and highest corner, mm, part frame."""

    key: ClassVar[str] = "forbidden"
    outside: ClassVar[str] = "in a forbidden box"

    lowest: Corner
    highest: Corner

    def __post_init__(self) -> None:
        require_corners(self.key, self.lowest, self.highest)

    def region(self, workpiece: Workpiece) -> Region:  # noqa: ARG002 # the same around any part
        """The poses whose eye is outside the box or on its border."""
        return self

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: what lies outside a box has no bounds."""
        return UNLIMITED

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether the eyes of poses ``(n, 4, 4)`` mm are outside the box or on its border."""
        eyes = eyes_of(T_part_camera)
        return np.asarray(~((eyes > self.lowest) & (eyes < self.highest)).all(axis=1))

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether boxes between corners ``(n, 3)`` mm are not wholly inside this one."""
        return np.asarray(~((low > self.lowest) & (high < self.highest)).all(axis=1))
