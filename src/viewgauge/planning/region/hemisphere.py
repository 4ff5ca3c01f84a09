"""One side of a plane, as far as a radius, such as above the table and within an arm's length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .box_distances import box_distances
from .protocol import Region, RegionMember, Workpiece, eyes_of

__all__ = ["Hemisphere"]


@dataclass(frozen=True)
class Hemisphere(RegionMember):
    """One side of a plane, as far as a radius from a point of it, where the camera has to be.

    Parameters
    ----------
    centre
        mm, part frame; None for the middle of the measurands.
    axis
        From the plane to the side that is meant, part frame.
    radius_mm
        Infinite for the whole half-space.
    """

    key: ClassVar[str] = "hemisphere"
    outside: ClassVar[str] = "outside the hemisphere"

    centre: tuple[float, float, float] | None = None
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    radius_mm: float = float("inf")

    def __post_init__(self) -> None:
        if not 0 < np.linalg.norm(self.axis) < np.inf:
            raise InputError("the axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        if not self.radius_mm > 0:
            raise InputError("the radius must be positive", key="radius_mm", got=self.radius_mm)
        if self.centre is not None and not np.isfinite(self.centre).all():
            raise InputError("the centre is no point", key="centre", got=list(self.centre))

    def region(self, workpiece: Workpiece) -> Region:
        """The poses whose eye is on the side of the plane, not farther from the centre than the radius."""
        centre = workpiece.middle_mm if self.centre is None else np.asarray(self.centre)
        return _Placed(centre, np.asarray(self.axis) / np.linalg.norm(self.axis), self.radius_mm)


@dataclass(frozen=True, eq=False)
class _Placed:
    """A hemisphere whose centre ``(3,)`` mm is known; the axis ``(3,)`` has unit length."""

    centre: NDArray[np.float64]
    axis: NDArray[np.float64]
    radius_mm: float

    @property
    def bounds(self) -> NDArray[np.float64]:
        return np.stack([self.centre - self.radius_mm, self.centre + self.radius_mm])

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        offset = eyes_of(T_part_camera) - self.centre
        return np.asarray((offset @ self.axis >= 0) & (np.linalg.norm(offset, axis=1) <= self.radius_mm))

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        nearest, _ = box_distances(self.centre, low, high)
        highest = np.where(self.axis > 0, high - self.centre, low - self.centre) @ self.axis
        return np.asarray((highest >= 0) & (nearest <= self.radius_mm))
