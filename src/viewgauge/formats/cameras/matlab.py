"""MATLAB's ``cameraParameters``, ``cameraIntrinsics``: the first pixel's coordinate is 1, sizes are rows first."""

from __future__ import annotations

from typing import Any, ClassVar

from .camera_file import CameraFile, Stated
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import find_cameras
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["MatlabFormat"]

_KEYS = {"IntrinsicMatrix", "RadialDistortion", "TangentialDistortion", "MappingCoefficients"}


class MatlabFormat(SectionFormat):
    """What MATLAB's calibrator gives, written as YAML or JSON."""

    conventions: ClassVar[Conventions] = Conventions("MATLAB", first_pixel=1.0, transposed=True, rows_first=True)
    described: ClassVar[str] = "MATLAB's camera parameters"
    cannot_say: ClassVar[str] = "nothing; the fisheye model (MappingCoefficients) is refused by name"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there is a key that only MATLAB writes."""
        del document
        return bool(_KEYS & section.keys())

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration of the camera that is meant; None where a problem was noted."""
        if any("MappingCoefficients" in camera.section for camera in find_cameras(document.values)):
            hint = "calibrate with the model of OpenCV's fisheye module"
            document.problems.add(("MappingCoefficients",), "MATLAB's fisheye model is not known here", hint=hint)
            return None
        return super().read(document, stated)
