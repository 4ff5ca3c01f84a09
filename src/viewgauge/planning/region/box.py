"""A box in which the camera has to be, such as what a gantry reaches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .protocol import Region, RegionMember, Workpiece, eyes_of

__all__ = ["Box", "Corner", "require_corners"]

Corner = tuple[float, float, float]


def require_corners(key: str, lowest: Corner, highest: Corner) -> None:
    """Raise InputError unless each coordinate of the lowest corner is below that of the highest."""
    if not (np.isfinite([lowest, highest]).all() and (np.asarray(lowest) < np.asarray(highest)).all()):
        raise InputError(
            "a box needs its lowest corner first, each coordinate below that of the highest",
            key=key,
            got=f"{list(lowest)} to {list(highest)} mm",
        )


@dataclass(frozen=True)
class Box(RegionMember):
    """A box in which the camera has to be: its lowest and highest corner, mm, part frame."""

    key: ClassVar[str] = "box"
    outside: ClassVar[str] = "outside the box"

    lowest: Corner
    highest: Corner

    def __post_init__(self) -> None:
        require_corners(self.key, self.lowest, self.highest)

    def region(self, workpiece: Workpiece) -> Region:  # noqa: ARG002 # the same around any part
        """The poses whose eye is in the box or on its border."""
        return self

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: the corners."""
        return np.array([self.lowest, self.highest])

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether the eyes of poses ``(n, 4, 4)`` mm are in the box."""
        eyes = eyes_of(T_part_camera)
        low, high = self.bounds
        return np.asarray(((eyes >= low) & (eyes <= high)).all(axis=1))

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether boxes between corners ``(n, 3)`` mm meet this one."""
        lowest, highest = self.bounds
        return np.asarray(((high >= lowest) & (low <= highest)).all(axis=1))
