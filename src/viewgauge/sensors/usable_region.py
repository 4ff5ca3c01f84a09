"""The part of the image that is used: inside an image circle, or a polygon."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError

__all__ = ["ImageCircle", "ImagePolygon", "UsableRegion", "depth_in_region", "depths_in_region"]


class UsableRegion(Protocol):
    """A region of the image, px."""

    @property
    def parameters(self) -> NDArray[np.float64]:
        """For compiled code (:func:`depth_in_region`): a circle's column, row and radius, or a polygon's corners."""
        ...

    def scaled(self, factor: float) -> UsableRegion:
        """The same region of a sensor whose pixels are larger by a factor."""
        ...


@dataclass(frozen=True)
class ImageCircle:
    """The inside of a circle, such as the image circle of a lens that is smaller than the sensor."""

    centre_px: tuple[float, float]
    radius_px: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.centre_px).all() and math.isfinite(self.radius_px) and self.radius_px > 0):
            raise InputError("not a circle", key="usable_region", got=f"radius {self.radius_px} px")

    @property
    def parameters(self) -> NDArray[np.float64]:
        """``(3,)``."""
        return np.array([*self.centre_px, self.radius_px], dtype=float)

    def scaled(self, factor: float) -> ImageCircle:
        """The same circle of a sensor whose pixels are larger by a factor."""
        u, v = self.centre_px
        return ImageCircle(((u + 0.5) / factor - 0.5, (v + 0.5) / factor - 0.5), self.radius_px / factor)


@dataclass(frozen=True)
class ImagePolygon:
    """The inside of a polygon, by its corners in order."""

    corners_px: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        corners = np.asarray(self.corners_px, dtype=float)
        if corners.ndim != 2 or corners.shape[0] < 3 or corners.shape[1] != 2 or not np.isfinite(corners).all():
            raise InputError("not a polygon", key="usable_region", expected="at least three corners, column and row")
        if self.area_px2 < 1:
            raise InputError("the polygon has no area", key="usable_region", got=corners.tolist())

    @property
    def area_px2(self) -> float:
        """Its area, px²; that of the shoelace formula."""
        x, y = np.asarray(self.corners_px, dtype=float).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2

    @property
    def parameters(self) -> NDArray[np.float64]:
        """``(2 n,)``, n >= 3."""
        return np.asarray(self.corners_px, dtype=float).ravel()

    def scaled(self, factor: float) -> ImagePolygon:
        """The same polygon of a sensor whose pixels are larger by a factor."""
        return ImagePolygon(tuple(((u + 0.5) / factor - 0.5, (v + 0.5) / factor - 0.5) for u, v in self.corners_px))


@numba.njit(error_model="numpy")
def depth_in_region(region, u, v):  # type: ignore[no-untyped-def]
    """How far inside a region a place of the image lies, px; negative outside; infinite where there is no region."""
    if len(region) == 0:
        return math.inf
    if len(region) == 3:
        return region[2] - math.hypot(u - region[0], v - region[1])
    inside, nearest, n = False, math.inf, len(region) // 2
    for k in range(n):
        x1, y1 = region[2 * k], region[2 * k + 1]
        x2, y2 = region[2 * ((k + 1) % n)], region[2 * ((k + 1) % n) + 1]
        if (y1 > v) != (y2 > v) and u < x1 + (v - y1) / (y2 - y1) * (x2 - x1):
            inside = not inside
        dx, dy = x2 - x1, y2 - y1
        length = dx * dx + dy * dy
        t = min(max(((u - x1) * dx + (v - y1) * dy) / length, 0.0), 1.0) if length > 0.0 else 0.0
        nearest = min(nearest, math.hypot(u - x1 - t * dx, v - y1 - t * dy))
    return nearest if inside else -nearest


@numba.njit("void(float64[::1], float64[:,::1], float64[::1])", cache=True, nogil=True, error_model="numpy")
def _depths(region, places, out):  # type: ignore[no-untyped-def]
    for k in range(len(places)):
        out[k] = depth_in_region(region, places[k, 0], places[k, 1])


def depths_in_region(region: UsableRegion, pixels: ArrayLike) -> NDArray[np.float64]:
    """``(...)`` px: how far inside a region places ``(..., 2)`` px lie; negative outside."""
    places = np.asarray(pixels, dtype=float)
    out = np.empty(places.size // 2)
    _depths(region.parameters, np.ascontiguousarray(places.reshape(-1, 2)), out)
    return out.reshape(places.shape[:-1])
