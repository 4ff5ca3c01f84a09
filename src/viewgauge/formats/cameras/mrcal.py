"""mrcal's ``.cameramodel``: a mapping in Python's syntax, with ``lensmodel``, ``intrinsics`` and ``imagersize``."""

from __future__ import annotations

import ast
import re
from typing import Any, ClassVar

from .camera_file import CameraFile, Stated
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import FoundCamera, only_or_named
from .reading.section_reader import Conventions, read_camera_section

__all__ = ["MrcalFormat"]

_CONVENTIONS = Conventions("mrcal")
_KEY = re.compile(r"""['"](?:lensmodel|lens_model|distortion_model)['"]\s*:\s*b?['"](?:LENSMODEL|DISTORTION)_""")
_COUNTS = {"PINHOLE": 0, "NONE": 0, "OPENCV4": 4, "OPENCV5": 5, "OPENCV8": 8, "OPENCV12": 12}


class MrcalFormat:
    """Camera models of mrcal and mrgingham's relatives."""

    name: ClassVar[str] = "mrcal"
    described: ClassVar[str] = "an mrcal cameramodel"
    cannot_say: ClassVar[str] = "nothing; CAHVOR, CAHVORE, splined and wide projections are refused by name"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether there is a lens model by one of mrcal's names."""
        return _KEY.search(document.text) is not None

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration; None where a problem was noted."""
        section = _values(document)
        if section is None or only_or_named(document, [""], stated.name) is None:
            return None
        key = next((key for key in ("lensmodel", "lens_model", "distortion_model") if key in section), "lensmodel")
        model = str(section.pop(key, "")).removeprefix("LENSMODEL_").removeprefix("DISTORTION_")
        if model not in _COUNTS:
            expected = ", ".join(f"LENSMODEL_{name}" for name in _COUNTS if name != "NONE")
            hint = "convert it to LENSMODEL_OPENCV8 with mrcal-convert-lensmodel"
            document.problems.add((key,), "the lens model is not known here", got=model, expected=expected, hint=hint)
            return None
        numbers = document.numbers(("intrinsics",), section.pop("intrinsics", None), (4 + _COUNTS[model],))
        if numbers is None:
            return None
        section["intrinsics"] = numbers[:4]
        section["distortion_model"] = "radial-tangential" if _COUNTS[model] else "none"
        if _COUNTS[model]:
            section["distortion_coefficients"] = numbers[4:]
        return read_camera_section(document, FoundCamera("", (), section), _CONVENTIONS, stated)


def _values(document: CalibrationDocument) -> dict[str, Any] | None:
    try:
        value = ast.literal_eval(document.text.strip())
    except (ValueError, SyntaxError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", None)
        document.problems.add((), "not an mrcal cameramodel: not valid syntax", line=line, expected="a mapping in { }")
        return None
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
        document.problems.add((), "not an mrcal cameramodel", expected="a mapping with lensmodel and intrinsics")
        return None
    return {key: _listed(item) for key, item in value.items()}


def _listed(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return [_listed(item) for item in value]
    return value.decode("latin-1") if isinstance(value, bytes) else value
