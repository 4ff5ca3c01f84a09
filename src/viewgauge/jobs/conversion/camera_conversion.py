"""Cameras: every calibration that is read, written for OpenCV."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from ...exceptions import InputError
from ..calibration import describe_calibration, read_calibration, write_opencv_camera
from .conversion import Converted

__all__ = ["CameraConversion"]


class CameraConversion:
    """Writes calibrations of cameras."""

    kind: ClassVar[str] = "camera"
    targets: ClassVar[Mapping[str, str]] = {"opencv": "OpenCV"}
    meanings: ClassVar[tuple[str, ...]] = ("name", "model", "size")

    def recognises(self, path: Path) -> bool:
        """Whether a calibration can be read from the file."""
        try:
            read_calibration(path)
        except InputError:
            return False
        return True

    def write(
        self, source: Path, output: Path, target: str, meanings: Mapping[str, str], accept: tuple[str, ...]
    ) -> Converted:
        """Write the calibration of a file; raises InputError."""
        del accept
        camera = read_calibration(source, meanings.get("name"))
        write_opencv_camera(output, camera)
        return Converted(camera.format, self.targets[target], document=describe_calibration(camera))
