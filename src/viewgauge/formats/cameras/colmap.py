"""COLMAP's ``cameras.txt``: a line a camera, whose first pixel's centre has the coordinate 0.5."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import ClassVar

from .camera_file import CameraFile, Stated
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import FoundCamera, only_or_named
from .reading.section_reader import Conventions, read_camera_section

__all__ = ["ColmapFormat"]

_CONVENTIONS = Conventions("COLMAP", first_pixel=0.5)
_LINE = re.compile(r"^\s*\d+\s+[A-Z][A-Z0-9_]*\s+\d+\s+\d+(\s+[-+0-9.eE]+)+\s*$", re.M)
_CAMERA_FIELDS = 4  # id, model, columns, rows


@dataclass(frozen=True)
class _Model:
    """The order of a model's parameters, and how the lens is called here."""

    parameters: tuple[str, ...]
    lens: str


_MODELS = {
    "SIMPLE_PINHOLE": _Model(("f", "cx", "cy"), "none"),
    "PINHOLE": _Model(("fx", "fy", "cx", "cy"), "none"),
    "SIMPLE_RADIAL": _Model(("f", "cx", "cy", "k1"), "radial-tangential"),
    "RADIAL": _Model(("f", "cx", "cy", "k1", "k2"), "radial-tangential"),
    "OPENCV": _Model(("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"), "radial-tangential"),
    "FULL_OPENCV": _Model(
        ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"), "radial-tangential"
    ),
    "OPENCV_FISHEYE": _Model(("fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"), "fisheye"),
    "SIMPLE_RADIAL_FISHEYE": _Model(("f", "cx", "cy", "k1"), "fisheye"),
    "RADIAL_FISHEYE": _Model(("f", "cx", "cy", "k1", "k2"), "fisheye"),
}
_ORDER = {
    "none": (),
    "radial-tangential": ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    "fisheye": ("k1", "k2", "k3", "k4"),
}


class ColmapFormat:
    """Cameras of COLMAP, as text."""

    name: ClassVar[str] = "COLMAP"
    described: ClassVar[str] = "COLMAP's cameras.txt"
    cannot_say: ClassVar[str] = "nothing; FOV and THIN_PRISM_FISHEYE are refused by name"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether the file has COLMAP's heading, or nothing but lines of cameras."""
        if document.text.lstrip().startswith("# Camera list with one line of data per camera"):
            return True
        lines = _lines(document.text)
        return bool(lines) and all(_LINE.match(line) for _, line in lines)

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration of the camera that is meant, by its id; None where a problem was noted."""
        cameras = {line.split()[0]: (number, line.split()) for number, line in _lines(document.text)}
        if len(cameras) < len(_lines(document.text)):
            document.problems.add((), "two cameras have one id", expected="an id for each camera")
            return None
        if not cameras:
            document.problems.add(
                (), "the file has no camera", expected="a line a camera: id, model, columns, rows, ..."
            )
            return None
        name = only_or_named(document, list(cameras), stated.name)
        if name is None:
            return None
        number, words = cameras[name]
        document.problems.lines = {(name,): number}
        section = _section(document, name, words)
        if section is None:
            return None
        return read_camera_section(document, FoundCamera(name, (name,), section), _CONVENTIONS, stated)


def _lines(text: str) -> list[tuple[int, str]]:
    return [
        (number, line.strip())
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


def _section(document: CalibrationDocument, name: str, words: list[str]) -> dict[str, object] | None:
    """A camera's line as the keys of a section; None where a problem was noted."""
    problems, where = document.problems, (name,)
    model = _MODELS.get(words[1]) if len(words) > 1 else None
    if model is None:
        got = words[1] if len(words) > 1 else " ".join(words)
        problems.add(where, "unknown camera model", got=got, expected=", ".join(_MODELS))
        return None
    try:
        numbers = [float(word) for word in words[2:]]
    except ValueError:
        problems.add(where, "not a list of numbers", got=" ".join(words[2:])[:80])
        return None
    size, values = numbers[:2], numbers[2:]
    if len(values) != len(model.parameters):
        expected = f"columns, rows and {len(model.parameters)} parameters: {', '.join(model.parameters)}"
        problems.add(where, "another number of parameters", got=f"{len(values)} parameters", expected=expected)
        return None
    named = dict(zip(model.parameters, values, strict=True))
    focal = [named.get("fx", named.get("f")), named.get("fy", named.get("f"))]
    section: dict[str, object] = {
        "intrinsics": [*focal, named["cx"], named["cy"]],
        "image_size": size,
        "distortion_model": model.lens,
    }
    order = _ORDER[model.lens]
    if order:
        count = 8 if "k4" in named and model.lens == "radial-tangential" else 4
        section["distortion_coefficients"] = [named.get(each, 0.0) for each in order[:count]]
    return section
