"""INI files with a section for each camera and size of its images, as ZED's stereo cameras bring them."""

from __future__ import annotations

import re
from typing import ClassVar

from .camera_file import CameraFile, Stated
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import FoundCamera, chosen_camera, is_camera
from .reading.ini_text import ini_sections, is_ini
from .reading.section_reader import Conventions, read_camera_section

__all__ = ["ZedFormat"]

_CONVENTIONS = Conventions("ZED")
_SIZES = {
    "2K": (2208, 1242),
    "FHD": (1920, 1080),
    "FHD1200": (1920, 1200),
    "HD": (1280, 720),
    "VGA": (672, 376),
    "SVGA": (960, 600),
    "QHDPLUS": (3200, 1800),
    "4K": (3840, 2160),
}
"""Columns and rows of an eye's image, by the end of a section's name."""
_OTHER = re.compile(r"STEREO|MISC|IMU|GENERAL", re.I)


class ZedFormat:
    """Calibrations of ZED cameras: fx, fy, cx, cy, k1, k2, p1, p2, k3 in each section."""

    name: ClassVar[str] = "ZED"
    described: ClassVar[str] = "a ZED .conf"
    cannot_say: ClassVar[str] = "which of its cameras and sizes is meant: asked (`--name LEFT_CAM_HD`)"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether the file is an INI with fx in a section."""
        return is_ini(document.text) and re.search(r"^\s*fx\s*[=:]", document.text, re.M | re.I) is not None

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration of the section that is meant; None where a problem was noted."""
        sections = ini_sections(document.text, document.problems)
        if document.problems.found:
            return None
        cameras = [
            FoundCamera(name, (name,), _with_size(name, section))
            for name, section in sections.items()
            if is_camera(section)
        ]
        for name in sections:
            if not is_camera(sections[name]) and not _OTHER.fullmatch(name):
                expected = "sections of cameras (fx, fy, cx, cy, ...), STEREO, MISC or IMU"
                document.problems.add((name,), "the section is not known here", expected=expected)
        camera = chosen_camera(document, cameras, stated.name)
        return None if camera is None else read_camera_section(document, camera, _CONVENTIONS, stated)


def _with_size(name: str, section: dict[str, object]) -> dict[str, object]:
    size = _SIZES.get(name.upper().rpartition("_")[2])
    known = {"width", "height", "image_width", "image_height"} & section.keys()
    return section if size is None or known else {**section, "image_size": list(size)}
