"""Candidate viewpoints, sampled around the part."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...exceptions import NoCandidateError
from ...geometry import look_at
from ...part import Mesh
from ...sensors import Camera
from ..region import AllowedRegion, RegionMember, Workpiece
from .candidate_options import CandidateOptions

__all__ = ["CandidateGrid", "default_distance_range", "spread_directions"]

_BLOCK = 65_536  # poses that the region is asked about at once
_GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))

# Default distances, as multiples of the one at which all measurands just fill the narrower field of view: nearer
# views see fewer measurands, and those larger.
_DEFAULT_RANGE = (0.5, 1.25)
# With an aperture, as multiples of the focus distance.
_DEFAULT_RANGE_IN_FOCUS = (0.85, 1.15)


def spread_directions(
    count: int, axis: tuple[float, float, float] = (0.0, 0.0, 1.0), half_angle_rad: float = np.pi
) -> NDArray[np.float64]:
    """Unit vectors ``(count, 3)`` spread uniformly over the sphere or the cap of a cone (Fibonacci lattice).

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
    distance, a direction and a roll. Poses that the region does not allow are left out.

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
        workpiece = Workpiece(mesh, self._targets[0])
        self.region = options.region(self._targets, (near, far), workpiece)
        """Where a camera may be; every candidate is."""
        members = options.members()
        stated = AllowedRegion(tuple(member.region(workpiece) for member in members))
        excluded = self._excluded(stated, None if options.regions else mesh)
        self._excluded_count = len(excluded)
        # the candidates that are left before each excluded one
        self._left_before = excluded - np.arange(len(excluded))
        if not len(self):
            why = self._why_none(members, workpiece)
            raise NoCandidateError(f"no candidate viewpoint is left: at distances of {near:.4g} to {far:.4g} mm {why}")

    def __len__(self) -> int:
        """Number of candidates."""
        return self._combinations - self._excluded_count

    @property
    def _combinations(self) -> int:
        return math.prod(self._shape) * len(self._rolls)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` ``(m, 4, 4)`` mm of candidates ``first`` to ``stop - 1``."""
        index = np.arange(first, min(stop, len(self)))
        # each excluded combination before a candidate moves it on by one
        return self._combined(index + np.searchsorted(self._left_before, index, side="right"))

    def _combined(self, index: NDArray[np.int64]) -> NDArray[np.float64]:
        """Poses ``(m, 4, 4)`` mm of combinations by index: the roll changes fastest, then direction and distance."""
        place, roll = np.divmod(index, len(self._rolls))
        target, distance, direction = np.unravel_index(place, self._shape)
        aim = self._targets[target]
        eyes = aim + self._distances[distance][:, None] * self._directions[direction]
        return look_at(eyes, aim, self._rolls[roll])

    def _excluded(self, region: AllowedRegion, outside: Mesh | None) -> NDArray[np.int64]:
        """Combinations that a region does not allow, ascending; those far outside of a mesh are not asked about."""
        excluded = [np.zeros(0, np.int64)]
        corners = None if outside is None else np.array(np.meshgrid(*outside.bounds.T)).reshape(3, -1).T
        size = len(self._directions) * len(self._rolls)
        for k, (target, distance) in enumerate(itertools.product(self._targets, self._distances)):
            if corners is not None and distance > np.linalg.norm(corners - target, axis=1).max():
                continue  # farther than any corner of the part's bounding box
            for first in range(k * size, (k + 1) * size, _BLOCK):
                index = np.arange(first, min(first + _BLOCK, (k + 1) * size))
                excluded.append(index[~region.allows(self._combined(index))])
        return np.concatenate(excluded)

    def _why_none(self, members: Sequence[RegionMember], workpiece: Workpiece) -> str:
        """Where the cameras would be, and what to do."""
        each: dict[str, NDArray[np.bool_]] = {}
        for member in members:
            here = np.zeros(self._combinations, dtype=bool)
            here[self._excluded(AllowedRegion((member.region(workpiece),)), None)] = True
            each[member.outside] = each.get(member.outside, here) | here
        for member in members:
            if each[member.outside].all():
                advice = "allow larger distances" if member.clears_part else "allow more room or other distances"
                return f"every camera would be {member.outside}; {advice}"
        shares = [(f"{excluded.mean():.0%}", outside) for outside, excluded in each.items() if excluded.any()]
        (share, outside), *others = shares
        words = [f"{share} of the cameras would be {outside}", *(" ".join(other) for other in others)]
        return f"{', '.join(words)}; allow more room or other distances"


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
