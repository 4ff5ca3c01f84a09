"""Where the small-error (first-order, joint) model is out of its range, and why.

The joint model holds the image length for linear in the errors. What it neglects, with sigma the standard deviation of
the length error, t that of the transverse difference of the ends' errors (quantization included), zeta that of the
depth over the depth, and L the image length:

- the euclidean length: ``|(L + e, t')| = L + e + t'²/(2L) - e t'²/(2L²) ...``, a bias of t²/(2L);
- the perspective division: ``1/(1 + zeta') = 1 - zeta' + zeta'² ...``, a bias of L zeta² and tails without end;
- the rotation's own second order, ``delta x (delta x p) / 2``, of the size of L times the angle squared.

In P(|error| <= T L) a bias b alone counts only as b²/sigma², the size of the cubic terms; no fixed ratio bounds all of
them. So the error of the probability is computed, by line sampling (Koutsourelakis, Pradlwarter and Schuëller,
*Prob. Eng. Mech.* 19 (2004) 409): with the errors as independent unit normals, turned so that z1 is the direction in
which the length changes, the full camera model tells on a line along z1 between which z1 the length is right, and the
line holds Phi(z+) - Phi(z-) of the probability. Its change over the other directions, one at a time by Gauss-Hermite
nodes, the transverse one and those of the two depths first among them, is the estimate. It is not made where the
neglected terms are negligible by their size, and is enlarged where they are so large that directions act together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from ..geometry import PoseError, point_jacobian
from ..sensors import Camera
from .line_sampling import NODES, WEIGHTS, line_probabilities, location_deviations

__all__ = ["NEGLIGIBLE", "WARNINGS", "probability_error", "validity"]

WARNINGS = ("near_lens_plane", "denominator_near_zero", "short_segment", "large_error")
"""Names of the warnings, the gravest first."""

THRESHOLD = 3e-4
"""Estimated error of the probability from which a pair is flagged; calibrated on a sweep (docs/paper/validity.md)."""

# sizes of the neglected terms, calibrated on the same sweep: below the first the error of the probability is less than
# a quarter of the threshold; above the second, directions together do what none does alone; above the third, no
# number of terms tells how heavy the tails are
NEGLIGIBLE, _CROSSED, _BEYOND = 0.01, 0.05, 0.2
_NEAR_LENS_PLANE = 6.0  # standard deviations of the depth between a point and the lens plane
_PAIRS_PER_CHUNK = 2000


@dataclass(frozen=True)
class _Sizes:
    """Sizes of the errors of m segments: image lengths mm, the others without unit."""

    length_mm: NDArray[np.float64]
    gradients: NDArray[np.float64]
    """``(m, 4, 8)``: length and transverse error, mm, depth over depth of start and end, per unit normal."""
    displacement: NDArray[np.float64]
    """Displacement across the line of sight over the depth, of the worse end."""

    @property
    def sigma_mm(self) -> NDArray[np.float64]:
        return np.asarray(np.linalg.norm(self.gradients[:, 0], axis=-1))

    @property
    def transverse(self) -> NDArray[np.float64]:
        """Transverse error over the image length."""
        sigma = np.linalg.norm(self.gradients[:, 1], axis=-1)
        return np.asarray(np.divide(sigma, self.length_mm, out=np.full(len(sigma), np.inf), where=self.length_mm > 0))

    @property
    def depth(self) -> NDArray[np.float64]:
        """Error of the depth over the depth, of the worse end."""
        return np.asarray(np.linalg.norm(self.gradients[:, 2:], axis=-1).max(axis=-1))

    @property
    def neglected(self) -> NDArray[np.float64]:
        """With d the largest ratio, that of the second order, L d², to sigma and of the cubic, d² sigma: their size.

        ``hypot(d, L d² / sigma)``: what is neglected in the probability is of the order of its square.
        """
        largest = np.maximum(np.maximum(self.depth, self.displacement), self.transverse)
        with np.errstate(over="ignore", invalid="ignore"):
            bias = np.where(largest > 0, largest**2 * self.length_mm / np.maximum(self.sigma_mm, 1e-300), 0.0)
        return np.asarray(np.where(np.isnan(bias), np.inf, np.hypot(largest, bias)))

    def take(self, chosen: NDArray[np.int64]) -> _Sizes:
        """The sizes of some of the segments."""
        return _Sizes(self.length_mm[chosen], self.gradients[chosen], self.displacement[chosen])


def validity(
    start: ArrayLike, end: ArrayLike, camera: Camera, error: PoseError, relative_tolerance: ArrayLike
) -> NDArray[np.str_]:
    """For each segment the name of what makes the joint model's probability doubtful, "" where nothing does.

    ``near_lens_plane``: an end is fewer than six standard deviations of its depth from the lens plane, or behind it;
    ``denominator_near_zero``: the error of the depth is not small against the depth; ``short_segment``: the image is
    not long against its transverse error; ``large_error``: the pose error is not small against the distance. Of
    those that are flagged for the size of :func:`probability_error`, the largest of the ratios gives the name.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    relative_tolerance
        T, broadcast against the segments.
    """
    points, tolerance, shape = _flat(start, end, relative_tolerance)
    in_front = (points[..., 2] > 0).all(axis=-1)
    named = np.full(len(points), WARNINGS[0], dtype=f"<U{max(map(len, WARNINGS))}")
    front = np.flatnonzero(in_front)
    for first in range(0, len(front), _PAIRS_PER_CHUNK):
        chunk = front[first : first + _PAIRS_PER_CHUNK]
        sizes = _sizes(points[chunk], camera, error)
        estimate = _estimate(points[chunk], tolerance[chunk], sizes, camera, error)
        largest = np.maximum(sizes.depth, sizes.displacement)
        name = np.where(sizes.displacement > sizes.depth, "large_error", "denominator_near_zero")
        name = np.where(sizes.transverse > 2 * largest, "short_segment", name)
        name = np.where(sizes.depth * _NEAR_LENS_PLANE > 1, "near_lens_plane", name)
        named[chunk] = np.where(estimate < THRESHOLD, "", name)
    return named.reshape(shape)


def probability_error(
    start: ArrayLike, end: ArrayLike, camera: Camera, error: PoseError, relative_tolerance: ArrayLike
) -> NDArray[np.float64]:
    """Estimate of how far the joint model's probability is from the full camera model's; arguments as :func:`validity`.

    It sums the sizes of effects that may cancel, and so is rather too large. 1 where an end is not in front of the
    camera; 0 where the errors are too small to matter.
    """
    points, tolerance, shape = _flat(start, end, relative_tolerance)
    front = np.flatnonzero((points[..., 2] > 0).all(axis=-1))
    result = np.ones(len(points))
    for first in range(0, len(front), _PAIRS_PER_CHUNK):
        chunk = front[first : first + _PAIRS_PER_CHUNK]
        sizes = _sizes(points[chunk], camera, error)
        result[chunk] = _estimate(points[chunk], tolerance[chunk], sizes, camera, error)
    return result.reshape(shape)


def _flat(
    start: ArrayLike, end: ArrayLike, tolerance: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[int, ...]]:
    start, end = np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float))
    points = np.stack([start, end], axis=-2)
    T = np.asarray(tolerance, dtype=float)
    shape = np.broadcast_shapes(points.shape[:-2], T.shape)
    return np.broadcast_to(points, (*shape, 2, 3)).reshape(-1, 2, 3), np.broadcast_to(T, shape).ravel(), shape


def _sizes(points: NDArray[np.float64], camera: Camera, error: PoseError) -> _Sizes:
    camera_factor = error.adjoint @ error.factor
    J = point_jacobian(points, camera.principal_distance_mm) @ camera_factor
    image = np.diff(camera.project(points), axis=-2)[:, 0]
    length = np.hypot(image[:, 0], image[:, 1])
    angle = np.arctan2(image[:, 1], image[:, 0])
    along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    steps = location_deviations(points, camera)[:, None]
    turned = np.swapaxes(np.cross(np.eye(3), points[..., None, :]), -1, -2)  # e_k x p in column k
    moved = np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=-1) @ camera_factor
    gradients = np.zeros((len(points), 4, 8))
    for row, direction in enumerate((along, across)):
        gradients[:, row, :6] = np.einsum("mk,mkp->mp", direction, J[:, 1] - J[:, 0])
        gradients[:, row, 6:] = direction * steps[:, 0]
    gradients[:, 2:, :6] = moved[:, :, 2] / points[..., 2:]
    distance = np.linalg.norm(points, axis=-1)
    sight = points / distance[..., None]
    variance = (moved**2).sum(axis=(-2, -1)) - (np.einsum("mek,mekp->mep", sight, moved) ** 2).sum(axis=-1)
    return _Sizes(length, gradients, (np.sqrt(np.maximum(variance, 0.0)) / points[..., 2]).max(axis=-1))


def _estimate(
    points: NDArray[np.float64],
    tolerance: NDArray[np.float64],
    sizes: _Sizes,
    camera: Camera,
    error: PoseError,
) -> NDArray[np.float64]:
    """Estimated error of the probability, ``(m,)``."""
    neglected = sizes.neglected
    result = np.where(neglected > _BEYOND, 1.0, 0.0)
    doubtful = np.flatnonzero((neglected > NEGLIGIBLE) & (neglected <= _BEYOND))
    if len(doubtful):
        chosen = sizes.take(doubtful)
        allowed = tolerance[doubtful] * chosen.length_mm
        lines = line_probabilities(points[doubtful], allowed, chosen.gradients, camera, error)
        first_order = 2 * ndtr(allowed / np.maximum(chosen.sigma_mm, 1e-300)) - 1
        centre = lines[:, :, len(NODES) // 2]
        axes = np.abs((lines - centre[..., None]) @ WEIGHTS).sum(axis=-1)
        behind = ndtr(-1 / np.maximum(chosen.depth, 1e-300))
        crossed = np.maximum(neglected[doubtful] / _CROSSED, 1.0) ** 4
        result[doubtful] = np.minimum((np.abs(centre[:, 0] - first_order) + axes + behind) * crossed, 1.0)
    return result
