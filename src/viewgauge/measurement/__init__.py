"""What measurements say: of a part in an image (``image``), and of how well a camera pose is held (``pose``)."""

from .pose.pose_covariance import PoseErrorEstimate, estimate_pose_error, small_sample_factor
from .pose.pose_samples import PoseSamples, errors_about_group_means, errors_of_poses
from .pose.serial_arm import fit_serial_arm

__all__ = [
    "PoseErrorEstimate",
    "PoseSamples",
    "errors_about_group_means",
    "errors_of_poses",
    "estimate_pose_error",
    "fit_serial_arm",
    "small_sample_factor",
]
