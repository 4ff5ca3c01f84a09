"""The nominal poses of an arm or a positioner of which joint values and measured poses are known: its screw axes.

``T(q) = exp(s_1 q_1) ... exp(s_n q_n) M`` (Brockett's product of exponentials; Lynch and Park, *Modern Robotics*, sec.
4.1), with the screw axes s_k and the pose M at zero fitted by least squares of the pose errors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import invert
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
            axes[k] = _logarithm(T_base_measured[b] @ invert(T_base_measured[a])) / step
    near = int(np.argmin((joints_rad**2).sum(axis=1)))
    return [np.concatenate([axes.ravel(), _logarithm(T_base_measured[near])])]


def _poses(x: NDArray[np.float64], joints_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    n = joints_rad.shape[1]
    T = np.broadcast_to(np.eye(4), (len(joints_rad), 4, 4))
    for k in range(n):
        T = T @ _exponential(x[6 * k : 6 * k + 6] * joints_rad[:, k, None])
    return np.asarray(T @ _exponential(x[None, 6 * n :]))


def _exponential(twist: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(m, 4, 4)`` of twists ``(m, 6)``, translation first (SciPy has the rotation first)."""
    from scipy.spatial.transform import RigidTransform

    return np.asarray(RigidTransform.from_exp_coords(np.roll(twist, 3, axis=-1)).as_matrix())


def _logarithm(T: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(6,)`` twist of a pose, translation first."""
    from scipy.spatial.transform import RigidTransform, Rotation

    pose = RigidTransform.from_components(T[:3, 3], Rotation.from_matrix(T[:3, :3]))
    return np.asarray(np.roll(pose.as_exp_coords(), 3))
