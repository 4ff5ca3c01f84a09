"""Poses of displaced acquisitions: where the camera really stands when it is sent to a viewpoint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError, invert
from .full_camera import draw_pose_errors

__all__ = ["displaced_poses"]


def displaced_poses(
    T_part_camera: NDArray[np.float64], error: PoseError, acquisitions: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """``(acquisitions, 4, 4)`` mm: the camera's pose in each acquisition that is meant to be at ``T_part_camera``.

    The scene, seen from the pose error frame, is displaced
    (:func:`~viewgauge.simulation.full_camera.draw_pose_errors`); what is common to acquisitions is drawn once for all
    of them where the error states it.
    """
    assert error.T_camera_frame is not None  # set by PoseError
    common = error.common_covariance
    if common is None:
        displacement = draw_pose_errors(error, acquisitions, rng)
    else:
        shared = draw_pose_errors(PoseError(common), 1, rng)
        displacement = draw_pose_errors(PoseError(error.covariance - common), acquisitions, rng) @ shared
    T_camera_frame = error.T_camera_frame
    seen = (
        T_camera_frame @ displacement @ invert(T_camera_frame) @ invert(T_part_camera)
    )  # T_camera_part of each acquisition
    return np.asarray(invert(seen))
