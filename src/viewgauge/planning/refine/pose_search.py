"""Search for the best camera pose near given ones, many searches at once.

The value of a pose is not smooth: measurands come into view and out of it, and the weakest of several characteristics
counts. So nothing is differentiated: from each start a cloud of poses is drawn, the best part of it gives the centre
and the covariance of the next (the cross-entropy method: Rubinstein and Kroese, *The Cross-Entropy Method*, 2004, ch.
5). All clouds are evaluated together, as evaluation is fastest by the block.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["PoseSearch", "moved_poses"]

_SPREAD = np.array([0.15, 0.15, 0.1, 0.3, 0.1, 0.1])
"""First standard deviations of a cloud: orbit, rad, about the image's x and y; range, as its logarithm; roll, rad; the
point aimed at, as a share of the range."""

_KEPT = 0.125  # share of a cloud that gives the next
_LEARNT = 0.7  # how much of the next covariance comes from this cloud
_LEAST_SPREAD = 1e-7  # below which a cloud is a point


def moved_poses(
    T_part_camera: NDArray[np.float64], range_mm: NDArray[np.float64], moves: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Poses ``(..., 4, 4)`` mm, moved about the point at ``range_mm`` on their optical axes.

    Parameters
    ----------
    T_part_camera, range_mm
        ``(..., 4, 4)`` mm and ``(...,)`` mm.
    moves
        ``(..., 6)``: rotation about the camera's x and y axis through that point, rad; logarithm of the factor on the
        range; roll, rad; shift of the point along the image's x and y, as a share of the range.
    """
    moves = np.asarray(moves, dtype=float)
    from scipy.spatial.transform import Rotation  # late: slow to import

    turn = Rotation.from_rotvec(moves[..., [0, 1, 3]].reshape(-1, 3)).as_matrix().reshape(*moves.shape[:-1], 3, 3)
    distance = np.asarray(range_mm, dtype=float)
    about = np.zeros((*moves.shape[:-1], 3))  # the camera seen from the point, in the rotated frame
    about[..., 0], about[..., 1] = moves[..., 4] * distance, moves[..., 5] * distance
    about[..., 2] = -distance * np.exp(moves[..., 2])
    ahead = np.zeros(about.shape)
    ahead[..., 2] = distance
    R, centre = T_part_camera[..., :3, :3], T_part_camera[..., :3, 3]
    result = np.zeros((*np.broadcast_shapes(moves.shape[:-1], T_part_camera.shape[:-2]), 4, 4))
    result[..., :3, :3] = R @ turn
    result[..., :3, 3] = centre + (R @ (ahead + (turn @ about[..., None])[..., 0])[..., None])[..., 0]
    result[..., 3, 3] = 1.0
    return result


Value = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""The value ``(n,)`` of poses ``(n, 4, 4)``; -inf where one is not allowed."""


@dataclass(frozen=True)
class PoseSearch:
    """How hard to search.

    Parameters
    ----------
    cloud, clouds
        Poses in a cloud, and clouds one after the other.
    spread
        Factor on the first cloud's size.
    """

    cloud: int = 64
    clouds: int = 24
    spread: float = 1.0

    def best(
        self,
        T_part_camera: NDArray[np.float64],
        range_mm: NDArray[np.float64],
        value: Value,
        rng: np.random.Generator,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The best poses ``(s, 4, 4)`` mm met from s starts, and their values ``(s,)``; never worse than the starts."""
        starts = len(T_part_camera)
        best_move, best_value = np.zeros((starts, 6)), value(T_part_camera)
        best_pose = T_part_camera.copy()
        centre = np.zeros((starts, 6))
        covariance = np.tile(np.diag((self.spread * _SPREAD) ** 2), (starts, 1, 1))
        kept = max(7, round(_KEPT * self.cloud))  # more than the six directions
        for _ in range(self.clouds):
            drawn = _drawn(centre, covariance, self.cloud, rng)
            poses = moved_poses(T_part_camera[:, None], range_mm[:, None], drawn)
            values = value(poses.reshape(-1, 4, 4)).reshape(starts, self.cloud)
            order = np.argsort(-values, axis=1, kind="stable")[:, :kept]
            for s in range(starts):
                first = order[s, 0]
                if values[s, first] > best_value[s]:
                    best_value[s], best_pose[s], best_move[s] = values[s, first], poses[s, first], drawn[s, first]
                chosen = drawn[s, order[s][np.isfinite(values[s, order[s]])]]
                if len(chosen) < 2:  # hardly a pose is allowed: nearer to the best there is
                    centre[s], covariance[s] = best_move[s], covariance[s] / 4
                    continue
                offset = chosen - centre[s]
                spread = (
                    offset.T @ offset / len(chosen)
                )  # about the old centre: a move makes it longer in its direction
                covariance[s] = _LEARNT * spread + (1 - _LEARNT) * covariance[s]
                centre[s] = 0.5 * (chosen.mean(axis=0) + best_move[s])
            if (np.trace(covariance, axis1=1, axis2=2) < _LEAST_SPREAD**2).all():
                break
        return best_pose, best_value


def _drawn(
    centre: NDArray[np.float64], covariance: NDArray[np.float64], count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """``(s, count, 6)`` draws of normal laws ``(s, 6)``, ``(s, 6, 6)``; the first of each is its centre."""
    values, vectors = np.linalg.eigh(covariance)
    factor = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    unit = rng.standard_normal((len(centre), count, 6))
    unit[:, 0] = 0.0
    return np.asarray(centre[:, None] + unit @ np.swapaxes(factor, 1, 2))
