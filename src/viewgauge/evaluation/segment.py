"""From a segment in front of a camera to the probability that its image length is right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import IndependentTotalError, SegmentDisplacement, TotalError
from ..exceptions import InputError
from ..geometry import PoseError, point_jacobian
from ..sensors import Camera
from .camera_errors import CameraErrors, camera_errors

__all__ = ["FirstOrderMethod", "SegmentImage", "image_segment", "require_plain", "success_probability"]

FirstOrderMethod = Literal["joint", "independent"]


@dataclass(frozen=True)
class SegmentImage:
    """The image of segments and the first-order law of its length error.

    Parameters
    ----------
    length_mm
        Nominal image length, mm; NaN where an end is not in front of the camera.
    angle_rad
        Direction gamma of the image from +u, rad.
    sigma_displacement_mm
        Standard deviation of the length error that the pose error causes, mm on the image, at first order.
    camera
        What the camera adds; of a dummy where an end is not in front.
    independent
        The paper's law of the displacement error (eq. 15-17), in place of the normal one; of a dummy likewise.
    """

    length_mm: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    sigma_displacement_mm: NDArray[np.float64]
    camera: CameraErrors
    independent: SegmentDisplacement | None = None
    quantization_step_mm: tuple[float, float] = (0.0, 0.0)

    def total_error(self) -> TotalError | IndependentTotalError:
        """Law of the total length error (eq. 18-19), mm on the image."""
        if self.independent is not None:
            return self.independent.plus_quantization(self.quantization_step_mm)
        return self._first_order()

    def success_probability(self, relative_tolerance: ArrayLike) -> NDArray[np.float64]:
        """Pr{Accuracy >= 1 - T} (eq. 20); 0 where an end is not in front of the camera.

        Where the independent law has no value (depth known to worse than 14 %), the first-order normal one's.
        """
        allowed = np.where(self._imaged, np.asarray(relative_tolerance, dtype=float) * self.length_mm, 0.0)
        value = self._first_order().central_probability(allowed)
        if self.independent is not None:
            exact = self.total_error().central_probability(allowed)
            value = np.where(np.isnan(exact), value, exact)
        return np.where(self._imaged, value, 0.0)

    def mean_absolute_error(self) -> NDArray[np.float64]:
        """E|error|, mm on the image; NaN where an end is not in front. As :meth:`success_probability`."""
        value = self._first_order().mean_absolute()
        if self.independent is not None:
            exact = self.total_error().mean_absolute()
            value = np.where(np.isnan(exact), value, exact)
        return np.where(self._imaged, value, np.nan)

    def expected_accuracy(self) -> NDArray[np.float64]:
        """1 - E|error| / L (eq. 20), not below 0; 0 for a segment seen end-on, which has no length to be measured."""
        length = self.length_mm
        relative = np.divide(self.mean_absolute_error(), length, out=np.ones_like(length), where=length > 0)
        return np.asarray(np.maximum(1 - relative, 0.0))

    @property
    def sigma_camera_mm(self) -> NDArray[np.float64]:
        """Standard deviation of the length error by edge location and calibration, mm on the image."""
        return np.sqrt(self.camera.normal_variance_mm2)

    @property
    def _imaged(self) -> NDArray[np.bool_]:
        return ~np.isnan(self.length_mm)

    def _first_order(self) -> TotalError:
        sigma = np.hypot(np.where(self._imaged, self.sigma_displacement_mm, 0.0), self.sigma_camera_mm)
        return TotalError.of_half_widths(sigma, self.camera.half_widths_mm)


def image_segment(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    method: FirstOrderMethod = "joint",
    rim_axis: NDArray[np.float64] | None = None,
) -> SegmentImage:
    """Image length, direction and displacement error of segments (theory section 5).

    "joint": both ends move with the same pose error, ``sigma² = J Sigma J^T`` with
    ``J = cos g (J_u2 - J_u1) + sin g (J_v2 - J_v1)``. "independent": the four end-point errors are taken as
    independent ratios of normals, as in eq. 15-17; in ordinary set-ups it overstates the spread
    by a factor of 13 to 25, but it is no bound for every pose error (errata, 15).

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    rim_axis
        ``(..., 3)``, camera frame: as of :func:`~viewgauge.evaluation.camera_errors.camera_errors`.

    Raises
    ------
    InputError
        For an unknown method, or a camera that the independent model does not know: one that is not plain.
    """
    points = np.stack(np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float)), axis=-2)
    in_front = np.asarray((points[..., 2] > 0).all(axis=-1))
    points = np.where(in_front[..., None, None], points, [0.0, 0.0, 1.0])  # any imageable point; masked below
    image = camera.project(points)
    delta = image[..., 1, :] - image[..., 0, :]
    length = np.hypot(delta[..., 0], delta[..., 1])
    angle = np.arctan2(delta[..., 1], delta[..., 0])
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    J = point_jacobian(points, camera.principal_distance_mm)
    covariance = error.camera_covariance
    independent = None
    if method == "joint":
        J_length = np.einsum("...k,...kp->...p", direction, J[..., 1, :, :] - J[..., 0, :, :])
        variance = np.einsum("...p,pq,...q->...", J_length, covariance, J_length)
    elif method == "independent":
        require_plain(camera)
        point_variance = np.einsum("...p,pq,...q->...", J, covariance, J)
        variance = (direction**2 * point_variance.sum(axis=-2)).sum(axis=-1)
        independent = SegmentDisplacement.independent(
            points[..., 0, :], points[..., 1, :], camera.principal_distance_mm, covariance
        )
    else:
        raise InputError("unknown method", key="method", got=method, expected="joint or independent")
    sigma = np.sqrt(np.maximum(variance, 0.0))
    length, angle, sigma = (np.where(in_front, value, np.nan) for value in (length, angle, sigma))
    own = camera_errors(points, camera, rim_axis)
    return SegmentImage(length, angle, sigma, own, independent, camera.quantization_step_mm)


def require_plain(camera: Camera) -> None:
    """Raise InputError if the paper's independent model does not know such a camera."""
    if not camera.is_plain:
        raise InputError(
            "the paper's model knows neither lens nor calibration uncertainty nor sub-pixel edge detector",
            key="method",
            got="independent",
            expected="joint or monte-carlo with this camera",
        )


def success_probability(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: ArrayLike,
    method: FirstOrderMethod = "joint",
) -> NDArray[np.float64]:
    """Pr{Accuracy >= 1 - T} of segments seen by a camera (eq. 20); 0 where an end is not in front of it.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    relative_tolerance
        T, broadcast against the segments.

    Raises
    ------
    InputError
        If a point is not finite, or T is negative or not finite.
    """
    tolerance = np.asarray(relative_tolerance, dtype=float)
    if not (np.isfinite(tolerance) & (tolerance >= 0)).all():
        raise InputError("must be finite and not negative", key="relative_tolerance", got=relative_tolerance)
    for name, point in (("start", start), ("end", end)):
        if not np.isfinite(point).all():
            raise InputError("must be finite points, mm, camera frame", key=name, got=point)
    image = image_segment(start, end, camera, error, method)
    return image.success_probability(tolerance)
