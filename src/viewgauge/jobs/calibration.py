"""A camera's calibration: read in any of the formats, told, and written for OpenCV."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from ..exceptions import InspectionFileError
from ..formats.cameras.camera_file import CameraFile
from ..formats.cameras.camera_formats import read_camera_file
from ..formats.cameras.opencv import write_opencv_camera
from ..formats.files.problems import Problems
from ..formats.files.text import read_text
from ..formats.files.yaml_tree import parse_yaml
from ..formats.inspection.inspection_file import read_inspection_file

__all__ = ["describe_calibration", "read_calibration", "write_opencv_camera"]


def read_calibration(path: str | os.PathLike[str], name: str | None = None) -> CameraFile:
    """The calibration in a file of OpenCV, ROS or Kalibr, or of the camera of an inspection file.

    Parameters
    ----------
    name
        Which camera of a file that has several, such as ``cam1``.

    Raises
    ------
    InspectionFileError
        With all that is wrong.
    """
    if not _is_inspection(Path(path)):
        return read_camera_file(path, name)
    if name is not None:
        raise InspectionFileError("an inspection has one camera", file=path, got=name, hint="leave the name out")
    camera = read_inspection_file(path).setup.camera
    focal = [camera.principal_distance_mm / pitch for pitch in camera.pixel_pitch_mm]
    return CameraFile(
        "inspection file",
        (focal[0], focal[1]),
        camera.principal_point,
        camera.lens,
        camera.resolution,
        camera.intrinsics_covariance,
    )


def describe_calibration(camera: CameraFile) -> dict[str, Any]:
    """As JSON-ready data, px; what the file does not say is null.

    ``distortion_at_corner`` is how far the lens moves the corner of the image that it moves most.
    """
    coefficients = {} if camera.lens is None else dict(zip(camera.lens.names, camera.lens.coefficients, strict=True))
    names = ["fx", "fy", "cx", "cy", *coefficients]
    deviation = None
    if camera.covariance is not None:
        deviation = dict(zip(names, np.sqrt(np.diag(camera.covariance)).tolist(), strict=True))
    return {
        "format": camera.format,
        "resolution": None if camera.resolution is None else list(camera.resolution),
        "focal_length_px": list(camera.focal_length_px),
        "principal_point_px": list(camera.principal_point_px),
        "distortion_model": None if camera.lens is None else camera.lens.model,
        "distortion": coefficients,
        "distortion_at_corner_px": _at_corner(camera),
        "standard_uncertainty": deviation,
        "covariance": None if camera.covariance is None else [list(row) for row in camera.covariance],
    }


def _at_corner(camera: CameraFile) -> float | None:
    if camera.resolution is None:
        return None
    if camera.lens is None:
        return 0.0
    columns, rows = camera.resolution
    corners = np.array([[u, v] for u in (-0.5, columns - 0.5) for v in (-0.5, rows - 0.5)])
    focal = np.asarray(camera.focal_length_px)
    seen = (corners - np.asarray(camera.principal_point_px)) / focal
    moved = np.linalg.norm((camera.lens.undistort(seen) - seen) * focal, axis=1)
    return float(moved.max()) if np.isfinite(moved).all() else None


def _is_inspection(path: Path) -> bool:
    """Whether a file has a section ``camera`` and one ``part``."""
    if not path.is_file():
        return False
    text = read_text(path, InspectionFileError)
    if text.startswith("%YAML:1.0"):
        return False
    value = parse_yaml(text, Problems(path)).value
    return isinstance(value, dict) and {"camera", "part"} <= value.keys()
