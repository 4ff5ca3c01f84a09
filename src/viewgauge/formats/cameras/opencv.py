"""OpenCV's ``FileStorage``: ``camera_matrix`` and ``distortion_coefficients``, also under its samples' other names."""

from __future__ import annotations

import os
from pathlib import Path

from ...sensors import Camera
from ..files.atomic import write_text_atomically
from .camera_file import CalibrationDocument, CameraFile
from .camera_matrices import has_camera_matrix, read_camera_matrix

__all__ = ["OpenCvFormat", "write_opencv_camera"]


class OpenCvFormat:
    """Calibrations of OpenCV, and of programs that write as it does."""

    name, described = "OpenCV", "an OpenCV YAML"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether there is a camera matrix."""
        return has_camera_matrix(document)

    def read(self, document: CalibrationDocument, name: str | None) -> CameraFile | None:
        """The calibration; None where a problem was noted."""
        return read_camera_matrix(document, name, self.name)


def write_opencv_camera(path: str | os.PathLike[str], camera: Camera | CameraFile) -> None:
    """Write a calibration for OpenCV's ``FileStorage``: camera_matrix, distortion_coefficients, and the covariance.

    Every digit is kept. Files of the equidistant model have ``fisheye_model: 1``, as OpenCV's calibration sample.

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
        if camera.lens.model == "equidistant":
            lines.append("fisheye_model: 1")
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
