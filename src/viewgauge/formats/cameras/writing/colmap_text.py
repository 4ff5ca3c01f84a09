"""COLMAP's ``cameras.txt`` with one camera, whose first pixel's centre is at 0.5."""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar

from ...files.atomic import write_text_atomically
from ..camera_file import CameraFile
from .what_is_written import coefficients_within, required_size

__all__ = ["ColmapWriter"]

_COUNTS = {"radial-tangential": (4, 8), "equidistant": (4,)}
_FIRST_PIXEL = 0.5


class ColmapWriter:
    """Writes cameras of COLMAP: PINHOLE, OPENCV, FULL_OPENCV or OPENCV_FISHEYE."""

    name: ClassVar[str] = "COLMAP"

    def write(self, path: str | os.PathLike[str], camera: CameraFile) -> None:
        """Write a calibration; raises InputError where COLMAP cannot hold it."""
        columns, rows = required_size(camera, "COLMAP")
        values = [] if camera.lens is None else coefficients_within(camera, _COUNTS, "COLMAP")
        model = {0: "PINHOLE", 4: "OPENCV", 8: "FULL_OPENCV"}[len(values)]
        if camera.lens is not None and camera.lens.model == "equidistant":
            model = "OPENCV_FISHEYE"
        centre = [c + _FIRST_PIXEL for c in camera.principal_point_px]
        numbers = " ".join(repr(float(value)) for value in (*camera.focal_length_px, *centre, *values))
        lines = [
            "# Camera list with one line of data per camera:",
            "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]",
            "# Number of cameras: 1",
            f"1 {model} {columns} {rows} {numbers}",
        ]
        write_text_atomically(Path(path), "\n".join(lines) + "\n")
