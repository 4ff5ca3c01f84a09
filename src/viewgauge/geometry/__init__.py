"""Poses, lens distortion, the pose error and its first-order effect on image points."""

from .image_jacobian import point_jacobian
from .lens import Lens
from .pose_error import PoseError
from .poses import invert, look_at, pose_from_quaternion, quaternion_from_pose, require_poses, transform
from .view_block import VIEWS, view_block

__all__ = [
    "VIEWS",
    "Lens",
    "PoseError",
    "invert",
    "look_at",
    "point_jacobian",
    "pose_from_quaternion",
    "quaternion_from_pose",
    "require_poses",
    "transform",
    "view_block",
]
