"""The intrinsics of RealSense cameras: ``ppx``, ``ppy`` and ``coeffs``, with five lens models."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["RealSenseFormat"]

_NUMBERS = {
    0: "none",
    1: "modified_brown_conrady",
    2: "inverse_brown_conrady",
    3: "ftheta",
    4: "brown_conrady",
    5: "kannala_brandt4",
}


class RealSenseFormat(SectionFormat):
    """Intrinsics as librealsense gives them, written as JSON or YAML."""

    conventions: ClassVar[Conventions] = Conventions("RealSense", model_numbers=_NUMBERS)
    described: ClassVar[str] = "RealSense intrinsics"
    cannot_say: ClassVar[str] = "nothing; inverse and modified Brown-Conrady are converted within 0.01 px or refused"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there is a principal point under RealSense's names."""
        del document
        return {"ppx", "ppy"} <= section.keys() or {"fx", "fy", "coeffs"} <= section.keys()
