"""MATLAB's ``cameraParameters``, ``cameraIntrinsics``: the first pixel's coordinate is 1, sizes are rows first."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
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
