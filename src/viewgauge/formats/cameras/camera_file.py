"""A calibration as it was read, and what a user states beside the file."""

from __future__ import annotations

from dataclasses import dataclass

from ...findings import Finding
from ...geometry import Lens

__all__ = ["CameraFile", "Stated"]


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
    findings
        What is implausible in it.
    notes
        What was converted on reading, one sentence each.
    """

    format: str
    focal_length_px: tuple[float, float]
    principal_point_px: tuple[float, float]
    lens: Lens | None
    resolution: tuple[int, int] | None
    covariance: tuple[tuple[float, ...], ...] | None
    findings: tuple[Finding, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Stated:
    """What a user states because a file may not say it.

    Parameters
    ----------
    name
        Which camera of a file that has several.
    model
        The lens model: fisheye, radial-tangential, none, or another name of these.
    resolution
        Columns and rows of the image.
    """

    name: str | None = None
    model: str | None = None
    resolution: tuple[int, int] | None = None
