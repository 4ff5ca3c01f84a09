"""What measurements say: of the head that carries the camera."""

from .pose.pose_covariance import HeadCharacter, characterize_head, small_sample_factor
from .pose.pose_samples import PoseSamples, errors_about_group_means, errors_of_poses
from .pose.serial_arm import fit_serial_arm

__all__ = [
    "HeadCharacter",
    "PoseSamples",
    "characterize_head",
    "errors_about_group_means",
    "errors_of_poses",
    "fit_serial_arm",
    "small_sample_factor",
]
