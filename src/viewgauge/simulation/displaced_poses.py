"""Poses of displaced looks: where the head really stands when it is sent to a setting."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError, invert
from .full_camera import draw_pose_errors

__all__ = ["displaced_poses"]


def displaced_poses(
    T_part_camera: NDArray[np.float64], error: PoseError, looks: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """``(looks, 4, 4)`` mm: the camera's pose in each look that is meant to be at ``T_part_camera``.

    The scene, seen from the head, is displaced (:func:`~viewgauge.simulation.full_camera.draw_pose_errors`); what is
    common to looks is drawn once for all of them where the error states it.
    """
    assert error.T_camera_head is not None  # set by PoseError
    common = error.common_covariance
    if common is None:
        displacement = draw_pose_errors(error, looks, rng)
    else:
        shared = draw_pose_errors(PoseError(common), 1, rng)
        displacement = draw_pose_errors(PoseError(error.covariance - common), looks, rng) @ shared
    T_camera_head = error.T_camera_head
    seen = T_camera_head @ displacement @ invert(T_camera_head) @ invert(T_part_camera)  # T_camera_part of each look
    return np.asarray(invert(seen))
