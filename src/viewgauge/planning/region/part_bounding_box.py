"""Outside the part's bounding box: where the camera is allowed if no standoff from the surface is given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .protocol import UNLIMITED, Region, RegionMember, Workpiece, eyes_of

__all__ = ["OutsidePartBoundingBox"]


@dataclass(frozen=True)
class OutsidePartBoundingBox(RegionMember):
    """The camera has to be outside the part's bounding box. It has no key: it holds where nothing else clears the
    part.
    """

    key: ClassVar[str] = ""
    outside: ClassVar[str] = "inside the part's bounding box"
    clears_part: ClassVar[bool] = True

    def region(self, workpiece: Workpiece) -> Region:
        """The poses whose eye is neither in the bounding box nor on its border."""
        return _Outside(*workpiece.mesh.bounds)


@dataclass(frozen=True, eq=False)
class _Outside:
    """Outside the box between corners ``(3,)`` mm."""

    lowest: NDArray[np.float64]
    highest: NDArray[np.float64]

    @property
    def bounds(self) -> NDArray[np.float64]:
        return UNLIMITED

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        eyes = eyes_of(T_part_camera)
        return np.asarray(~((eyes >= self.lowest) & (eyes <= self.highest)).all(axis=1))

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        return np.asarray(~((low >= self.lowest) & (high <= self.highest)).all(axis=1))
