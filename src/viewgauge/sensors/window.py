"""Rectangles of pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .camera import Camera

__all__ = ["Window"]


@dataclass(frozen=True)
class Window:
    """Pixels ``left`` to ``right - 1`` and ``top`` to ``bottom - 1`` of an image."""

    left: int
    top: int
    right: int
    bottom: int

    @classmethod
    def whole(cls, camera: Camera) -> Window:
        """All of a camera's image."""
        return cls(0, 0, *camera.resolution)

    @classmethod
    def around(cls, places_px: ArrayLike, reach_px: float, camera: Camera) -> Window | None:
        """What lies within reach of places ``(n, 2)`` px, in the image; None where nothing does."""
        places = np.asarray(places_px, dtype=float).reshape(-1, 2)
        left, top = np.floor(places.min(axis=0) - reach_px).astype(int).tolist()
        right, bottom = (np.ceil(places.max(axis=0) + reach_px).astype(int) + 1).tolist()
        window = cls(left, top, right, bottom).within(camera)
        return window if window.left < window.right and window.top < window.bottom else None

    def shrunk(self, pixels: int) -> Window:
        """Smaller on each side by so many pixels; empty where it is too small for that."""
        return Window(self.left + pixels, self.top + pixels, self.right - pixels, self.bottom - pixels)

    def within(self, camera: Camera) -> Window:
        """What of it lies in the image."""
        columns, rows = camera.resolution
        return Window(max(self.left, 0), max(self.top, 0), min(self.right, columns), min(self.bottom, rows))

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an image with."""
        return slice(self.top, max(self.bottom, self.top)), slice(self.left, max(self.right, self.left))
