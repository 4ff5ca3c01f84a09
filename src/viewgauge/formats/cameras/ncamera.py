"""Lists of cameras with ``intrinsics`` and ``distortion`` as matrices of one column, as visual-inertial tools write."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
from .reading.key_names import is_matrix
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["CameraListFormat"]


class CameraListFormat(SectionFormat):
    """The list of cameras of maplab and its relatives."""

    conventions: ClassVar[Conventions] = Conventions("camera list")
    described: ClassVar[str] = "a list of cameras"
    cannot_say: ClassVar[str] = "nothing; a rolling shutter (line delay) is a warning"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there are intrinsics as one column, and a label or a lens with a type."""
        del document
        intrinsics = section.get("intrinsics")
        return is_matrix(intrinsics) and isinstance(intrinsics, dict) and bool({"label", "type"} & section.keys())
