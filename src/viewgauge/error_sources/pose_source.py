"""What translation and rotation of the camera's pose have in common as sources of error."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError
from ..sensors import Camera
from .base import ErrorSource, LinearTerms, SourceKind

__all__ = ["PoseSource", "scaled_pose_error"]


def scaled_pose_error(pose_error: PoseError, translation: float, rotation: float) -> PoseError:
    """The pose error with the standard deviations of translation and rotation multiplied, common parts alike."""
    scale = np.diag([translation] * 3 + [rotation] * 3)
    common = pose_error.common_covariance
    return replace(
        pose_error,
        covariance=scale @ pose_error.covariance @ scale,
        pivot_mm=(0.0, 0.0, 0.0),  # T_camera_frame holds it
        common_covariance=None if common is None else scale @ common @ scale,
    )


class PoseSource(ErrorSource):
    """Three of the six errors of the camera's pose, which are drawn together with the other three.

    Attributes
    ----------
    of_pose
        Which of [x, y, z, rx, ry, rz].
    """

    kind = SourceKind.POSE
    of_pose: ClassVar[slice]

    def deviation(self, pose_error: PoseError) -> float:
        """The largest standard deviation of the three, mm or rad."""
        return float(np.sqrt(pose_error.covariance.diagonal()[self.of_pose].max()))

    @abstractmethod
    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """Camera and pose error with these three multiplied."""

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:  # noqa: ARG002
        """``(3,)`` mm or rad."""
        return np.asarray(np.sqrt(np.maximum(pose_error.covariance.diagonal()[self.of_pose], 0.0)))

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:  # noqa: ARG002
        """``(..., 3)``: mm of image length per mm or rad."""
        return terms.pose[..., self.of_pose]
