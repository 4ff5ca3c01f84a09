"""OpenCV's ``FileStorage``: ``camera_matrix`` and ``distortion_coefficients``, also under its samples' other names."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, ClassVar

from ...sensors import Camera
from ..files.atomic import write_text_atomically
from .camera_file import CameraFile
from .reading.calibration_document import CalibrationDocument
from .reading.section_format import SectionFormat
from .reading.section_reader import Conventions

__all__ = ["OpenCvFormat", "write_opencv_camera"]


class OpenCvFormat(SectionFormat):
    """Calibrations of OpenCV, and of programs that write a camera matrix and coefficients under other names."""

    conventions: ClassVar[Conventions] = Conventions("OpenCV")
    described: ClassVar[str] = "an OpenCV YAML, XML or JSON"
    cannot_say: ClassVar[str] = (
        "of four coefficients the model, where there is no fisheye_model: asked (`--model`); often the image's size"
    )

    def is_of(self, section: dict[str, Any], document: CalibrationDocument) -> bool:
        """Any camera's section that no other format knows."""
        del section, document
        return True


def write_opencv_camera(path: str | os.PathLike[str], camera: Camera | CameraFile) -> None:
    """Write a calibration for OpenCV's ``FileStorage``: camera_matrix, distortion_coefficients, and the covariance.

    Every digit is kept. ``fisheye_model`` is 1 for the equidistant model, as in OpenCV's calibration sample.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    if isinstance(camera, Camera):
        focal = [camera.principal_distance_mm / pitch for pitch in camera.pixel_pitch_mm]
        centre, covariance = camera.principal_point, camera.intrinsics_covariance
    else:
        focal, centre, covariance = list(camera.focal_length_px), camera.principal_point_px, camera.covariance
    lines = ["%YAML:1.0", "---"]
    if camera.resolution is not None:
        lines += [f"image_width: {camera.resolution[0]}", f"image_height: {camera.resolution[1]}"]
    lines += _opencv_matrix("camera_matrix", [[focal[0], 0.0, centre[0]], [0.0, focal[1], centre[1]], [0.0, 0.0, 1.0]])
    if camera.lens is not None:
        lines.append(f"fisheye_model: {int(camera.lens.model == 'equidistant')}")
        lines += _opencv_matrix("distortion_coefficients", [[c] for c in camera.lens.coefficients])
    if covariance is not None:
        lines += _opencv_matrix("intrinsics_covariance", [list(row) for row in covariance])
    write_text_atomically(Path(path), "\n".join(lines) + "\n")


def _opencv_matrix(name: str, rows: list[list[float]]) -> list[str]:
    data = ", ".join(repr(float(value)) for row in rows for value in row)
    return [
        f"{name}: !!opencv-matrix",
        f"   rows: {len(rows)}",
        f"   cols: {len(rows[0])}",
        "   dt: d",
        f"   data: [ {data} ]",
    ]
