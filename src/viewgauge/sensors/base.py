"""The protocol that every sensor fulfils: where it shows points, how that changes with its pose, and what it sees."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Sensor"]


@runtime_checkable
class Sensor(Protocol):
    """What forms an image of points, in its own frame: optical, x right, y down, z forward, mm.

    Points of the scene have an ideal image, mm, in which lengths are measured, and a place in the pixels, px, where
    they are found; (0, 0) is the centre of the top-left pixel. A small pose error [x, y, z, rx, ry, rz], mm and rad,
    displaces the scene in the sensor's frame, ``p' = p + delta x p + d``; one that acts in another frame is brought
    there by :attr:`PoseError.adjoint`.
    """

    @property
    def resolution(self) -> tuple[int, int]:
        """Columns and rows, px."""
        ...

    @property
    def border_px(self) -> NDArray[np.float64]:
        """``(n, 2)`` px: points around the border of the image."""
        ...

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2)`` mm: ideal image of points ``(..., 3)`` mm; NaN where a point has no image."""
        ...

    def to_pixels(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2)`` px: where the sensor shows ideal image points ``(..., 2)`` mm."""
        ...

    def from_pixels(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2)`` mm: ideal image points of places ``(..., 2)`` px; NaN where the sensor shows nothing."""
        ...

    def pixel_jacobian(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 2)`` px/mm: derivative of :meth:`to_pixels`."""
        ...

    def pose_jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 6)``: derivative of :meth:`project` with respect to a pose error at points ``(..., 3)`` mm.

        Columns are mm/mm for translations and mm/rad for rotations; NaN where a point has no image.
        """
        ...

    def pose_jacobian_px(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 6)`` px/mm and px/rad: the same for the point's place in the pixels."""
        ...

    def lines_of_sight(self, pixels: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The lines of points that are shown at places ``(..., 2)`` px.

        Returns
        -------
        A point of each line, ``(..., 3)`` mm, and its unit direction away from the sensor, ``(..., 3)``; directions
        are NaN where the sensor shows nothing.
        """
        ...
