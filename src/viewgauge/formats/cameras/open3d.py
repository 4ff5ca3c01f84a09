"""Open3D's pinhole intrinsics: ``intrinsic_matrix`` as nine numbers, column by column."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["Open3dFormat"]


class Open3dFormat(SectionFormat):
    """Cameras of Open3D, which have no distortion."""

    conventions: ClassVar[Conventions] = Conventions("Open3D", transposed=True)
    described: ClassVar[str] = "an Open3D camera"
    cannot_say: ClassVar[str] = "distortion: a warning says that there is none"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there are nine numbers in a row, with the size beside them, and no coefficients."""
        del document
        matrix = section.get("intrinsic_matrix")
        nine = isinstance(matrix, list) and len(matrix) == 9 and matrix[2] == matrix[5] == 0
        return nine and section.keys() <= {"intrinsic_matrix", "width", "height"}
