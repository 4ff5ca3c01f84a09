"""Where the camera may stand: what the robot reaches, what is forbidden, and how near to the part it may come."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...part import Mesh
from .clearance import Clearance

__all__ = ["Hemisphere", "Region"]

_ROUNDING = 1e-9
"""Relative, of distances and angles: a candidate at the very end of the range is allowed."""


@dataclass(frozen=True)
class Hemisphere:
    """One side of a plane, as far as a radius.

    Parameters
    ----------
    centre
        mm, part frame; None for the middle of the measurands.
    axis
        From the plane to the side that is meant, part frame.
    radius_mm
        Infinite for the whole half-space.
    """

    centre: tuple[float, float, float] | None = None
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    radius_mm: float = float("inf")


@dataclass(frozen=True, eq=False)
class Region:
    """Where the centre of projection may stand, part frame; the camera may look wherever it likes.

    Parameters
    ----------
    targets
        ``(t, 3)`` mm: points that may be aimed at.
    distance_mm, cone_axis, cone_half_angle_rad
        From some target a position has to have a distance in this range, in a direction in this cone.
    box
        ``(2, 3)`` mm: lowest and highest corner of a box in which it has to be.
    hemisphere
        With its centre given.
    forbidden
        ``(k, 2, 3)`` mm: boxes in which it must not be (they block no line of sight).
    mesh, standoff_mm
        The part; with a standoff a position has to be outside and at least so far from the surface. Without, it has to
        be outside the part's bounding box.
    """

    targets: NDArray[np.float64]
    distance_mm: tuple[float, float]
    mesh: Mesh
    cone_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    cone_half_angle_rad: float = np.pi
    box: NDArray[np.float64] | None = None
    hemisphere: Hemisphere | None = None
    forbidden: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2, 3)))
    standoff_mm: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "_axis", np.asarray(self.cone_axis) / np.linalg.norm(self.cone_axis))
        object.__setattr__(self, "_clearance", Clearance(self.mesh))

    def allowed(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether the camera may stand at points ``(n, 3)`` mm."""
        points = np.asarray(points, dtype=float)
        inside = self.in_reach(points)
        inside[inside] &= ~self.too_near(points[inside])
        inside[inside] &= self._around_target(points[inside])
        return inside

    def in_reach(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: inside the box and the hemisphere, and in no forbidden box."""
        inside = np.ones(len(points), dtype=bool)
        if self.box is not None:
            inside &= ((points >= self.box[0]) & (points <= self.box[1])).all(axis=1)
        if self.hemisphere is not None:
            centre, axis = self._half_space()
            offset = points - centre
            inside &= (offset @ axis >= 0) & (np.linalg.norm(offset, axis=1) <= self.hemisphere.radius_mm)
        for low, high in self.forbidden:
            inside &= ~((points > low) & (points < high)).all(axis=1)
        return inside

    def too_near(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: inside the part or nearer to it than the standoff; without one, in its bounding box."""
        if self.standoff_mm is None:
            low, high = self.mesh.bounds
            return np.asarray(((points >= low) & (points <= high)).all(axis=1))
        return self._clearance.too_near(points, self.standoff_mm)

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: False only where no point of the box between corners ``(n, 3)`` mm is allowed."""
        maybe = np.ones(len(low), dtype=bool)
        if self.box is not None:
            maybe &= ((high >= self.box[0]) & (low <= self.box[1])).all(axis=1)
        if self.hemisphere is not None:
            centre, axis = self._half_space()
            nearest, _ = _distances(centre, low, high)
            highest = np.where(axis > 0, high - centre, low - centre) @ axis
            maybe &= (highest >= 0) & (nearest <= self.hemisphere.radius_mm)
        for corner, opposite in self.forbidden:
            maybe &= ~((low > corner) & (high < opposite)).all(axis=1)
        if self.standoff_mm is None:
            corner, opposite = self.mesh.bounds
            maybe &= ~((low >= corner) & (high <= opposite)).all(axis=1)
        else:
            maybe[maybe] &= ~self._clearance.all_too_near(low[maybe], high[maybe], self.standoff_mm)
        around = np.zeros(len(low), dtype=bool)
        near, far = self.distance_mm[0] * (1 - _ROUNDING), self.distance_mm[1] * (1 + _ROUNDING)
        middle, radius = (low + high) / 2, np.linalg.norm(high - low, axis=1) / 2
        for target in self.targets:
            nearest, farthest = _distances(target, low, high)
            offset = middle - target
            distance = np.linalg.norm(offset, axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                angle = np.arccos(np.clip((offset @ self._axis) / distance, -1, 1))
                spread = np.arcsin(np.minimum(radius / distance, 1))
            cone = (distance <= radius) | (angle - spread <= self.cone_half_angle_rad + 1e-6)
            around |= (nearest <= far) & (farthest >= near) & cone
        return np.asarray(maybe & around)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: no allowed position is outside."""
        far = self.distance_mm[1] * (1 + _ROUNDING)
        low, high = self.targets.min(axis=0) - far, self.targets.max(axis=0) + far
        if self.box is not None:
            low, high = np.maximum(low, self.box[0]), np.minimum(high, self.box[1])
        if self.hemisphere is not None:
            centre, _ = self._half_space()
            low = np.maximum(low, centre - self.hemisphere.radius_mm)
            high = np.minimum(high, centre + self.hemisphere.radius_mm)
        return np.stack([low, high])

    def _half_space(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        assert self.hemisphere is not None
        centre = self.targets[0] if self.hemisphere.centre is None else np.asarray(self.hemisphere.centre)
        return centre, np.asarray(self.hemisphere.axis) / np.linalg.norm(self.hemisphere.axis)

    def _around_target(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        near, far = self.distance_mm[0] * (1 - _ROUNDING), self.distance_mm[1] * (1 + _ROUNDING)
        cosine = np.cos(self.cone_half_angle_rad)
        found = np.zeros(len(points), dtype=bool)
        for target in self.targets:
            offset = points - target
            distance = np.linalg.norm(offset, axis=1)
            found |= (distance >= near) & (distance <= far) & (offset @ self._axis >= (cosine - _ROUNDING) * distance)
        return found

    _axis: NDArray[np.float64] = field(init=False, repr=False)
    _clearance: Clearance = field(init=False, repr=False)


def _distances(
    point: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and greatest distance from a point to boxes."""
    nearest = np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0), axis=1)
    return nearest, np.linalg.norm(np.maximum(high - point, point - low), axis=1)
