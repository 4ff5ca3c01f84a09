"""A camchain of Kalibr with one camera, cam0."""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar

from ...files.atomic import write_text_atomically
from ..camera_file import CameraFile
from .what_is_written import coefficients_within, listed, required_size

__all__ = ["KalibrWriter"]

_COUNTS = {"radial-tangential": (4,), "equidistant": (4,)}


class KalibrWriter:
    """Writes camchains of Kalibr, whose lenses have four coefficients."""

    name: ClassVar[str] = "Kalibr"

    def write(self, path: str | os.PathLike[str], camera: CameraFile) -> None:
        """Write a calibration; raises InputError where Kalibr cannot hold it."""
        size = required_size(camera, "Kalibr")
        values = [] if camera.lens is None else coefficients_within(camera, _COUNTS, "Kalibr")
        model = "none"
        if camera.lens is not None:
            model = "equidistant" if camera.lens.model == "equidistant" else "radtan"
        lines = [
            "cam0:",
            "  camera_model: pinhole",
            f"  intrinsics: {listed([*camera.focal_length_px, *camera.principal_point_px])}",
            f"  distortion_model: {model}",
            f"  distortion_coeffs: {listed(values)}",
            f"  resolution: [{size[0]}, {size[1]}]",
        ]
        write_text_atomically(Path(path), "\n".join(lines) + "\n")
