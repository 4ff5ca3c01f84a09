"""A calibration file as it is read: its text, its values, and checks that all formats share."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import Lens
from ..files.problems import KeyPath, Problems
from ..files.yaml_tree import parse_yaml

__all__ = ["CalibrationDocument", "CameraFile"]

_MODELS = {
    "plumb_bob": "radial-tangential",
    "rational_polynomial": "radial-tangential",
    "radtan": "radial-tangential",
    "radial-tangential": "radial-tangential",
    "equidistant": "equidistant",
    "equi": "equidistant",
    "fisheye": "equidistant",
    "none": None,
    "": None,
}


@dataclass(frozen=True)
class CameraFile:
    """A calibration, in px.

    Parameters
    ----------
    format
        The program whose format it is, such as "OpenCV".
    focal_length_px, principal_point_px
        fx and fy, cx and cy; (0, 0) is the centre of the top-left pixel.
    lens
        None without distortion.
    resolution
        Columns and rows; None where the file does not say.
    covariance
        Covariance of fx, fy, cx, cy and the lens's coefficients; None where the file does not say.
    """

    format: str
    focal_length_px: tuple[float, float]
    principal_point_px: tuple[float, float]
    lens: Lens | None
    resolution: tuple[int, int] | None
    covariance: tuple[tuple[float, ...], ...] | None


class CalibrationDocument:
    """A file that may be a calibration, with the problems that were found in it.

    Parameters
    ----------
    text
        The whole file.
    """

    def __init__(self, path: str | os.PathLike[str], text: str) -> None:
        self.path, self.text, self.problems = path, text, Problems(path)

    @cached_property
    def sections(self) -> dict[str, Any]:
        """Its keys, where it is YAML (OpenCV's dialect too); none where it is not."""
        plain = self.text.replace("%YAML:1.0", "#", 1).replace("!!opencv-matrix", "")
        value = parse_yaml(plain, self.problems).value
        return value if isinstance(value, dict) else {}

    @property
    def is_opencv(self) -> bool:
        """Whether OpenCV's ``FileStorage`` has written it, by its first line."""
        return "%YAML:1.0" in self.text

    def checked(self, found: CameraFile, where: KeyPath) -> CameraFile:
        """The calibration; a focal length that is not positive is a problem."""
        if min(found.focal_length_px) <= 0:
            self.problems.add(where, "the focal length must be positive", got=list(found.focal_length_px))
        return found

    def lens(self, model: str, coefficients: list[float] | None, where: KeyPath) -> Lens | None:
        """The lens of a model by any of its names; None without distortion, or where a problem was noted."""
        if coefficients is None:
            return None
        name = model.lower()
        if name not in _MODELS:
            expected = ", ".join(key for key in _MODELS if key)
            self.problems.add(where, "unknown distortion model", got=model, expected=expected)
            return None
        kind = _MODELS[name]
        if kind is None or not coefficients:
            return None
        if kind == "radial-tangential" and len(coefficients) == 14:
            if any(coefficients[12:]):
                self.problems.add(where, "a tilted sensor is not known here", got=coefficients[12:], expected="0, 0")
            coefficients = coefficients[:12]
        try:
            return Lens(kind, tuple(coefficients))
        except InputError as error:
            self.problems.add(where, error.problem, got=error.got, expected=error.expected)
            return None

    def covariance(
        self, section: dict[str, Any], where: KeyPath, lens: Lens | None
    ) -> tuple[tuple[float, ...], ...] | None:
        """The covariance of the intrinsics, where it or their standard deviations are stated beside them; else None."""
        if self.problems.found:
            return None  # of a lens that is not known
        size = 4 + (0 if lens is None else len(lens.coefficients))
        if "intrinsics_covariance" in section:
            key = (*where, "intrinsics_covariance")
            matrix = self.matrix(key, section["intrinsics_covariance"], (size, size))
            return None if matrix is None else tuple(tuple(row) for row in matrix.tolist())
        for name in ("intrinsics_standard_deviations", "standard_deviations_intrinsics", "stdDeviationsIntrinsics"):
            if name in section:
                given = section[name]
                values = self.numbers((*where, name), given.get("data") if isinstance(given, dict) else given, None)
                if values is None:
                    return None
                if len(values) < size or any(values[size:]) or min(values) < 0:
                    expected = f"{size} numbers, not negative: of fx, fy, cx, cy and each coefficient"
                    self.problems.add((*where, name), "not standard deviations", got=values, expected=expected)
                return tuple(tuple(row) for row in np.diag(np.square(values[:size])).tolist())
        return None

    def matrix(self, where: KeyPath, value: object, shape: tuple[int, int]) -> NDArray[np.float64] | None:
        """A matrix as rows, as one row, or as OpenCV's mapping with ``data``; None where a problem was noted."""
        data = value.get("data") if isinstance(value, dict) else value
        rows = data if isinstance(data, list) else None
        flat = [item for row in rows for item in (row if isinstance(row, list) else [row])] if rows else None
        numbers = self.numbers(where, flat, (shape[0] * shape[1],))
        return None if numbers is None else np.array(numbers).reshape(shape)

    def numbers(
        self, where: KeyPath, value: object, counts: tuple[int, ...] | None, optional: bool = False
    ) -> list[float] | None:
        """Finite numbers, of one of the counts; None where there are none or a problem was noted."""
        if value is None and optional:
            return None
        expected = "finite numbers" if counts is None else f"{' or '.join(map(str, counts))} finite numbers"
        if not isinstance(value, list) or not all(_is_number(item) for item in value):
            self.problems.add(where, "not a list of numbers", got=value, expected=expected)
            return None
        if counts is not None and len(value) not in counts:
            self.problems.add(where, "another number of values", got=f"{len(value)} values", expected=expected)
            return None
        return [float(item) for item in value]

    def resolution(self, where: KeyPath, size: list[float] | None) -> tuple[int, int] | None:
        """Columns and rows; None where there are none or a problem was noted."""
        if size is None:
            return None
        if any(count < 1 or count % 1 for count in size):
            self.problems.add(where, "not columns and rows", got=size, expected="two positive whole numbers")
            return None
        return int(size[0]), int(size[1])


def _is_number(item: object) -> bool:
    return isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item)
