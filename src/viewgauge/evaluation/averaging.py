"""The error of a characteristic that is measured from several viewpoints and averaged (docs: theory, several
viewpoints).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import AveragedError
from ..exceptions import InputError
from ..geometry import PoseError, point_jacobian
from ..sensors import Camera
from .camera_errors import camera_errors

__all__ = ["Acquisitions", "averaged_success_probability"]


@dataclass(frozen=True)
class Acquisitions:
    """What each of n acquisitions brings to the error of a mean, at first order.

    An acquisition measures ``measurand length · measured / nominal image length``. Its error is
    ``g · (xi_common + xi) + g_c · theta + e + a (U1 + U2 - 1) + b (U3 + U4 - 1)``: xi_common, in the pose error frame,
    and theta, of the camera, are the same draws for all acquisitions, all else is drawn anew at each.

    Parameters
    ----------
    gradient
        ``(n, 6)`` g: mm of the characteristic per [mm, mm, mm, rad, rad, rad] of the pose error, pose error frame.
    half_widths_mm
        ``(n, 2)`` a and b: of quantization along u and v, mm of the characteristic.
    common_covariance, repeatability_covariance
        ``(6, 6)`` of xi_common and of xi, pose error frame, translation first.
    location_variance_mm2
        ``(n,)`` of e: a sub-pixel edge detector's noise, and what else is drawn anew; by default none.
    camera_gradient, camera_covariance
        ``(n, q)`` g_c and ``(q, q)`` of theta (:class:`~viewgauge.evaluation.camera_errors.CameraErrors`); by default
        none.
    anew_mm2, places
        By source the parts of ``location_variance_mm2``, and the places of its errors in theta.
    """

    gradient: NDArray[np.float64]
    half_widths_mm: NDArray[np.float64]
    common_covariance: NDArray[np.float64]
    repeatability_covariance: NDArray[np.float64]
    location_variance_mm2: NDArray[np.float64] = field(default_factory=lambda: np.zeros(()))
    camera_gradient: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))
    camera_covariance: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))
    anew_mm2: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    places: Mapping[str, slice] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = len(self.gradient)
        object.__setattr__(self, "location_variance_mm2", np.broadcast_to(self.location_variance_mm2, n))
        if not len(self.camera_gradient):
            object.__setattr__(self, "camera_gradient", np.zeros((n, len(self.camera_covariance))))

    @classmethod
    def of(
        cls, points: ArrayLike, camera: Camera, error: PoseError, rim_axis: NDArray[np.float64] | None = None
    ) -> Acquisitions:
        """Acquisitions of measurands.

        Parameters
        ----------
        points
            ``(n, 2, 3)`` mm: both ends of each measurand, in the camera frame of its acquisition.
        rim_axis
            ``(n, 3)``: as of :func:`~viewgauge.evaluation.camera_errors.camera_errors`.

        Raises
        ------
        InputError
            If the common part of the pose error is not stated, or a measurand is not in front of the camera or has no
            image length.
        """
        common, repeatability = error.common_covariance, error.repeatability_covariance
        if common is None or repeatability is None:
            raise InputError(
                "averaging helps only against what is drawn anew at each acquisition",
                key="common_covariance",
                expected="the part of the covariance that is common to all acquisitions; zeros if there is none",
            )
        ends = np.asarray(points, dtype=float)
        if ends.ndim != 3 or ends.shape[1:] != (2, 3) or not np.isfinite(ends).all() or (ends[..., 2] <= 0).any():
            raise InputError("not n measurands in front of the camera", key="points", got=f"shape {ends.shape}")
        image = camera.project(ends)
        delta = image[:, 1] - image[:, 0]
        length = np.hypot(delta[:, 0], delta[:, 1])
        if (length == 0).any():
            raise InputError("a measurand that is seen end-on has no image length to measure", key="points")
        direction = delta / length[:, None]
        J = point_jacobian(ends, camera.principal_distance_mm)
        at_camera = np.einsum("nk,nkp->np", direction, J[:, 1] - J[:, 0])
        scale = (
            np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / length
        )  # mm of the characteristic for each mm of image
        own = camera_errors(ends, camera, rim_axis)
        return cls(
            scale[:, None] * (at_camera @ error.adjoint),
            scale[:, None] * own.half_widths_mm,
            common,
            repeatability,
            scale**2 * own.own_variance_mm2,
            scale[:, None] * own.gradient,
            own.covariance,
            {name: scale**2 * variance for name, variance in own.anew_mm2.items()},
            own.places,
        )

    def __len__(self) -> int:
        return len(self.gradient)

    @property
    def own_variance_mm2(self) -> NDArray[np.float64]:
        """``(n,)``: what is drawn anew at each acquisition, quantization included."""
        own = _quadratic(self.gradient, self.repeatability_covariance) + self.location_variance_mm2
        return np.asarray(own + (self.half_widths_mm**2).sum(axis=1) / 6)

    def mean_of(self, acquisitions: ArrayLike) -> AveragedError:
        """Law of the error of the mean of some acquisitions, mm; ``(..., k)`` indices of them, all with the same
        weight.
        """
        index = np.asarray(acquisitions, dtype=np.int64)
        k = index.shape[-1]
        gradient = self.gradient[index]
        variance = _quadratic(gradient.mean(axis=-2), self.common_covariance)
        variance = variance + _quadratic(self.camera_gradient[index].mean(axis=-2), self.camera_covariance)
        own = _quadratic(gradient, self.repeatability_covariance) + self.location_variance_mm2[index]
        variance = variance + own.sum(axis=-1) / k**2
        return AveragedError(np.sqrt(variance), self.half_widths_mm[index].reshape(*index.shape[:-1], 2 * k) / k)


def _quadratic(vectors: NDArray[np.float64], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """``v Sigma v^T`` of vectors ``(..., p)``; rounding must not make it negative."""
    return np.asarray(np.maximum(np.einsum("...p,pq,...q->...", vectors, covariance, vectors), 0.0))


def averaged_success_probability(points: ArrayLike, camera: Camera, error: PoseError, allowed_error_mm: float) -> float:
    """Pr{|mean of k acquisitions - nominal| <= allowed error} of one characteristic.

    Parameters
    ----------
    points
        ``(k, 2, 3)`` mm: both ends of the measurand of each acquisition, in its camera frame.

    Raises
    ------
    InputError
        As :meth:`Acquisitions.of`; or if the allowed error is negative or not finite.
    """
    if not (np.isfinite(allowed_error_mm) and allowed_error_mm >= 0):
        raise InputError("must be finite and not negative", key="allowed_error_mm", got=allowed_error_mm)
    acquisitions = Acquisitions.of(points, camera, error)
    return float(acquisitions.mean_of(np.arange(len(acquisitions))).central_probability(allowed_error_mm))
