"""Error of the camera's position."""

from __future__ import annotations

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component
from .pose_source import PoseSource, scaled_pose_error

__all__ = ["PoseTranslation"]


class PoseTranslation(PoseSource):
    """The camera does not stand where it is meant to."""

    name = "pose_translation"
    of_pose = slice(0, 3)
    components = tuple(Component(axis, "translation", "translation") for axis in ("x", "y", "z"))
    groups = ("translation", "pose")
    knobs = ("translation", "pose_error")

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """The largest standard deviation, mm."""
        return self.deviation(pose_error)

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """Camera and pose error with the standard deviations of the translation multiplied."""
        return camera, scaled_pose_error(pose_error, factor, 1.0)
