"""The pinhole camera, in its optical frame (x right, y down, z forward)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError

__all__ = ["Camera"]


def _finite_positive(name: str, value: float) -> None:
    if not (isinstance(value, Real) and math.isfinite(value) and value > 0):
        raise InputError("must be a finite positive number", key=name, got=value)


def _two_numbers(name: str, value: object) -> tuple[float, float]:
    pair = np.asarray(value)
    if pair.shape != (2,) or pair.dtype.kind not in "iuf" or not np.isfinite(pair).all():
        raise InputError("must be two finite numbers, along u and v", key=name, got=value)
    return float(pair[0]), float(pair[1])


@dataclass(frozen=True)
class Camera:
    """A pinhole camera without distortion.

    Parameters
    ----------
    focal_length_mm
        Distance from the centre of projection to the image plane, mm.
    pixel_pitch_mm
        Width and height of a pixel, mm.
    resolution
        Columns and rows, px.
    edge_resolution_px
        Quantization step of the edge locator, px: 1 is the paper's whole-pixel locator, 0.1 a sub-pixel one,
        0 an ideal one. It scales the pixel pitch in quantization only.
    principal_point_px
        Where the optical axis meets the image, px ((0, 0) is the centre of the top-left pixel); by default
        the centre of the image.
    f_number, focus_distance_mm
        Aperture and distance in focus (from the centre of projection, along the optical axis); both or none.
        Without them everything is in focus.
    blur_limit_px
        Largest diameter of the circle of confusion that counts as in focus, px.
    """

    focal_length_mm: float
    pixel_pitch_mm: tuple[float, float]
    resolution: tuple[int, int]
    edge_resolution_px: float = 1.0
    principal_point_px: tuple[float, float] | None = None
    f_number: float | None = None
    focus_distance_mm: float | None = None
    blur_limit_px: float = 1.0

    def __post_init__(self) -> None:
        _finite_positive("focal_length_mm", self.focal_length_mm)
        for pitch in _two_numbers("pixel_pitch_mm", self.pixel_pitch_mm):
            _finite_positive("pixel_pitch_mm", pitch)
        for count in _two_numbers("resolution", self.resolution):
            if count != int(count) or count < 1:
                raise InputError("must be two positive whole numbers", key="resolution", got=self.resolution)
        if not (math.isfinite(self.edge_resolution_px) and self.edge_resolution_px >= 0):
            raise InputError("must be finite and not negative", key="edge_resolution_px", got=self.edge_resolution_px)
        if self.principal_point_px is not None:
            _two_numbers("principal_point_px", self.principal_point_px)
        _finite_positive("blur_limit_px", self.blur_limit_px)
        if (self.f_number is None) != (self.focus_distance_mm is None):
            raise InputError(
                "an aperture needs a focus distance and the other way round",
                got=f"f_number={self.f_number}, focus_distance_mm={self.focus_distance_mm}",
            )
        if self.f_number is not None and self.focus_distance_mm is not None:
            _finite_positive("f_number", self.f_number)
            _finite_positive("focus_distance_mm", self.focus_distance_mm)
            if self.focus_distance_mm <= self.focal_length_mm:
                raise InputError(
                    "the focus distance must be longer than the focal length",
                    key="focus_distance_mm",
                    got=f"{self.focus_distance_mm} mm with a focal length of {self.focal_length_mm} mm",
                )

    @property
    def principal_point(self) -> tuple[float, float]:
        """Principal point, px: as given, else the centre of the image."""
        if self.principal_point_px is not None:
            return self.principal_point_px
        return ((self.resolution[0] - 1) / 2, (self.resolution[1] - 1) / 2)

    @property
    def quantization_step_mm(self) -> tuple[float, float]:
        """Quantization step of the edge locator along u and v, mm."""
        pitch_u, pitch_v = self.pixel_pitch_mm
        return (pitch_u * self.edge_resolution_px, pitch_v * self.edge_resolution_px)

    @property
    def half_field_of_view_rad(self) -> tuple[float, float]:
        """Half the angle of view along u and v, rad, for a centred principal point."""
        u, v = (
            float(np.arctan(n * pitch / 2 / self.focal_length_mm))
            for n, pitch in zip(self.resolution, self.pixel_pitch_mm, strict=True)
        )
        return (u, v)

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Image of points, mm on the image plane from the principal point: u = f X/Z, v = f Y/Z.

        Parameters
        ----------
        points
            ``(..., 3)`` mm, camera frame. Points with Z <= 0 have no image: NaN.

        Returns
        -------
        ``(..., 2)`` mm.
        """
        p = np.asarray(points, dtype=float)
        depth = p[..., 2:3]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(depth > 0, self.focal_length_mm * p[..., :2] / depth, np.nan)

    def to_pixels(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """Pixel coordinates ``(..., 2)`` px of image points ``(..., 2)`` mm."""
        pixels = np.asarray(image_mm, dtype=float) / np.asarray(self.pixel_pitch_mm)
        return np.asarray(pixels + np.asarray(self.principal_point))

    def blur_px(self, depth_mm: ArrayLike) -> NDArray[np.float64]:
        """Diameter of the circle of confusion of a point at a depth, px (thin lens; 0 without an aperture).

        c = (f/N) · |Z − Zf|/Z · f/(Zf − f), with Z from the centre of projection.

        Parameters
        ----------
        depth_mm
            Depth Z along the optical axis, mm, any shape.

        References
        ----------
        Ray, *Applied Photographic Optics*, 3rd ed., ch. 22.
        """
        depth = np.asarray(depth_mm, dtype=float)
        if self.f_number is None or self.focus_distance_mm is None:
            return np.zeros_like(depth)
        aperture_mm = self.focal_length_mm / self.f_number
        magnification = self.focal_length_mm / (self.focus_distance_mm - self.focal_length_mm)
        with np.errstate(divide="ignore", invalid="ignore"):
            blur_mm = aperture_mm * np.abs(depth - self.focus_distance_mm) / depth * magnification
        return np.where(depth > 0, blur_mm / min(self.pixel_pitch_mm), np.inf)
