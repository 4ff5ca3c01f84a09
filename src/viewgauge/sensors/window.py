"""Rectangles of pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .base import Sensor

__all__ = ["Window"]


@dataclass(frozen=True)
class Window:
    """Pixels ``left`` to ``right - 1`` and ``top`` to ``bottom - 1`` of an image."""

    left: int
    top: int
    right: int
    bottom: int

    @classmethod
    def whole(cls, sensor: Sensor) -> Window:
        """The whole image of a sensor."""
        return cls(0, 0, *sensor.resolution)

    @classmethod
    def around(cls, places_px: ArrayLike, reach_px: float, sensor: Sensor) -> Window | None:
        """The pixels within reach of places ``(n, 2)`` px that lie in the image; None where none do."""
        places = np.asarray(places_px, dtype=float).reshape(-1, 2)
        left, top = np.floor(places.min(axis=0) - reach_px).astype(int).tolist()
        right, bottom = (np.ceil(places.max(axis=0) + reach_px).astype(int) + 1).tolist()
        window = cls(left, top, right, bottom).within(sensor)
        return window if window.left < window.right and window.top < window.bottom else None

    def shrunk(self, pixels: int) -> Window:
        """The window without so many pixels on each side; empty where it is too small for that."""
        return Window(self.left + pixels, self.top + pixels, self.right - pixels, self.bottom - pixels)

    def within(self, sensor: Sensor) -> Window:
        """The part of the window that lies in the image."""
        columns, rows = sensor.resolution
        return Window(max(self.left, 0), max(self.top, 0), min(self.right, columns), min(self.bottom, rows))

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an image with."""
        return slice(self.top, max(self.bottom, self.top)), slice(self.left, max(self.right, self.left))
