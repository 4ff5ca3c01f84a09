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
        places, (columns, rows) = np.asarray(places_px, dtype=float).reshape(-1, 2), camera.resolution
        low = np.floor(places.min(axis=0) - reach_px).astype(int)
        high = np.ceil(places.max(axis=0) + reach_px).astype(int) + 1
        left, top, right, bottom = max(low[0], 0), max(low[1], 0), min(high[0], columns), min(high[1], rows)
        return cls(int(left), int(top), int(right), int(bottom)) if left < right and top < bottom else None

    def shrunk(self, pixels: int) -> Window:
        """Smaller on each side by so many pixels; empty where it is too small for that."""
        return Window(self.left + pixels, self.top + pixels, self.right - pixels, self.bottom - pixels)

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns, to index an image with."""
        return slice(self.top, max(self.bottom, self.top)), slice(self.left, max(self.right, self.left))
