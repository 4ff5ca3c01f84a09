"""Error of the camera's orientation."""

from __future__ import annotations

import numpy as np

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component
from .pose_source import PoseSource, scaled_pose_error

__all__ = ["PoseRotation"]


class PoseRotation(PoseSource):
    """The camera is not turned as it is meant to be."""

    name = "pose_rotation"
    of_pose = slice(3, 6)
    components = tuple(Component(axis, "rotation", "rotation") for axis in ("rx", "ry", "rz"))
    groups = ("rotation", "pose")
    knobs = ("rotation", "pose_error")

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """The largest standard deviation, degrees."""
        return float(np.degrees(self.deviation(pose_error)))

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """Camera and pose error with the standard deviations of the rotation multiplied."""
        return camera, scaled_pose_error(pose_error, 1.0, factor)
