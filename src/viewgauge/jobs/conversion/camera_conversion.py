"""Cameras: every calibration that is read, written for OpenCV, ROS, Kalibr or COLMAP."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from ...exceptions import InspectionFileError
from ...findings import Finding
from ...formats.cameras.camera_formats import camera_format_of
from ...formats.cameras.writing.camera_writers import CAMERA_WRITERS
from ..calibration import Stated, describe_calibration, is_inspection, parse_size, read_calibration
from .conversion import Converted

__all__ = ["CameraConversion"]


class CameraConversion:
    """Writes calibrations of cameras."""

    kind: ClassVar[str] = "camera"
    targets: ClassVar[Mapping[str, str]] = {name: writer.name for name, writer in CAMERA_WRITERS.items()}
    meanings: ClassVar[tuple[str, ...]] = ("name", "model", "size")

    def recognises(self, path: Path) -> bool:
        """Whether the file is a calibration or an inspection, whether or not it can be used."""
        try:
            return is_inspection(path) or camera_format_of(path) is not None
        except InspectionFileError:
            return False

    def write(
        self, source: Path, output: Path, target: str, meanings: Mapping[str, str], accept: tuple[str, ...]
    ) -> Converted:
        """Write the calibration of a file; raises InputError."""
        size = meanings.get("size")
        stated = Stated(meanings.get("name"), meanings.get("model"), None if size is None else parse_size(size))
        camera = read_calibration(source, stated, accept)
        writer = CAMERA_WRITERS[target]
        writer.write(output, camera)
        findings = camera.findings
        if camera.covariance is not None and target != "opencv":
            found = f"{writer.name} has no place for the uncertainty of the calibration, which is not written"
            findings = (*findings, Finding("uncertainty_not_written", found, where=str(output)))
        return Converted(camera.format, writer.name, findings, describe_calibration(camera))
