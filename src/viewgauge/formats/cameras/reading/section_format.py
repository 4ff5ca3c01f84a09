"""What formats have in common whose cameras are sections of YAML, JSON or OpenCV's XML."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from ..camera_file import CameraFile, Stated
from .calibration_document import CalibrationDocument
from .found_cameras import chosen_camera, find_cameras
from .section_reader import Conventions, read_camera_section

__all__ = ["SectionFormat"]


class SectionFormat(ABC):
    """A format whose cameras are mappings with keys, one or several in a file."""

    conventions: ClassVar[Conventions]
    described: ClassVar[str]
    cannot_say: ClassVar[str]

    @property
    def name(self) -> str:
        """The program whose format it is."""
        return self.conventions.format

    @abstractmethod
    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Whether a camera's section is of this format."""

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether a camera of the file is of this format."""
        return any(self.is_of(camera.section, document) for camera in find_cameras(document.values))

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration of the camera that is meant; None where a problem was noted."""
        camera = chosen_camera(document, find_cameras(document.values), stated.name)
        return None if camera is None else read_camera_section(document, camera, self.conventions, stated)
