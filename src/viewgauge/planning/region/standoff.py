"""A least distance of the camera from the part's surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .clearance import Clearance
from .protocol import UNLIMITED, Region, RegionMember, Workpiece, eyes_of

__all__ = ["Standoff"]


@dataclass(frozen=True)
class Standoff(RegionMember):
    """The camera has to be outside the part, at least ``distance_mm`` from its surface; 0 keeps it out of the part."""

    key: ClassVar[str] = "standoff"
    outside: ClassVar[str] = "nearer than the standoff"
    clears_part: ClassVar[bool] = True

    distance_mm: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.distance_mm) and self.distance_mm >= 0):
            raise InputError("must be finite and not negative", key=self.key, got=self.distance_mm)

    def region(self, workpiece: Workpiece) -> Region:
        """The poses whose eye is far enough from the surface, and outside the part."""
        return _FromSurface(Clearance(workpiece.mesh), self.distance_mm)


@dataclass(frozen=True, eq=False)
class _FromSurface:
    """The standoff from the surface of a part that is known."""

    clearance: Clearance
    distance_mm: float

    @property
    def bounds(self) -> NDArray[np.float64]:
        return UNLIMITED

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        eyes = eyes_of(T_part_camera)
        # poses that differ in the rotation alone follow each other: their eye is measured once
        fresh = np.append(True, (eyes[1:] != eyes[:-1]).any(axis=1)) if len(eyes) else np.zeros(0, dtype=bool)
        return np.asarray(~self.clearance.too_near(eyes[fresh], self.distance_mm)[np.cumsum(fresh) - 1])

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        return ~self.clearance.all_too_near(low, high, self.distance_mm)
