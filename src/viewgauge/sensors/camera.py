"""The camera, in its optical frame (x right, y down, z forward): a pinhole, a lens that may distort, pixels."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from ..geometry.image_jacobian import point_jacobian
from ..geometry.lens import WIDEST_TANGENT, Lens
from .edge_detector import EdgeDetector
from .intrinsics_covariance import require_covariance
from .usable_region import UsableRegion, depths_in_region

__all__ = ["Camera", "FurtherError"]

_LEAST_FIELD = 0.25  # of the image's shorter side, from the principal point


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
        The lens's nominal focal length, mm. The distance from the centre of projection to the image plane is
        :attr:`principal_distance_mm`, which follows from it and the focus distance.
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
        Aperture, and distance in focus (from the centre of projection, along the optical axis). An aperture needs a
        focus distance; without an aperture everything is in focus.
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
    usable_region
        Where in the image the camera is used; None for all of it.
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
    usable_region: UsableRegion | None = None
    _field_tangent: float = field(init=False, repr=False, compare=False, default=math.inf)

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
        if self.f_number is not None:
            _finite_positive("f_number", self.f_number)
            if self.focus_distance_mm is None:
                raise InputError(
                    "an aperture needs a focus distance",
                    got=f"f_number={self.f_number} and no focus distance",
                    hint="state the distance in focus as well",
                )
        if self.focus_distance_mm is not None:
            _finite_positive("focus_distance_mm", self.focus_distance_mm)
            if self.focus_distance_mm <= self.focal_length_mm:
                raise InputError(
                    "the focus distance must be longer than the focal length",
                    key="focus_distance_mm",
                    got=f"{self.focus_distance_mm} mm with a focal length of {self.focal_length_mm} mm",
                )
            _finite_positive("focus_distance_mm", self.principal_distance_mm)  # no number where nearly f
        if self.intrinsics_covariance is not None:
            matrix = require_covariance(self.intrinsics_covariance, 4 + self._coefficients)
            object.__setattr__(self, "intrinsics_covariance", matrix)
        if self.lens is not None:
            object.__setattr__(self, "_field_tangent", self._limit_of_field(self.lens))

    def _limit_of_field(self, lens: Lens) -> float:
        """Largest tangent of an image direction that is used: infinite where the lens shows the whole image."""
        image = lens.undistort((self.border_of_sensor_px - self.principal_point) * self.pitch_tangents)
        if np.isfinite(image).all() and np.linalg.norm(image, axis=-1).max() <= WIDEST_TANGENT:
            return math.inf
        limit = lens.field_tangent
        radius = _field_radius_px(lens, limit, self.pitch_tangents)
        if not radius >= _LEAST_FIELD * min(self.resolution):
            raise InputError(
                "the lens puts two directions in one place of the image",
                key="lens",
                got=f"{lens.model} {list(lens.coefficients)}: it turns back {radius:.0f} px from the principal point",
                expected="distortion that grows outwards over most of the image",
                hint="the calibration's points may not reach the corners: calibrate with fewer coefficients",
            )
        return limit

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
    def principal_distance_mm(self) -> float:
        """Distance from the centre of projection to the image plane, mm: c = f u/(u - f), focused at u (thin lens).

        It is the focal length where no focus distance is given.

        References
        ----------
        Ray, *Applied Photographic Optics*, 3rd ed., ch. 4.
        """
        if self.focus_distance_mm is None:
            return self.focal_length_mm
        return self.focal_length_mm / (1 - self.focal_length_mm / self.focus_distance_mm)

    @property
    def field_tangent(self) -> float:
        """Tangent of the largest angle from the optical axis that is used; infinite where the whole image is.

        A lens is used only as far as its model gives each place of the image one direction, below 90 deg.
        """
        return self._field_tangent

    @property
    def field_radius_px(self) -> float | None:
        """Distance from the principal point within which the image is used, px; None where the whole image is."""
        if self.lens is None or not math.isfinite(self._field_tangent):
            return None
        return _field_radius_px(self.lens, self._field_tangent, self.pitch_tangents)

    def is_used(self, pixels: ArrayLike) -> NDArray[np.bool_]:
        """``(...)``: whether places ``(..., 2)`` px lie in the usable region, were the image larger."""
        places = np.asarray(pixels, dtype=float)
        if self.usable_region is None:
            return np.ones(places.shape[:-1], dtype=bool)
        return np.asarray(depths_in_region(self.usable_region, places) >= 0)

    @property
    def border_px(self) -> NDArray[np.float64]:
        """``(n, 2)`` px: points around the border of the image, nearer where the lens shows less than all of it."""
        border = self.border_of_sensor_px
        if not math.isfinite(self._field_tangent):
            return border
        centre = np.asarray(self.principal_point)
        inner, outer = np.zeros((len(border), 1)), np.ones((len(border), 1))
        for _ in range(40):  # bisection along the rays from the principal point
            middle = (inner + outer) / 2
            shown = np.isfinite(self.from_pixels(centre + middle * (border - centre))).all(axis=-1, keepdims=True)
            inner, outer = np.where(shown, middle, inner), np.where(shown, outer, middle)
        return np.asarray(centre + inner * (border - centre))

    @property
    def border_of_sensor_px(self) -> NDArray[np.float64]:
        """``(n, 2)`` px: points around the border of all pixels."""
        columns, rows = self.resolution
        along = np.linspace(0.0, 1.0, 33)
        zero, one = np.zeros_like(along), np.ones_like(along)
        sides = [(along, zero), (along, one), (zero, along), (one, along)]
        return np.concatenate([np.stack(side, axis=-1) for side in sides]) * [columns, rows] - 0.5

    @property
    def pitch_tangents(self) -> NDArray[np.float64]:
        """``(2,)``: width and height of a pixel, in tangents of image directions."""
        return np.asarray(self.pixel_pitch_mm) / self.principal_distance_mm

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
            float(np.arctan(n * pitch / 2 / self.principal_distance_mm))
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
            return np.where(depth > 0, self.principal_distance_mm * p[..., :2] / depth, np.nan)

    def to_pixels(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """Pixel coordinates ``(..., 2)`` px in which the lens shows ideal image points ``(..., 2)`` mm."""
        image = np.asarray(image_mm, dtype=float)
        if self.lens is not None:
            image = self.lens.distort(image / self.principal_distance_mm) * self.principal_distance_mm
        return np.asarray(image / np.asarray(self.pixel_pitch_mm) + np.asarray(self.principal_point))

    def from_pixels(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Ideal image points ``(..., 2)`` mm of pixel coordinates ``(..., 2)`` px; NaN where the lens shows nothing."""
        image = (np.asarray(pixels, dtype=float) - np.asarray(self.principal_point)) * np.asarray(self.pixel_pitch_mm)
        if self.lens is not None:
            tangents = self.lens.undistort(image / self.principal_distance_mm)
            beyond = np.linalg.norm(tangents, axis=-1, keepdims=True) > self._field_tangent
            image = np.where(beyond, np.nan, tangents) * self.principal_distance_mm
        return np.asarray(image)

    def pixel_jacobian(self, image_mm: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 2)`` px/mm: derivative of :meth:`to_pixels`."""
        image = np.asarray(image_mm, dtype=float)
        J = np.broadcast_to(np.diag(1 / np.asarray(self.pixel_pitch_mm)), (*image.shape[:-1], 2, 2))
        if self.lens is not None:
            J = J @ self.lens.jacobian(image / self.principal_distance_mm)
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
            J = point_jacobian(p, self.principal_distance_mm)
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
        depth = np.full((*image.shape[:-1], 1), self.principal_distance_mm)
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
        scale = self.blur_at_infinity_px
        if self.focus_distance_mm is None or scale == 0:
            return np.zeros_like(depth)
        with np.errstate(divide="ignore", invalid="ignore"):
            blur = scale * np.abs(depth - self.focus_distance_mm) / depth
        return np.where(depth > 0, blur, np.inf)

    @property
    def blur_at_infinity_px(self) -> float:
        """Diameter of the circle of confusion of a point at infinity, px: (f/N) · f/(Zf − f); 0 without an aperture."""
        if self.f_number is None or self.focus_distance_mm is None:
            return 0.0
        aperture_mm = self.focal_length_mm / self.f_number
        magnification = self.focal_length_mm / (self.focus_distance_mm - self.focal_length_mm)
        return aperture_mm * magnification / min(self.pixel_pitch_mm)


def _field_radius_px(lens: Lens, tangent: float, pitch_tangents: NDArray[np.float64]) -> float:
    """Smallest distance from the principal point at which a lens shows directions of a tangent, px."""
    angle = np.linspace(0.0, 2 * np.pi, 180, endpoint=False)
    places = lens.distort(tangent * np.stack([np.cos(angle), np.sin(angle)], axis=-1)) / pitch_tangents
    return float(np.linalg.norm(places, axis=-1).min())
