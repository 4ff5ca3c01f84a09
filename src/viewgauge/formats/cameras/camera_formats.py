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
from .camera_file import CameraFile, Stated
from .colmap import ColmapFormat
from .halcon import HalconFormat
from .kalibr import KalibrFormat
from .matlab import MatlabFormat
from .mrcal import MrcalFormat
from .ncamera import CameraListFormat
from .open3d import Open3dFormat
from .opencv import OpenCvFormat
from .reading.calibration_document import CalibrationDocument
from .realsense import RealSenseFormat
from .ros_camera_info import RosCameraInfoFormat
from .ros_ini import RosIniFormat
from .zed import ZedFormat

__all__ = ["CAMERA_FORMATS", "CameraFormat", "camera_format_of", "read_camera_file"]


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

    @property
    def cannot_say(self) -> str:
        """What a file of this format cannot say, and is asked for or refused; for the page on formats."""
        ...

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether a file is of this format, by its content."""
        ...

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration; None, and the reasons in the document's problems, if it cannot be used.

        Parameters
        ----------
        stated
            Which camera of a file that has several, and what else the file may not say.
        """
        ...


CAMERA_FORMATS: Registry[CameraFormat] = Registry(
    *(MrcalFormat(), HalconFormat(), ColmapFormat(), RosIniFormat(), ZedFormat()),  # by their text
    *(CameraListFormat(), KalibrFormat(), MatlabFormat(), Open3dFormat(), RealSenseFormat(), RosCameraInfoFormat()),
    OpenCvFormat(),
)


def camera_format_of(path: str | os.PathLike[str]) -> CameraFormat | None:
    """The format of a calibration, by its content; None where none is known, or the content cannot be read.

    Raises
    ------
    InspectionFileError
        If the file is not there, or not text.
    """
    document = CalibrationDocument(path, read_text(path, InspectionFileError))
    return next((format_ for format_ in CAMERA_FORMATS if format_.recognises(document)), None)


def read_camera_file(path: str | os.PathLike[str], stated: Stated | str | None = None) -> CameraFile:
    """Read a calibration.

    Parameters
    ----------
    stated
        What the user states beside the file, or only the name of the camera that is meant, such as ``cam1``.

    Raises
    ------
    InspectionFileError
        With all that is wrong: file, line, key, what was got and what was expected. What is implausible stands in the
        calibration's findings, those that are to be refused too.
    """
    document = CalibrationDocument(path, read_text(path, InspectionFileError))
    problems = document.problems
    found = next((format_ for format_ in CAMERA_FORMATS if format_.recognises(document)), None)
    problems.raise_if_any()
    if found is None:
        expected = _any_of([format_.described for format_ in CAMERA_FORMATS][::-1])
        keys = ", ".join(str(key) for key in list(document.sections)[:6])
        if keys:
            problems.add((), "no camera matrix", got=f"the keys {keys}"[:200], expected=expected)
        else:
            problems.add((), "not a calibration of a camera", expected=expected)
    meant = stated if isinstance(stated, Stated) else Stated(stated)
    calibration = None if found is None else found.read(document, meant)
    problems.raise_if_any()
    assert calibration is not None  # a problem would have been noted
    return calibration


def _any_of(names: list[str]) -> str:
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
