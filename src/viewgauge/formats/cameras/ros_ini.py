"""The INI that ROS's calibrator writes: a section for each camera, matrices as rows of numbers below their names."""

from __future__ import annotations

import re
from typing import ClassVar

from .camera_file import CameraFile, Stated
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import FoundCamera, chosen_camera
from .reading.ini_text import is_ini
from .reading.section_reader import Conventions, read_camera_section

__all__ = ["RosIniFormat"]

_CONVENTIONS = Conventions("ROS INI")
_HEADER = re.compile(r"\[([^\[\]]+)\]")


class RosIniFormat:
    """Calibrations of ROS as INI (videre), where the YAML was not kept."""

    name: ClassVar[str] = "ROS INI"
    described: ClassVar[str] = "a ROS .ini"
    cannot_say: ClassVar[str] = "of four coefficients the model: asked (`--model`)"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether the file is an INI with a camera matrix in a section."""
        return is_ini(document.text) and re.search(r"^\s*camera matrix\s*$", document.text, re.M | re.I) is not None

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration of the camera that is meant, by its section's name; None where a problem was noted."""
        sections = _sections(document)
        if document.problems.found:
            return None
        shared: dict[str, object] = {}
        cameras = []
        for name, section in sections.items():
            if "camera_matrix" in section:
                cameras.append(FoundCamera(name, (name,), section))
            elif name.lower() == "image":
                shared = {key: numbers[0] for key, numbers in section.items() if len(numbers) == 1}
            elif name.lower() not in ("externals", "external"):
                document.problems.add(
                    (name,), "the section is not known here", expected="image, externals, or a camera"
                )
        camera = chosen_camera(document, cameras, stated.name)
        if camera is None:
            return None
        whole = FoundCamera(camera.name, camera.where, {**shared, **camera.section})
        return read_camera_section(document, whole, _CONVENTIONS, stated)


def _sections(document: CalibrationDocument) -> dict[str, dict[str, list[float]]]:
    """Numbers by section and name; what is no number is the name of those that follow."""
    found: dict[str, dict[str, list[float]]] = {}
    section, key = "", ""
    for number, line in enumerate(document.text.splitlines(), start=1):
        text = line.strip()
        if not text or text.startswith(("#", ";")):
            continue
        header = _HEADER.fullmatch(text)
        if header is not None:
            section, key = header[1].strip(), ""
            if section in found:
                document.problems.add((section,), "the section is there twice", line=number, hint="remove one")
            found[section] = {}
            continue
        try:
            numbers = [float(word) for word in text.replace(",", " ").split()]
        except ValueError:
            key = text.replace(" ", "_").lower()
            if section and key in found[section]:
                document.problems.add((section, key), "the key is there twice", line=number, hint="remove one")
            if section:
                found[section][key] = []
            continue
        if not section or not key:
            document.problems.add((), "numbers without a name before them", line=number, got=text[:80])
            break
        found[section][key] += numbers
    return found
