"""From a segment in front of a camera to the probability that its image length is right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import TotalError
from ..exceptions import InputError
from ..geometry import Camera, PoseError, point_jacobian

__all__ = ["FirstOrderMethod", "SegmentImage", "image_segment", "success_probability"]

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
        Standard deviation of the length error that the pose error causes, mm on the image.
    """

    length_mm: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    sigma_displacement_mm: NDArray[np.float64]

    def total_error(self, camera: Camera) -> TotalError:
        """Law of the total length error (eq. 18-19), mm on the image."""
        return TotalError(self.sigma_displacement_mm, camera.quantization_step_mm, self.angle_rad)


def image_segment(
    start: ArrayLike, end: ArrayLike, camera: Camera, error: PoseError, method: FirstOrderMethod = "joint"
) -> SegmentImage:
    """Image length, direction and displacement error of segments (theory section 5).

    "joint": both ends move with the same pose error, ``sigma² = J Sigma J^T`` with
    ``J = cos g (J_u2 - J_u1) + sin g (J_v2 - J_v1)``. "independent": the four end-point errors are taken as
    independent, as in eq. 15-17, each at first order (normal); an upper bound, by a factor of 13 to 25 in
    ordinary set-ups.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    """
    points = np.stack(np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float)), axis=-2)
    in_front = np.asarray((points[..., 2] > 0).all(axis=-1))
    points = np.where(in_front[..., None, None], points, [0.0, 0.0, 1.0])  # any imageable point; masked below
    image = camera.project(points)
    delta = image[..., 1, :] - image[..., 0, :]
    length = np.hypot(delta[..., 0], delta[..., 1])
    angle = np.arctan2(delta[..., 1], delta[..., 0])
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    J = point_jacobian(points, camera.focal_length_mm)
    covariance = error.camera_covariance
    if method == "joint":
        J_length = np.einsum("...k,...kp->...p", direction, J[..., 1, :, :] - J[..., 0, :, :])
        variance = np.einsum("...p,pq,...q->...", J_length, covariance, J_length)
    elif method == "independent":
        point_variance = np.einsum("...p,pq,...q->...", J, covariance, J)
        variance = (direction**2 * point_variance.sum(axis=-2)).sum(axis=-1)
    else:
        raise InputError("unknown method", key="method", got=method, expected="joint or independent")
    sigma = np.sqrt(np.maximum(variance, 0.0))
    return SegmentImage(*(np.where(in_front, value, np.nan) for value in (length, angle, sigma)))


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
    imaged = ~np.isnan(image.length_mm)
    safe = SegmentImage(
        *(np.where(imaged, v, 0.0) for v in (image.length_mm, image.angle_rad, image.sigma_displacement_mm))
    )
    probability = safe.total_error(camera).central_probability(tolerance * safe.length_mm)
    return np.where(imaged, probability, 0.0)
