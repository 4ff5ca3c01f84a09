"""Candidate sensor settings, sampled around the part."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

from ..exceptions import NoCandidateError
from ..geometry import Camera, look_at
from ..part import Mesh
from .options import CandidateOptions

__all__ = ["default_distance_range", "sample_settings", "spread_directions"]

_GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))

# Default distances, as multiples of the one at which all gauges just fill the narrower field of view: nearer
# views see fewer gauges, and those larger.
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


def default_distance_range(gauge_points: NDArray[np.float64], camera: Camera) -> tuple[float, float]:
    """(nearest, farthest) distance, mm, that suits gauges with these end points ``(n, 3)`` mm."""
    if camera.focus_distance_mm is not None:
        near, far = (factor * camera.focus_distance_mm for factor in _DEFAULT_RANGE_IN_FOCUS)
        return near, far
    centre = (gauge_points.min(axis=0) + gauge_points.max(axis=0)) / 2
    radius = float(np.linalg.norm(gauge_points - centre, axis=1).max())
    fitting = radius / np.sin(min(camera.half_field_of_view_rad))
    near, far = (factor * fitting for factor in _DEFAULT_RANGE)
    return near, far


def sample_settings(
    gauge_points: NDArray[np.float64],
    mesh: Mesh,
    camera: Camera,
    options: CandidateOptions,
    seed: int,
) -> NDArray[np.float64]:
    """Candidate camera poses around the part.

    Every combination of a direction, a distance, a roll and a point aimed at: the centre of the gauges and the
    centres of clusters of gauges. Poses whose camera would be inside the part's bounding box are left out.

    Parameters
    ----------
    gauge_points
        ``(g, 2, 3)`` mm: ends of the gauges, part frame.

    Returns
    -------
    ``T_part_camera`` ``(n, 4, 4)`` mm.

    Raises
    ------
    NoCandidateError
        If none is left.
    """
    targets = _targets(gauge_points, options.targets, seed)
    near, far = options.distance_mm or default_distance_range(gauge_points.reshape(-1, 3), camera)
    distances = np.geomspace(near, far, options.distances) if options.distances > 1 else np.array([np.sqrt(near * far)])
    directions = spread_directions(options.directions, options.cone_axis, options.cone_half_angle_rad)
    rolls = np.arange(options.rolls) * np.pi / options.rolls
    target, distance, direction, roll = (
        index.ravel() for index in np.indices((len(targets), len(distances), len(directions), len(rolls)))
    )
    eyes = targets[target] + distances[distance][:, None] * directions[direction]
    low, high = mesh.bounds
    outside = ((eyes < low) | (eyes > high)).any(axis=1)
    if not outside.any():
        raise NoCandidateError(
            f"no candidate setting is left: at distances of {near:.4g} to {far:.4g} mm every camera would be inside "
            "the part's bounding box; allow larger distances"
        )
    return look_at(eyes[outside], targets[target][outside], rolls[roll][outside])


def _targets(gauge_points: NDArray[np.float64], clusters: int, seed: int) -> NDArray[np.float64]:
    """Points to aim at ``(1 + k, 3)`` mm: the middle of all gauges, and k centres of clusters of gauges."""
    ends = gauge_points.reshape(-1, 3)
    middle = np.asarray((ends.min(axis=0) + ends.max(axis=0)) / 2)
    midpoints = np.unique(gauge_points.mean(axis=1).round(9), axis=0)
    k = min(clusters, len(midpoints))
    if k == 0:
        return middle[None]
    centres, label = kmeans2(midpoints, k, minit="++", missing="warn", rng=np.random.default_rng(seed))
    return np.vstack([middle, centres[np.unique(label)]])
