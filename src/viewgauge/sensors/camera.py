"""The camera, in its optical frame (x right, y down, z forward): a pinhole, a lens that may distort, pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from numbers import Real
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from ..geometry.image_jacobian import point_jacobian
from ..geometry.lens import Lens
from .edge_detector import EdgeDetector

__all__ = ["Camera", "FurtherError"]


def _finite_positive(name: str, value: float) -> None:
    if not (isinstance(value, Real) and math.isfinite(value) and value > 0):
        raise InputError("must be a finite positive number", key=name, got=value)


def _two_numbers(name: str, value: object) -> tuple[float, float]:
    pair = np.asarray(value)
    if pair.shape != (2,) or pair.dtype.kind not in "iuf" or not np.isfinite(pair).all():
        raise InputError("must be two finite numbers, along u and v", key=name, got=value)
    return float(pair[0]), float(pair[1])


class FurtherError(Protocol):
    """An error of the image length that a camera has beside those of its pixels, edges and calibration.

    It is a :class:`~viewgauge.error_sources.LengthError`.
    """

    @property
    def name(self) -> str:
        """By which budgets, knobs and draws name it."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera with a lens that may distort: where it shows points, and how well it finds them.

    It is the first :class:`~viewgauge.sensors.Sensor`.

    An image length is that of the ideal image, without distortion: what is found in the pixels is put where a pinhole
    camera would have seen it, by the calibration, before it is measured.

    Parameters
    ----------
    focal_length_mm
        Distance from the centre of projection to the image plane, mm.
    pixel_pitch_mm
        Width and height of a pixel, mm.
    resolution
        Columns and rows, px.
    edge_resolution_px
        Quantization step of the edge detector, px: 1 is the paper's whole-pixel edge detector, 0.1 a sub-pixel one,
        0 an ideal one. It scales the pixel pitch in quantization only.
    principal_point_px
        Where the optical axis meets the image, px ((0, 0) is the centre of the top-left pixel); by default
        the centre of the image.
    f_number, focus_distance_mm
        Aperture and distance in focus (from the centre of projection, along the optical axis); both or none.
        Without them everything is in focus.
    blur_limit_px
        Largest diameter of the circle of confusion that counts as in focus, px.
    lens
        Distortion; None for a pinhole.
    intrinsics_covariance
        Uncertainty of the calibration: ``(4 + k, 4 + k)`` covariance of fx, fy, cx, cy, px, and the k coefficients
        of the lens, as nested tuples; None where the camera is known exactly.
    edge_detector
        A sub-pixel edge detector, in place of quantization by ``edge_resolution_px``; None for the paper's.
    further_errors
        Errors of the image length beside these (:class:`~viewgauge.error_sources.LengthError`), of different names.
    """

    focal_length_mm: float
    pixel_pitch_mm: tuple[float, float]
    resolution: tuple[int, int]
    edge_resolution_px: float = 1.0
    principal_point_px: tuple[float, float] | None = None
    f_number: float | None = None
    focus_distance_mm: float | None = None
    blur_limit_px: float = 1.0
    lens: Lens | None = None
    intrinsics_covariance: tuple[tuple[float, ...], ...] | None = None
    edge_detector: EdgeDetector | None = None
    further_errors: tuple[FurtherError, ...] = ()

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
        if self.intrinsics_covariance is not None:
            matrix = _require_covariance(self.intrinsics_covariance, 4 + self._coefficients)
            object.__setattr__(self, "intrinsics_covariance", matrix)
        if self.lens is not None and not np.isfinite(self.from_pixels(self.border_px)).all():
            raise InputError(
                "the lens puts two directions in one place of the image",
                key="lens",
                got=f"{self.lens.model} {list(self.lens.coefficients)}",
                expected="distortion that grows outwards up to the corners of the image",
                hint="the calibration's points may not reach the corners: calibrate with fewer coefficients",
            )

    @property
    def _coefficients(self) -> int:
        return 0 if self.lens is None else len(self.lens.coefficients)

    @property
    def is_plain(self) -> bool:
        """Whether it is the paper's camera: a pinhole that is known exactly, with quantization."""
        exact = self.lens is None and self.intrinsics_covariance is None
        return exact and self.edge_detector is None and not self.further_errors

    @property
    def without_errors(self) -> Camera:
        """The same camera, but that it finds points exactly and is known exactly."""
        return replace(self, edge_resolution_px=0.0, intrinsics_covariance=None, edge_detector=None, further_errors=())

    @property
    def border_px(self) -> NDArray[np.float64]:
        """``(n, 2)`` px: points around the border of the image."""
        columns, rows = self.resolution
        along = np.linspace(0.0, 1.0, 33)
        zero, one = np.zeros_like(along), np.ones_like(along)
        sides = [(along, zero), (along, one), (zero, along), (one, along)]
        return np.concatenate([np.stack(side, axis=-1) for side in sides]) * [columns, rows] - 0.5

    @property
    def pitch_tangents(self) -> NDArray[np.float64]:
        """``(2,)``: width and height of a pixel, in tangents of image directions."""
        return np.asarray(self.pixel_pitch_mm) / self.focal_length_mm

    @property
    def principal_point(self) -> tuple[float, float]:
        """Principal point, px: as given, else the centre of the image."""
        if self.principal_point_px is not None:
            return self.principal_point_px
        return ((self.resolution[0] - 1) / 2, (self.resolution[1] - 1) / 2)

    @property
    def quantization_step_mm(self) -> tuple[float, float]:
        """Quantization step of the edge detector along u and v, mm; 0 with a sub-pixel edge detector."""
        if self.edge_detector is not None:
            return (0.0, 0.0)
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
        """Ideal image of points, mm on the image plane from the principal point: u = f X/Z, v = f Y/Z.

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
        """Pixel coordinates ``(..., 2)`` px in which the lens shows ideal image points ``(..., 2)`` mm."""
        image = np.asarray(image_mm, dtype=float)
        if self.lens is not None:
            image = self.lens.distort(image / self.focal_length_mm) * self.focal_length_mm
        return np.asarray(image / np.asarray(self.pixel_pitch_mm) + np.asarray(self.principal_point))

    def from_pixels(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Ideal image points ``(..., 2)`` mm of pixel coordinates ``(..., 2)`` px; NaN where the lens shows nothing."""
        image = (np.asarray(pixels, dtype=float) - np.asarray(self.principal_point)) * np.asarray(self.pixel_pitch_mm)
        if self.lens is not None:
            image = self.lens.undistort(image / self.focal_length_mm) * self.focal_length_mm
        return np.asarray(image)

    def pixel_jacobian(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 2)`` px/mm: derivative of :meth:`to_pixels`."""
        image = np.asarray(image_mm, dtype=float)
        J = np.broadcast_to(np.diag(1 / np.asarray(self.pixel_pitch_mm)), (*image.shape[:-1], 2, 2))
        if self.lens is not None:
            J = J @ self.lens.jacobian(image / self.focal_length_mm)
        return np.asarray(J)

    def pose_jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """Derivative of :meth:`project` with respect to a pose error [x, y, z, rx, ry, rz] at the centre of projection.

        The scene is displaced in the camera frame, ``p' = p + delta x p + d``
        (:func:`~viewgauge.geometry.point_jacobian`). ``pose_jacobian(points) @ error.adjoint`` is the derivative with
        respect to an error in the frame of a :class:`~viewgauge.geometry.PoseError`.

        Parameters
        ----------
        points
            ``(..., 3)`` mm, camera frame. Points with Z <= 0 have no image: NaN.

        Returns
        -------
        ``(..., 2, 6)``: mm/mm for translations, mm/rad for rotations.
        """
        p = np.asarray(points, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            J = point_jacobian(p, self.focal_length_mm)
        return np.where(p[..., 2, None, None] > 0, J, np.nan)

    def pose_jacobian_px(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 6)`` px/mm and px/rad: derivative of the place in the pixels, as :meth:`pose_jacobian`."""
        return np.asarray(self.pixel_jacobian(self.project(points)) @ self.pose_jacobian(points))

    def lines_of_sight(self, pixels: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The lines through the centre of projection of points that the lens shows at places ``(..., 2)`` px.

        Returns
        -------
        A point of each line, the origin of the camera frame, ``(..., 3)`` mm, and its unit direction, ``(..., 3)``,
        camera frame; directions are NaN where the lens shows nothing.
        """
        image = self.from_pixels(pixels)
        depth = np.full((*image.shape[:-1], 1), self.focal_length_mm)
        along = np.concatenate([image, depth], axis=-1)
        return np.zeros_like(along), along / np.linalg.norm(along, axis=-1, keepdims=True)

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


def _require_covariance(matrix: object, size: int) -> tuple[tuple[float, ...], ...]:
    """Nested tuples of a covariance, or InputError."""
    expected = f"{size} rows of {size} numbers: the covariance of fx, fy, cx, cy and the lens's coefficients"
    try:
        values = np.asarray(matrix, dtype=float)
    except (TypeError, ValueError):
        raise InputError("not a matrix", key="intrinsics_covariance", got=matrix, expected=expected) from None
    if values.shape != (size, size) or not np.isfinite(values).all():
        got = f"shape {values.shape}" if np.isfinite(values).all() else "numbers that are not finite"
        raise InputError("not a covariance", key="intrinsics_covariance", got=got, expected=expected)
    deviation = np.sqrt(np.maximum(values.diagonal(), 0.0))
    scale = np.where(deviation > 0, deviation, 1.0)
    correlation = values / np.outer(scale, scale)
    if (values.diagonal() < 0).any():
        got = values.diagonal().tolist()
        raise InputError("not a covariance: a negative variance", key="intrinsics_covariance", got=got)
    if np.abs(correlation - correlation.T).max() > 1e-6:
        expected = "equal entries on both sides of the diagonal"
        raise InputError("not a covariance: not symmetric", key="intrinsics_covariance", expected=expected)
    if float(np.linalg.eigvalsh((correlation + correlation.T) / 2)[0]) < -1e-6:
        raise InputError("not a covariance: some combination has a negative variance", key="intrinsics_covariance")
    return tuple(tuple(float(value) for value in row) for row in (values + values.T) / 2)
