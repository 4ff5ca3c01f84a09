"""Kalibr's camchain: a section for each camera, with ``intrinsics``, ``distortion_coeffs`` and ``resolution``."""

from __future__ import annotations

from typing import Any, ClassVar

from .reading.calibration_document import CalibrationDocument
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["KalibrFormat"]


class KalibrFormat(SectionFormat):
    """Camchains of Kalibr, with the distortion models radtan and equidistant of its pinhole camera."""

    conventions: ClassVar[Conventions] = Conventions("Kalibr")
    described: ClassVar[str] = "a Kalibr camchain"
    cannot_say: ClassVar[str] = "nothing; the models omni, ds, eucm and fov are refused by name"

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether there are intrinsics as four numbers, with Kalibr's other keys."""
        del document
        intrinsics = section.get("intrinsics")
        named = {"camera_model", "distortion_coeffs", "rostopic", "cam_overlaps"} & section.keys()
        return isinstance(intrinsics, list) and not any(isinstance(row, list) for row in intrinsics) and bool(named)
