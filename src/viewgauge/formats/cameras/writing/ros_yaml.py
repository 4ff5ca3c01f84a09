"""ROS ``camera_info`` as its calibrator writes it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar

from ...files.atomic import write_text_atomically
from ..camera_file import CameraFile
from .what_is_written import coefficients_within, listed, required_size

__all__ = ["RosWriter"]

_COUNTS = {"radial-tangential": (5, 8), "equidistant": (4,)}


class RosWriter:
    """Writes ROS camera_info. The rectified image, which ROS wants described too, is that of the same pinhole."""

    name: ClassVar[str] = "ROS camera_info"

    def write(self, path: str | os.PathLike[str], camera: CameraFile) -> None:
        """Write a calibration; raises InputError where ROS cannot hold it."""
        columns, rows = required_size(camera, "ROS")
        (fx, fy), (cx, cy) = camera.focal_length_px, camera.principal_point_px
        values = [0.0] * 5 if camera.lens is None else coefficients_within(camera, _COUNTS, "ROS")
        model = "plumb_bob" if len(values) == 5 else "rational_polynomial"
        if camera.lens is not None and camera.lens.model == "equidistant":
            model = "equidistant"
        lines = [f"image_width: {columns}", f"image_height: {rows}", "camera_name: camera"]
        lines += _matrix("camera_matrix", 3, 3, [fx, 0, cx, 0, fy, cy, 0, 0, 1])
        lines.append(f"distortion_model: {model}")
        lines += _matrix("distortion_coefficients", 1, len(values), values)
        lines += _matrix("rectification_matrix", 3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])
        lines += _matrix("projection_matrix", 3, 4, [fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0])
        write_text_atomically(Path(path), "\n".join(lines) + "\n")


def _matrix(name: str, rows: int, columns: int, values: list[float]) -> list[str]:
    return [f"{name}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: {listed(values)}"]
