"""Rigid poses as 4x4 matrices, vectorised: ``T_a_b`` maps coordinates in b to coordinates in a."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError

__all__ = [
    "invert",
    "look_at",
    "pose_from_quaternion",
    "quaternion_from_pose",
    "require_poses",
    "skew",
    "transform",
]

QUATERNION_NORM_TOLERANCE = 1e-4  # four printed digits
_ROTATION_TOLERANCE = 1e-6


def skew(vector: ArrayLike) -> NDArray[np.float64]:
    """Matrix ``(3, 3)`` of the cross product with a vector ``(3,)``: ``skew(a) @ b = a x b``."""
    x, y, z = np.asarray(vector, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def require_poses(poses: ArrayLike, name: str = "pose") -> NDArray[np.float64]:
    """Poses ``(..., 4, 4)`` as float64; raises InputError unless each is finite and rigid."""
    try:
        T = np.array(poses, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be 4x4 matrices of numbers") from error
    if T.shape[-2:] != (4, 4) or not np.isfinite(T).all():
        raise InputError(f"{name} must be finite 4x4 matrices", got=f"shape {T.shape}")
    R = T[..., :3, :3]
    orthogonal = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max(initial=0.0) <= _ROTATION_TOLERANCE
    if not orthogonal or (np.linalg.det(R) < 0).any():
        raise InputError(f"the rotation of {name} is not a rotation", expected="an orthonormal, right-handed 3x3 block")
    if np.abs(T[..., 3, :] - [0, 0, 0, 1]).max(initial=0.0) > 0:
        raise InputError(f"the last row of {name} must be 0 0 0 1")
    return T


def invert(T_a_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """``T_b_a`` of poses ``(..., 4, 4)``."""
    R_transposed = np.swapaxes(T_a_b[..., :3, :3], -1, -2)
    T_b_a = np.zeros_like(T_a_b)
    T_b_a[..., :3, :3] = R_transposed
    T_b_a[..., :3, 3] = -(R_transposed @ T_a_b[..., :3, 3, None])[..., 0]
    T_b_a[..., 3, 3] = 1.0
    return T_b_a


def transform(T_a_b: NDArray[np.float64], points_b: ArrayLike) -> NDArray[np.float64]:
    """Points ``(..., 3)`` of frame b in frame a; poses ``(..., 4, 4)`` broadcast against the points."""
    points = np.asarray(points_b, dtype=float)
    rotated = (T_a_b[..., :3, :3] @ points[..., None])[..., 0]
    return np.asarray(rotated + T_a_b[..., :3, 3])


def pose_from_quaternion(position_mm: ArrayLike, quaternion_wxyz: ArrayLike) -> NDArray[np.float64]:
    """Pose ``(..., 4, 4)`` from positions ``(..., 3)`` mm and unit quaternions ``(..., 4)``, scalar first.

    Raises
    ------
    InputError
        If a quaternion's norm differs from 1 by more than 1e-4, or a position is not finite.
    """
    from scipy.spatial.transform import Rotation  # late: slow to import, and a check of a part does without

    q = _vectors("quaternion_wxyz", quaternion_wxyz, 4)
    position = _points("position_mm", position_mm)
    norm = np.linalg.norm(q, axis=-1)
    if not (np.abs(norm - 1) <= QUATERNION_NORM_TOLERANCE).all():
        raise InputError(
            "the quaternion is not of unit length",
            got=f"norm {np.atleast_1d(norm)[np.argmax(np.abs(np.atleast_1d(norm) - 1))]:.6g}",
            expected="norm 1 within 1e-4, order w, x, y, z",
        )
    turn = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True)
    T = np.zeros((*q.shape[:-1], 4, 4))
    T[..., :3, :3] = turn.as_matrix().reshape(*q.shape[:-1], 3, 3)
    T[..., :3, 3] = position
    T[..., 3, 3] = 1.0
    return T


def quaternion_from_pose(T_a_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternions ``(..., 4)``, scalar first and not negative, of poses ``(..., 4, 4)``."""
    from scipy.spatial.transform import Rotation  # late, as above

    turn = Rotation.from_matrix(T_a_b[..., :3, :3].reshape(-1, 3, 3))
    return np.asarray(turn.as_quat(canonical=True, scalar_first=True).reshape(*T_a_b.shape[:-2], 4))


def _vectors(name: str, vectors: ArrayLike, length: int) -> NDArray[np.float64]:
    array = np.asarray(vectors, dtype=float)
    if array.shape[-1:] != (length,):
        raise InputError(f"must have {length} numbers in its last axis", key=name, got=f"shape {array.shape}")
    return array


def _points(name: str, points: ArrayLike) -> NDArray[np.float64]:
    array = _vectors(name, points, 3)
    if not np.isfinite(array).all():
        raise InputError("must be finite", key=name, got=points)
    return array


def look_at(eye_mm: ArrayLike, target_mm: ArrayLike, roll_rad: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Pose ``T_part_camera`` ``(..., 4, 4)`` of a camera at ``eye`` whose optical axis meets ``target``.

    At roll 0 the image's x axis is as level as can be (perpendicular to the part's z axis, or to its x axis
    when looking along z); ``roll_rad`` turns the camera about its optical axis.

    Raises
    ------
    InputError
        If an eye coincides with its target, or a coordinate is not finite.
    """
    eye, target = _points("eye_mm", eye_mm), _points("target_mm", target_mm)
    forward = target - eye
    distance = np.linalg.norm(forward, axis=-1, keepdims=True)
    if (distance == 0).any():
        raise InputError("the eye coincides with the target: there is no direction to look in", key="eye_mm")
    forward = forward / distance
    up = np.where(np.abs(forward[..., 2:3]) < 1 - 1e-9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    right = np.cross(forward, up)
    right = right / np.linalg.norm(right, axis=-1, keepdims=True)
    down = np.cross(forward, right)
    c, s = (np.asarray(g(roll_rad), dtype=float)[..., None] for g in (np.cos, np.sin))
    x, y = c * right + s * down, c * down - s * right
    shape = np.broadcast_shapes(x.shape, forward.shape)
    T = np.zeros((*shape[:-1], 4, 4))
    T[..., :3, 0], T[..., :3, 1], T[..., :3, 2], T[..., :3, 3] = x, y, forward, eye
    T[..., 3, 3] = 1.0
    return T
