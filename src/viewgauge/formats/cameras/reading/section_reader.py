"""A camera's section read by what all formats share; a format says where it differs by its conventions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ....findings import Finding
from ....geometry import Lens
from ...files.problems import KeyPath, dotted
from ..camera_file import CameraFile, Stated
from ..models.image_size import read_image_size
from ..models.image_window import read_image_window
from ..models.inverse_lens import ImageFrame
from ..models.lens_reach import corner_distance
from ..models.lens_reading import read_lens
from ..models.pinhole import Pinhole, read_pinhole
from ..models.plausible_camera import implausible_calibration
from .calibration_document import CalibrationDocument
from .found_cameras import FoundCamera
from .key_account import KeyAccount
from .key_names import plain_name

__all__ = ["Conventions", "read_camera_section"]

_COVARIANCE = frozenset({"intrinsicscovariance"})
_DEVIATIONS = frozenset({"intrinsicsstandarddeviations", "standarddeviationsintrinsics", "stddeviationsintrinsics"})
_ROLLING = frozenset({"linedelaynanoseconds", "linedelay", "rollingshutterlinedelay"})


@dataclass(frozen=True)
class Conventions:
    """Where a format differs from OpenCV.

    Parameters
    ----------
    format
        The program whose format it is.
    first_pixel
        The coordinate of the centre of the first pixel.
    transposed
        Whether the camera matrix has the principal point in row 3.
    rows_first
        Whether sizes state rows before columns.
    model_numbers
        Names of lens models that are written as numbers.
    """

    format: str
    first_pixel: float = 0.0
    transposed: bool = False
    rows_first: bool = False
    model_numbers: Mapping[int, str] = field(default_factory=dict)


def read_camera_section(
    document: CalibrationDocument, camera: FoundCamera, conventions: Conventions, stated: Stated
) -> CameraFile | None:
    """The calibration in a section, every key of it accounted for; None where a problem was noted."""
    account = camera.account(document)
    size = read_image_size(account, rows_first=conventions.rows_first) or stated.resolution
    pinhole = read_pinhole(account, transposed=conventions.transposed, first_pixel=conventions.first_pixel)
    uncertain = any(plain_name(key) in _COVARIANCE | _DEVIATIONS for key in camera.section)
    frame = None
    if pinhole is not None and size is not None:
        frame = ImageFrame(pinhole.focal_length_px, pinhole.principal_point_px, size)
    lens = read_lens(account, frame, stated, _corner(pinhole, size), conventions.model_numbers, uncertain)
    covariance = None if lens is None else _covariance(account, lens.lens)
    window = read_image_window(account, size)
    rolling = _rolling_shutter(account)
    if not document.problems.found:  # else what is left may follow from them
        account.close()
        camera.close_around(document)
    if pinhole is None or lens is None:
        for finding in pinhole.findings if pinhole else ():  # no calibration takes them along
            document.problems.add(pinhole.where if pinhole else (), finding.found, expected=finding.usual)
        return None
    place = f"{document.path}: {camera.name}" if camera.name else str(document.path)
    numbers = pinhole.focal_length_px, pinhole.principal_point_px
    implausible = implausible_calibration(*numbers, lens.lens, size, place)
    findings = (*pinhole.findings, *lens.findings, *implausible, *rolling)
    notes = lens.notes
    if conventions.first_pixel:
        notes = (*notes, f"principal point less {conventions.first_pixel:g} px: the format counts the first pixel so")
    return window.of(CameraFile(conventions.format, *numbers, lens.lens, size, covariance, findings, notes))


def _corner(pinhole: Pinhole | None, size: tuple[int, int] | None) -> float | None:
    if pinhole is None:
        return None
    if size is None:
        columns, rows = (round(2 * c + 1) for c in pinhole.principal_point_px)
        if columns < 1 or rows < 1:
            return None
        size = (columns, rows)
    return corner_distance(pinhole.focal_length_px, pinhole.principal_point_px, size)


def _covariance(account: KeyAccount, lens: Lens | None) -> tuple[tuple[float, ...], ...] | None:
    """The covariance of the intrinsics, where it or their standard deviations are stated; else None."""
    document = account.document
    size = 4 + (0 if lens is None else len(lens.coefficients))
    entry = account.take(_COVARIANCE)
    deviations = account.take(_DEVIATIONS)
    if entry is not None:
        matrix = document.matrix(entry.where, entry.value, (size, size))
        return None if matrix is None else tuple(tuple(row) for row in matrix.tolist())
    if deviations is None:
        return None
    values = document.numbers(deviations.where, deviations.value, None)
    return None if values is None else _diagonal(document, deviations.where, values, size)


def _diagonal(
    document: CalibrationDocument, where: KeyPath, values: list[float], size: int
) -> tuple[tuple[float, ...], ...] | None:
    if len(values) < size or any(values[size:]) or min(values) < 0:
        expected = f"{size} numbers, not negative: of fx, fy, cx, cy and each coefficient"
        document.problems.add(where, "not standard deviations", got=values, expected=expected)
        return None
    return tuple(tuple(row) for row in np.diag(np.square(values[:size])).tolist())


def _rolling_shutter(account: KeyAccount) -> tuple[Finding, ...]:
    entry = account.take(_ROLLING)
    if entry is None or entry.value is None:
        return ()
    delay = account.document.number(entry.where, entry.value)
    if not delay:
        return ()
    return (
        Finding(
            "rolling_shutter",
            f"the lines of the image are exposed one after the other, {delay:g} ns apart",
            "all lines at once",
            "a rolling shutter, which is not modelled: what moves during the exposure is measured wrong",
            f"{account.document.path}: {dotted(entry.where)}",
        ),
    )
