"""ROS ``camera_info``: as the calibrator writes it, or as the topic shows it (``K``, ``D``, ``width``, ``height``)."""

from __future__ import annotations

from .camera_file import CalibrationDocument, CameraFile
from .camera_matrices import has_camera_matrix, read_camera_matrix

__all__ = ["RosCameraInfoFormat"]


class RosCameraInfoFormat:
    """Calibrations of ROS, which differ from OpenCV's by their ``distortion_model``."""

    name, described = "ROS camera_info", "a ROS camera_info"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether there are a camera matrix and a distortion model, in a file that OpenCV has not written."""
        return has_camera_matrix(document) and "distortion_model" in document.sections and not document.is_opencv

    def read(self, document: CalibrationDocument, name: str | None) -> CameraFile | None:
        """The calibration; None where a problem was noted."""
        return read_camera_matrix(document, name, self.name)
