"""The nominal poses of an arm or a positioner of which joint values and measured poses are known: its screw axes.

``T(q) = exp(s_1 q_1) ... exp(s_n q_n) M`` (Brockett's product of exponentials; Lynch and Park, *Modern Robotics*, sec.
4.1), with the screw axes s_k and the pose M at zero fitted by least squares of the pose errors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .pose_samples import errors_of_poses

__all__ = ["fit_serial_arm"]

_RADIUS_MM = 300.0  # a turn of one rad counts as much as this shift, in the sum of squares


def fit_serial_arm(
    joints_rad: NDArray[np.float64], T_base_measured: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """Poses ``(m, 4, 4)`` mm that an arm of revolute joints with the best screw axes would have reached.

    Parameters
    ----------
    joints_rad
        ``(m, n)``: values of n revolute joints.
    T_base_measured
        ``(m, 4, 4)`` mm.

    Returns
    -------
    The poses, and the number of parameters that were fitted.

    Raises
    ------
    InputError
        If there are fewer numbers than parameters.
    """
    from scipy.optimize import least_squares

    m, n = joints_rad.shape
    count = 6 * (n + 1)
    if 6 * m <= count:
        raise InputError(
            "too few poses for the axes of the joints", key="samples", got=m, expected=f"more than {count // 6}"
        )
    weight = np.array([1.0, 1, 1, _RADIUS_MM, _RADIUS_MM, _RADIUS_MM])

    def residual(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray((errors_of_poses(_poses(x, joints_rad), T_base_measured) * weight).ravel())

    best = None
    for start in _starts(joints_rad, T_base_measured):
        found = least_squares(residual, start, method="trf", x_scale="jac")
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None  # there is a start
    return _poses(best.x, joints_rad), count


def _starts(joints_rad: NDArray[np.float64], T_base_measured: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """First guesses: each axis from the two poses between which its joint moves most and the others least."""
    m, n = joints_rad.shape
    axes = np.zeros((n, 6))
    first, second = np.triu_indices(m, 1)
    moved = np.abs(joints_rad[first] - joints_rad[second])
    for k in range(n):
        others = np.delete(moved, k, axis=1).sum(axis=1)
        pair = int(np.argmax(np.minimum(moved[:, k], np.pi / 2) - 5 * others))
        a, b = first[pair], second[pair]
        step = joints_rad[b, k] - joints_rad[a, k]
        if step != 0:
            axes[k] = _logarithm(T_base_measured[b] @ np.linalg.inv(T_base_measured[a])) / step
    near = int(np.argmin((joints_rad**2).sum(axis=1)))
    return [np.concatenate([axes.ravel(), _logarithm(T_base_measured[near])])]


def _poses(x: NDArray[np.float64], joints_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    n = joints_rad.shape[1]
    T = np.broadcast_to(np.eye(4), (len(joints_rad), 4, 4))
    for k in range(n):
        T = T @ _exponential(x[6 * k : 6 * k + 6] * joints_rad[:, k, None])
    return np.asarray(T @ _exponential(x[None, 6 * n :]))


def _exponential(twist: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(m, 4, 4)`` of twists ``(m, 6)``, translation first (Lynch and Park, prop. 3.25)."""
    from scipy.spatial.transform import Rotation

    v, w = twist[:, :3], twist[:, 3:]
    angle = np.linalg.norm(w, axis=1)
    small = angle < 1e-6
    safe = np.where(small, 1.0, angle)
    W = np.zeros((len(twist), 3, 3))
    W[:, 0, 1], W[:, 0, 2], W[:, 1, 2] = -w[:, 2], w[:, 1], -w[:, 0]
    W -= np.swapaxes(W, 1, 2)
    a = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
    b = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
    V = np.eye(3) + a[:, None, None] * W + b[:, None, None] * (W @ W)
    T = np.zeros((len(twist), 4, 4))
    T[:, :3, :3] = Rotation.from_rotvec(w).as_matrix()
    T[:, :3, 3] = np.einsum("mij,mj->mi", V, v)
    T[:, 3, 3] = 1.0
    return T


def _logarithm(T: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(6,)`` twist of a pose, by inverting the exponential's matrix V."""
    from scipy.spatial.transform import Rotation

    w = Rotation.from_matrix(T[:3, :3]).as_rotvec()
    units = np.concatenate([np.eye(3), np.tile(w, (3, 1))], axis=1)
    V = _exponential(units)[:, :3, 3].T
    return np.concatenate([np.linalg.solve(V, T[:3, 3]), w])
