"""Calibrations of cameras as other programs write them, each format recognised by its content.

A further format is a class like :class:`CameraFormat` in a file of its own, and its place in ``CAMERA_FORMATS``, or
``CAMERA_FORMATS.register(...)`` from outside. The covariance of the intrinsics is read where it stands beside them, in
any format: ``intrinsics_covariance`` (a matrix, in the order fx, fy, cx, cy and the distortion), or
``intrinsics_standard_deviations``.
"""

from __future__ import annotations

import os
from typing import Protocol

from ...exceptions import InspectionFileError
from ..files.registry import Registry
from ..files.text import read_text
from .camera_file import CalibrationDocument, CameraFile
from .kalibr import KalibrFormat
from .opencv import OpenCvFormat
from .ros_camera_info import RosCameraInfoFormat

__all__ = ["CAMERA_FORMATS", "CameraFormat", "read_camera_file"]


class CameraFormat(Protocol):
    """Reads one format of calibrations."""

    @property
    def name(self) -> str:
        """The program whose format it is: "OpenCV"."""
        ...

    @property
    def described(self) -> str:
        """What is expected, in messages: "an OpenCV YAML"."""
        ...

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether a file is of this format, by its content."""
        ...

    def read(self, document: CalibrationDocument, name: str | None) -> CameraFile | None:
        """The calibration; None, and the reasons in the document's problems, if it cannot be used.

        Parameters
        ----------
        name
            Which camera of a file that has several; None where it was not said.
        """
        ...


CAMERA_FORMATS: Registry[CameraFormat] = Registry(KalibrFormat(), RosCameraInfoFormat(), OpenCvFormat())


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
    document = CalibrationDocument(path, read_text(path, InspectionFileError))
    problems = document.problems
    found = next((format_ for format_ in CAMERA_FORMATS if format_.recognises(document)), None)
    problems.raise_if_any()
    if found is None:
        expected = _any_of([format_.described for format_ in CAMERA_FORMATS][::-1])
        keys = ", ".join(list(document.sections)[:6])
        if keys:
            problems.add((), "no camera matrix", got=f"the keys {keys}", expected=expected)
        else:
            problems.add((), "not a calibration of a camera", expected=expected)
    calibration = None if found is None else found.read(document, name)
    problems.raise_if_any()
    assert calibration is not None  # a problem would have been noted
    return calibration


def _any_of(names: list[str]) -> str:
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
