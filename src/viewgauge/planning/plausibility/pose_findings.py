"""What is implausible in the uncertainty of a pose."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...findings import Finding
from ...geometry import PoseError
from .usual_range import UsualRange

__all__ = ["POSE_ROTATION", "POSE_TRANSLATION", "pose_findings"]

POSE_TRANSLATION = UsualRange(
    "pose_translation",
    "the standard deviation of the position",
    0.001,
    10.0,
    "mm",
    1.0,
    "metres written as mm: no robot and no stage holds a camera so",
    "um written as mm, or a sample of different poses in place of repeats",
)
POSE_ROTATION = UsualRange(
    "pose_rotation",
    "the standard deviation of the orientation",
    math.radians(0.0005),
    math.radians(2.0),
    "deg",
    math.degrees(1.0),
    "radians written as degrees: no robot and no stage holds a camera so",
    "degrees written as radians, or mrad as degrees",
)
_FARTHEST_FRAME_MM = 3000.0


def pose_findings(pose_error: PoseError) -> Iterator[Finding]:
    """Every finding of a pose error by itself."""
    deviations = np.sqrt(np.asarray(pose_error.covariance).diagonal())
    for usual, of_three in ((POSE_TRANSLATION, deviations[:3]), (POSE_ROTATION, deviations[3:])):
        where = f"pose_uncertainty.{usual.name.removeprefix('pose_')}"
        largest = float(of_three.max())
        if largest == 0:
            yield Finding(
                usual.name,
                f"{usual.what} is 0: it counts as known exactly",
                f"{usual.least * usual.scale:.4g} to {usual.most * usual.scale:.4g} {usual.unit}",
                "a value that was left to be filled in",
                where,
            )
        else:
            yield from usual.judge(largest, where)
    if pose_error.T_camera_frame is not None:
        place = float(np.linalg.norm(np.asarray(pose_error.T_camera_frame)[:3, 3]))
        if place > _FARTHEST_FRAME_MM:
            yield Finding(
                "frame_position",
                f"the pose error frame is {place:.4g} mm from the camera",
                f"at most {_FARTHEST_FRAME_MM:g} mm",
                "um written as mm, or the robot's base in place of its flange",
                "pose_uncertainty.frame.position",
            )
