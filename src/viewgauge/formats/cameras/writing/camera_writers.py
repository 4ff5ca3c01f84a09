"""The formats in which calibrations are written, by the names that ``viewgauge convert --as`` takes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Protocol

from ..camera_file import CameraFile
from ..opencv import write_opencv_camera
from .colmap_text import ColmapWriter
from .kalibr_yaml import KalibrWriter
from .ros_yaml import RosWriter

__all__ = ["CAMERA_WRITERS", "CameraWriter"]


class CameraWriter(Protocol):
    """Writes calibrations in one format."""

    @property
    def name(self) -> str:
        """The program whose format it is."""
        ...

    def write(self, path: str | os.PathLike[str], camera: CameraFile) -> None:
        """Write a calibration; raises InputError where the format cannot hold it."""
        ...


@dataclass(frozen=True)
class _OpenCvWriter:
    name: str = "OpenCV"

    def write(self, path: str | os.PathLike[str], camera: CameraFile) -> None:
        write_opencv_camera(path, camera)


CAMERA_WRITERS: dict[str, CameraWriter] = {
    "opencv": _OpenCvWriter(),
    "ros": RosWriter(),
    "kalibr": KalibrWriter(),
    "colmap": ColmapWriter(),
}
