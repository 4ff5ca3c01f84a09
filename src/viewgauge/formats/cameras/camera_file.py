"""Calibrations of cameras as other programs write them: OpenCV, ROS camera_info, Kalibr.

All are YAML. OpenCV's ``FileStorage`` has ``camera_matrix`` and ``distortion_coefficients`` (also under the other
names that its samples use); ROS ``camera_info`` the same with ``image_width``, ``image_height`` and
``distortion_model``, or as the topic shows it (``K``, ``D``, ``width``, ``height``); Kalibr's camchain has a section
for each camera with ``intrinsics``, ``distortion_coeffs`` and ``resolution``. The covariance of the intrinsics is read
where it stands beside them: ``intrinsics_covariance`` (a matrix, in the order fx, fy, cx, cy and the distortion), or
``intrinsics_standard_deviations``.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError, InspectionFileError
from ...geometry import Lens
from ...sensors import Camera
from ..files.atomic import write_text_atomically
from ..files.problems import KeyPath, Problems
from ..files.text import read_text
from ..files.yaml_tree import parse_yaml

__all__ = ["CameraFile", "read_camera_file", "write_opencv_camera"]

_MATRIX = ("camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "K", "k", "M1", "mtx")
_DISTORTION = (
    "distortion_coefficients",
    "distortion_coefficents",  # as ROS once wrote it
    "distCoeffs",
    "dist_coeffs",
    "Distortion_Coefficients",
    "D",
    "d",
    "D1",
    "dist",
)
_SIZE = (("image_width", "image_height"), ("image_Width", "image_Height"), ("width", "height"))
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
_EXPECTED = "an OpenCV YAML, a ROS camera_info or a Kalibr camchain"


@dataclass(frozen=True)
class CameraFile:
    """A calibration, in px.

    Parameters
    ----------
    format
        "OpenCV", "ROS camera_info" or "Kalibr".
    focal_length_px, principal_point_px
        fx and fy, cx and cy; (0, 0) is the centre of the top-left pixel.
    lens
        None without distortion.
    resolution
        Columns and rows; None where the file does not say.
    covariance
        Of fx, fy, cx, cy and the lens's coefficients; None where the file does not say.
    """

    format: str
    focal_length_px: tuple[float, float]
    principal_point_px: tuple[float, float]
    lens: Lens | None
    resolution: tuple[int, int] | None
    covariance: tuple[tuple[float, ...], ...] | None


def read_camera_file(path: str | os.PathLike[str], name: str | None = None) -> CameraFile:
    """Read a calibration.

    Parameters
    ----------
    name
        Which camera of a file that has several (Kalibr), such as ``cam1``; by default its only one.

    Raises
    ------
    InspectionFileError
        With all that is wrong: file, line, key, what was got and what was expected.
    """
    text = read_text(path, InspectionFileError)
    problems = Problems(path)
    plain = text.replace("%YAML:1.0", "#", 1).replace("!!opencv-matrix", "")
    value = parse_yaml(plain, problems).value
    problems.raise_if_any()
    if not isinstance(value, dict):
        problems.add((), "not a calibration of a camera", expected=_EXPECTED)
        problems.raise_if_any()
    assert isinstance(value, dict)
    return _Reader(value, problems, name, "%YAML:1.0" in text).read()


class _Reader:
    def __init__(self, sections: dict[str, Any], problems: Problems, name: str | None, opencv: bool) -> None:
        self.sections, self.problems, self.name, self.opencv = sections, problems, name, opencv

    def read(self) -> CameraFile:
        cameras = [key for key, value in self.sections.items() if isinstance(value, dict) and "intrinsics" in value]
        if cameras:
            found = self._kalibr(cameras)
        else:
            if self.name is not None:
                self.problems.add(
                    (), "the file has one camera without a name", got=self.name, hint="leave the name out"
                )
            found = self._matrices()
        self.problems.raise_if_any()
        assert found is not None
        return found

    def _kalibr(self, cameras: list[str]) -> CameraFile | None:
        name = self.name or (cameras[0] if len(cameras) == 1 else None)
        if name not in cameras:
            problem = "no such camera in the file" if name else "the file has several cameras"
            hint = None if name else "name one: calibration_camera in the inspection file, --name in the command"
            self.problems.add((), problem, got=name, expected=" or ".join(cameras), hint=hint)
            return None
        where, section = (name,), self.sections[name]
        kind = section.get("camera_model", "pinhole")
        if kind != "pinhole":
            self.problems.add((*where, "camera_model"), "unknown camera model", got=kind, expected="pinhole")
        numbers = self._numbers((*where, "intrinsics"), section["intrinsics"], (4,))
        coefficients = self._numbers((*where, "distortion_coeffs"), section.get("distortion_coeffs", []), None)
        size = self._numbers((*where, "resolution"), section.get("resolution"), (2,), optional=True)
        lens = self._lens(str(section.get("distortion_model", "none")), coefficients, (*where, "distortion_model"))
        if numbers is None:
            return None
        resolution = self._resolution((*where, "resolution"), size)
        covariance = self._covariance(section, where, lens)
        focal, centre = (numbers[0], numbers[1]), (numbers[2], numbers[3])
        return self._checked(CameraFile("Kalibr", focal, centre, lens, resolution, covariance), (*where, "intrinsics"))

    def _matrices(self) -> CameraFile | None:
        key = next((key for key in _MATRIX if key in self.sections), None)
        if key is None:
            keys = ", ".join(list(self.sections)[:6])
            self.problems.add((), "no camera matrix", got=f"the keys {keys}", expected=_EXPECTED)
            return None
        matrix = self._matrix((key,), self.sections[key], (3, 3))
        where = next((key for key in _DISTORTION if key in self.sections), None)
        given = self.sections.get(where) if where else []
        values = given.get("data") if isinstance(given, dict) else given
        flat = (
            [item for row in values for item in (row if isinstance(row, list) else [row])]
            if isinstance(values, list)
            else values
        )
        coefficients = self._numbers((where or key,), flat, None)
        model = self.sections.get("distortion_model")
        if model is None:
            fisheye = self.sections.get("fisheye_model") in (1, True)
            model = "equidistant" if fisheye else "plumb_bob"
        lens = self._lens(str(model), coefficients, (where or key,))
        size = next(([self.sections[a], self.sections[b]] for a, b in _SIZE if {a, b} <= self.sections.keys()), None)
        resolution = self._resolution(("image_width",), self._numbers(("image_width",), size, (2,), optional=True))
        covariance = self._covariance(self.sections, (), lens)
        if matrix is None:
            return None
        if abs(matrix[0, 1]) > 1e-6 * abs(matrix[0, 0]):
            self.problems.add((key,), "skew is not known here", got=matrix[0, 1], expected="0 in row 1, column 2")
        ros = "distortion_model" in self.sections and not self.opencv
        focal, centre = (matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2])
        name = "ROS camera_info" if ros else "OpenCV"
        pairs = (float(focal[0]), float(focal[1])), (float(centre[0]), float(centre[1]))
        return self._checked(CameraFile(name, *pairs, lens, resolution, covariance), (key,))

    def _checked(self, found: CameraFile, where: KeyPath) -> CameraFile:
        if min(found.focal_length_px) <= 0:
            self.problems.add(where, "the focal length must be positive", got=list(found.focal_length_px))
        return found

    def _lens(self, model: str, coefficients: list[float] | None, where: KeyPath) -> Lens | None:
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

    def _covariance(
        self, section: dict[str, Any], where: KeyPath, lens: Lens | None
    ) -> tuple[tuple[float, ...], ...] | None:
        if self.problems.found:
            return None  # of a lens that is not known
        size = 4 + (0 if lens is None else len(lens.coefficients))
        if "intrinsics_covariance" in section:
            key = (*where, "intrinsics_covariance")
            matrix = self._matrix(key, section["intrinsics_covariance"], (size, size))
            return None if matrix is None else tuple(tuple(row) for row in matrix.tolist())
        for name in ("intrinsics_standard_deviations", "standard_deviations_intrinsics", "stdDeviationsIntrinsics"):
            if name in section:
                given = section[name]
                values = self._numbers((*where, name), given.get("data") if isinstance(given, dict) else given, None)
                if values is None:
                    return None
                if len(values) < size or any(values[size:]) or min(values) < 0:
                    expected = f"{size} numbers, not negative: of fx, fy, cx, cy and each coefficient"
                    self.problems.add((*where, name), "not standard deviations", got=values, expected=expected)
                return tuple(tuple(row) for row in np.diag(np.square(values[:size])).tolist())
        return None

    def _matrix(self, where: KeyPath, value: object, shape: tuple[int, int]) -> NDArray[np.float64] | None:
        data = value.get("data") if isinstance(value, dict) else value
        rows = data if isinstance(data, list) else None
        flat = [item for row in rows for item in (row if isinstance(row, list) else [row])] if rows else None
        numbers = self._numbers(where, flat, (shape[0] * shape[1],))
        return None if numbers is None else np.array(numbers).reshape(shape)

    def _numbers(
        self, where: KeyPath, value: object, counts: tuple[int, ...] | None, optional: bool = False
    ) -> list[float] | None:
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

    def _resolution(self, where: KeyPath, size: list[float] | None) -> tuple[int, int] | None:
        if size is None:
            return None
        if any(count < 1 or count % 1 for count in size):
            self.problems.add(where, "not columns and rows", got=size, expected="two positive whole numbers")
            return None
        return int(size[0]), int(size[1])


def _is_number(item: object) -> bool:
    return isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item)


def write_opencv_camera(path: str | os.PathLike[str], camera: Camera | CameraFile) -> None:
    """Write a calibration for OpenCV's ``FileStorage``: camera_matrix, distortion_coefficients, and the covariance.

    Every digit is kept. Files of the equidistant model have ``fisheye_model: 1``, as OpenCV's calibration sample.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    if isinstance(camera, Camera):
        focal = [camera.focal_length_mm / pitch for pitch in camera.pixel_pitch_mm]
        centre, covariance = camera.principal_point, camera.intrinsics_covariance
    else:
        focal, centre, covariance = list(camera.focal_length_px), camera.principal_point_px, camera.covariance
    lines = ["%YAML:1.0", "---"]
    if camera.resolution is not None:
        lines += [f"image_width: {camera.resolution[0]}", f"image_height: {camera.resolution[1]}"]
    lines += _opencv_matrix("camera_matrix", [[focal[0], 0.0, centre[0]], [0.0, focal[1], centre[1]], [0.0, 0.0, 1.0]])
    if camera.lens is not None:
        if camera.lens.model == "equidistant":
            lines.append("fisheye_model: 1")
        lines += _opencv_matrix("distortion_coefficients", [[c] for c in camera.lens.coefficients])
    if covariance is not None:
        lines += _opencv_matrix("intrinsics_covariance", [list(row) for row in covariance])
    write_text_atomically(Path(path), "\n".join(lines) + "\n")


def _opencv_matrix(name: str, rows: list[list[float]]) -> list[str]:
    data = ", ".join(repr(float(value)) for row in rows for value in row)
    return [
        f"{name}: !!opencv-matrix",
        f"   rows: {len(rows)}",
        f"   cols: {len(rows[0])}",
        "   dt: d",
        f"   data: [ {data} ]",
    ]
