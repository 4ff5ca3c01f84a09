"""Candidate viewpoints, sampled around the part."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from ...exceptions import NoCandidateError
from ...geometry import look_at
from ...part import Mesh
from ...sensors import Camera
from .candidate_options import CandidateOptions

__all__ = ["CandidateGrid", "default_distance_range", "spread_directions"]

_GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))

# Default distances, as multiples of the one at which all measurands just fill the narrower field of view: nearer
# views see fewer measurands, and those larger.
_DEFAULT_RANGE = (0.5, 1.25)
# With an aperture, as multiples of the focus distance.
_DEFAULT_RANGE_IN_FOCUS = (0.85, 1.15)


def spread_directions(
    count: int, axis: tuple[float, float, float] = (0.0, 0.0, 1.0), half_angle_rad: float = np.pi
) -> NDArray[np.float64]:
    """Unit vectors ``(count, 3)`` spread evenly over the sphere or the cap of a cone (Fibonacci lattice).

    References
    ----------
    González, *Math. Geosci.* 42 (2010) 49-64.
    """
    k = np.arange(count)
    height = 1 - (1 - np.cos(half_angle_rad)) * (k + 0.5) / count
    radius = np.sqrt(np.maximum(1 - height**2, 0.0))
    turn = k * _GOLDEN_ANGLE_RAD
    z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    x = np.cross(z, [1.0, 0.0, 0.0] if abs(z[0]) < 0.9 else [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    return np.asarray((radius * np.cos(turn))[:, None] * x + (radius * np.sin(turn))[:, None] * y + height[:, None] * z)


def default_distance_range(measurand_points: NDArray[np.float64], camera: Camera) -> tuple[float, float]:
    """(nearest, farthest) distance, mm, that suits measurands with these end points ``(n, 3)`` mm."""
    if camera.focus_distance_mm is not None:
        near, far = (factor * camera.focus_distance_mm for factor in _DEFAULT_RANGE_IN_FOCUS)
        return near, far
    centre = (measurand_points.min(axis=0) + measurand_points.max(axis=0)) / 2
    radius = float(np.linalg.norm(measurand_points - centre, axis=1).max())
    fitting = radius / np.sin(min(camera.half_field_of_view_rad))
    near, far = (factor * fitting for factor in _DEFAULT_RANGE)
    return near, far


class CandidateGrid:
    """Candidate camera poses around the part, made when they are asked for: their number costs no memory.

    Every combination of a point aimed at (the centre of the measurands and the centres of clusters of measurands), a
    distance, a direction and a roll. Poses whose camera would stand where it must not are left out.

    Parameters
    ----------
    measurand_points
        ``(g, 2, 3)`` mm: ends of the measurands, part frame.

    Raises
    ------
    NoCandidateError
        If none is left.
    """

    def __init__(
        self, measurand_points: NDArray[np.float64], mesh: Mesh, camera: Camera, options: CandidateOptions, seed: int
    ) -> None:
        near, far = options.distance_mm or default_distance_range(measurand_points.reshape(-1, 3), camera)
        self._targets = _targets(measurand_points, options.targets, seed)
        self._distances = np.geomspace(near, far, options.distances)
        if options.distances == 1:
            self._distances = np.array([np.sqrt(near * far)])
        self._directions = spread_directions(options.directions, options.cone_axis, options.cone_half_angle_rad)
        self._rolls = np.arange(options.rolls) * np.pi / options.rolls
        self._shape = tuple(len(a) for a in (self._targets, self._distances, self._directions))
        self.region = options.region(self._targets, (near, far), mesh)
        """Where a camera may stand; every candidate does."""
        self._inside = self._left_out(options.bounded)
        if not len(self):
            raise NoCandidateError(
                f"no candidate viewpoint is left: at distances of {near:.4g} to {far:.4g} mm {self._why_none()}"
            )

    def __len__(self) -> int:
        """Number of candidates."""
        return (math.prod(self._shape) - len(self._inside)) * len(self._rolls)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` ``(m, 4, 4)`` mm of candidates ``first`` to ``stop - 1``."""
        place, roll = np.divmod(np.arange(first, min(stop, len(self))), len(self._rolls))
        # the place-th of those that are not inside: each one inside before it moves it on by one
        place += np.searchsorted(self._inside - np.arange(len(self._inside)), place, side="right")
        aim, eyes = self._aim_and_eyes(place)
        return look_at(eyes, aim, self._rolls[roll])

    def _aim_and_eyes(self, place: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        target, distance, direction = np.unravel_index(place, self._shape)
        aim = self._targets[target]
        return aim, aim + self._distances[distance][:, None] * self._directions[direction]

    def _left_out(self, bounded: bool) -> NDArray[np.int64]:
        """Combinations of target, distance and direction whose camera must not stand there, ascending."""
        left_out = [np.zeros(0, np.int64)]
        corners = np.array(np.meshgrid(*self.region.mesh.bounds.T)).reshape(3, -1).T
        directions = len(self._directions)
        for k, (target, distance) in enumerate(itertools.product(self._targets, self._distances)):
            if not bounded and distance > np.linalg.norm(corners - target, axis=1).max():
                continue  # farther than any corner of the part's bounding box
            _, eyes = self._aim_and_eyes(np.arange(k * directions, (k + 1) * directions))
            excluded = self.region.too_near(eyes) | ~self.region.in_reach(eyes)
            left_out.append(k * directions + np.flatnonzero(excluded))
        return np.concatenate(left_out)

    def _why_none(self) -> str:
        """What stands in the way, and what to do."""
        _, eyes = self._aim_and_eyes(np.arange(math.prod(self._shape)))
        near, reach = self.region.too_near(eyes), self.region.in_reach(eyes)
        what = "inside the part's bounding box" if self.region.standoff_mm is None else "nearer than the standoff"
        if near.all():
            return f"every camera would be {what}; allow larger distances"
        if not reach.any():
            return "no camera would be where the box, the hemisphere and the forbidden boxes allow it; mend candidates"
        return (
            f"{near.mean():.0%} of the cameras would be {what}, {(~reach).mean():.0%} where the box, the hemisphere or "
            "a forbidden box does not allow it; allow more room or other distances"
        )


def _targets(measurand_points: NDArray[np.float64], clusters: int, seed: int) -> NDArray[np.float64]:
    """Points to aim at ``(1 + k, 3)`` mm: the middle of all measurands, and k centres of clusters of measurands."""
    ends = measurand_points.reshape(-1, 3)
    middle = np.asarray((ends.min(axis=0) + ends.max(axis=0)) / 2)
    midpoints = np.unique(measurand_points.mean(axis=1).round(9), axis=0)
    k = min(clusters, len(midpoints))
    if k == 0:
        return middle[None]
    from scipy.cluster.vq import kmeans2  # slow to import

    centres, label = kmeans2(midpoints, k, minit="++", missing="warn", rng=np.random.default_rng(seed))
    return np.vstack([middle, centres[np.unique(label)]])
