"""A camera's calibration: read in any of the formats, reported, and written for OpenCV."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..exceptions import InputError, InspectionFileError
from ..findings import admit
from ..formats.cameras.camera_file import CameraFile, Stated
from ..formats.cameras.camera_formats import read_camera_file
from ..formats.cameras.opencv import write_opencv_camera
from ..formats.files.problems import Problems
from ..formats.files.text import read_text
from ..formats.files.yaml_tree import parse_yaml
from ..formats.inspection.inspection_file import read_inspection_file

__all__ = ["Stated", "describe_calibration", "is_inspection", "parse_size", "read_calibration", "write_opencv_camera"]


def read_calibration(
    path: str | os.PathLike[str], stated: Stated | str | None = None, accept: Iterable[str] = ()
) -> CameraFile:
    """The calibration in a file of any known format, or of the camera of an inspection file.

    Its findings are those that are not accepted.

    Parameters
    ----------
    stated
        What the user states because the file may not say it, or only the name of one of its cameras, such as ``cam1``.
    accept
        Names of findings that the user accepts.

    Raises
    ------
    InputError
        With all that is wrong, or what is too implausible to be used unless it is accepted.
    """
    meant = stated if isinstance(stated, Stated) else Stated(stated)
    if not is_inspection(Path(path)):
        camera = read_camera_file(path, meant)
        if meant.resolution is not None and camera.resolution != meant.resolution:
            raise InspectionFileError(
                "the calibration is of images of another size",
                file=path,
                got=f"{meant.resolution[0]} x {meant.resolution[1]}",
                expected=None if camera.resolution is None else f"{camera.resolution[0]} x {camera.resolution[1]}",
            )
        return replace(camera, findings=admit(camera.findings, tuple(accept)))
    if meant.name is not None:
        raise InspectionFileError("an inspection has one camera", file=path, got=meant.name, hint="leave the name out")
    if meant != Stated():
        raise InspectionFileError("an inspection says it", file=path, key="camera", hint="leave model and size out")
    of_inspection = read_inspection_file(path).setup.camera
    focal = [of_inspection.principal_distance_mm / pitch for pitch in of_inspection.pixel_pitch_mm]
    return CameraFile(
        "inspection file",
        (focal[0], focal[1]),
        of_inspection.principal_point,
        of_inspection.lens,
        of_inspection.resolution,
        of_inspection.intrinsics_covariance,
    )


def parse_size(text: str) -> tuple[int, int]:
    """Columns and rows of a text such as ``1920x1080``; raises InputError."""
    match = re.fullmatch(r"\s*(\d{1,6})\s*[xX×, ]\s*(\d{1,6})\s*", text)
    if match is None or "0" in (match[1].lstrip("0") or "0", match[2].lstrip("0") or "0"):
        raise InputError("not the size of an image", key="--size", got=text, expected="columns x rows: 1920x1080")
    return int(match[1]), int(match[2])


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
        "notes": list(camera.notes),
        "findings": [finding.document() for finding in camera.findings],
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


def is_inspection(path: Path) -> bool:
    """Whether a file has a section ``camera`` and one ``part``."""
    if not path.is_file():
        return False
    text = read_text(path, InspectionFileError)
    if not all(re.search(rf"^\s*[\"']?{section}[\"']?\s*:", text, re.M) for section in ("camera", "part")):
        return False
    value = parse_yaml(text, Problems(path)).value
    return isinstance(value, dict) and {"camera", "part"} <= value.keys()
