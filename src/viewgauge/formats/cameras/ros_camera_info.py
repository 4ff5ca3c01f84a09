"""ROS ``camera_info``: as the calibrator writes it, or as the topic shows it (``K``, ``D``, ``width``, ``height``)."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["RosCameraInfoFormat"]


class RosCameraInfoFormat(SectionFormat):
    """Calibrations of ROS, which differ from OpenCV's by their ``distortion_model``."""

    conventions: ClassVar[Conventions] = Conventions("ROS camera_info")
    described: ClassVar[str] = "a ROS camera_info"
    cannot_say: ClassVar[str] = "nothing; binning and the region of interest are applied"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there is a distortion model, in a file that OpenCV has not written."""
        return "distortion_model" in section and not document.is_opencv
