"""The error budget of a characteristic: how much of its uncertainty each source causes, and what it would be
without.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import TotalError
from ..geometry import PoseError, point_jacobian
from ..sensors import Camera
from .averaging import Acquisitions
from .camera_errors import camera_errors

__all__ = ["GROUPS", "SOURCES", "ErrorBudget", "averaged_error_budget", "error_budget"]

SOURCES = ("x", "y", "z", "rx", "ry", "rz", "pixel_u", "pixel_v", "edge_noise", "edge_offset", "calibration")
"""The six errors of the pose, pose error frame; quantization of the two ends along either axis of the image; noise and
common offset of a sub-pixel edge detector; and all errors of the camera's calibration together."""

GROUPS = {
    "translation": (0, 1, 2),
    "rotation": (3, 4, 5),
    "pose": (0, 1, 2, 3, 4, 5),
    "pixels": (6, 7),
    "camera": (6, 7, 8, 9, 10),
}
"""Sources that are mended together, by index."""

_ALL = len(SOURCES)
_PIXELS, _NOISE, _OFFSET, _CALIBRATION = slice(6, 8), 8, 9, 10


_END_ON_MM = 1e-100
"""Image length up to which a segment counts as seen end-on: no sensor has it, and division by more cannot overflow."""


@dataclass(frozen=True)
class ErrorBudget:
    """Variance shares of a length measured from one viewpoint, at first order; leading axes ``(...)`` of the segments.

    The last axis is that of the s :data:`SOURCES`.

    Parameters
    ----------
    sensitivity
        ``(..., s)``: change of the measured length, mm on the part, for one mm or rad of a pose error, one px of the
        ends' location along u or v, of an edge point or of the common offset (GUM 5.1.3), or one standard deviation of
        the calibration's effect.
    standard_uncertainty
        ``(..., s)``: of each source, mm, rad or px; a pixel's is that of the difference of two uniform errors; the
        calibration's is 1, or 0 where it is taken for exact.
    own_share, correlation_share
        ``(..., s)``: ``c_i² u_i² / u²`` and ``c_i sum_(j != i) c_j u_ij / u²``; all of both add up to 1. The latter are
        negative where errors cancel. They are the structural and the correlative contribution of Li, Rabitz et al.,
        *J. Phys. Chem. A* 114 (2010) 6022-6032; without correlations the former are first-order Sobol indices.
    probability, probability_without
        ``(...)`` Pr{|error| <= T L}, and ``(..., s)`` what it would be without each source.
    group_probability_without
        For each of :data:`GROUPS` ``(...)``: without all its sources.
    combined_uncertainty_mm
        ``(...)`` u of the length on the part, mm (GUM 5.1.2, 5.2.2).
    """

    sensitivity: NDArray[np.float64]
    standard_uncertainty: NDArray[np.float64]
    own_share: NDArray[np.float64]
    correlation_share: NDArray[np.float64]
    probability: NDArray[np.float64]
    probability_without: NDArray[np.float64]
    group_probability_without: dict[str, NDArray[np.float64]]
    combined_uncertainty_mm: NDArray[np.float64]

    @property
    def share(self) -> NDArray[np.float64]:
        """``(..., s)``: of each source, its correlations halved between the two; they add up to 1."""
        return self.own_share + self.correlation_share

    @property
    def group_share(self) -> dict[str, NDArray[np.float64]]:
        """For each of :data:`GROUPS` ``(...)`` the sum of its shares."""
        return {name: self.share[..., list(sources)].sum(axis=-1) for name, sources in GROUPS.items()}

    @property
    def contribution_mm(self) -> NDArray[np.float64]:
        """``(..., s)``: ``|c_i| u_i``, the standard uncertainty of the length by each source alone, mm."""
        return np.abs(self.sensitivity) * self.standard_uncertainty


def error_budget(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: ArrayLike,
    rim_axis: NDArray[np.float64] | None = None,
) -> ErrorBudget:
    """The budget of segments seen by a camera; NaN where an end is not in front of it or the segment is seen end-on.

    First order, as the joint model: ``error = sum_i J_i xi_i + cos g q_u + sin g q_v`` with J the Jacobian of the image
    length with respect to the pose error in the pose error frame, scaled from the image to the part by nominal length
    over image length.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    relative_tolerance
        T, broadcast against the segments.
    rim_axis
        ``(..., 3)``, camera frame: as of :func:`~viewgauge.evaluation.camera_errors.camera_errors`.
    """
    points = np.stack(np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float)), axis=-2)
    in_front = np.asarray((points[..., 2] > 0).all(axis=-1))
    points = np.where(in_front[..., None, None], points, [0.0, 0.0, 1.0])
    delta = np.diff(camera.project(points), axis=-2)[..., 0, :]
    image_length = np.hypot(delta[..., 0], delta[..., 1])
    seen = in_front & (image_length > _END_ON_MM)
    length = np.where(seen, image_length, 1.0)
    direction = np.where(seen[..., None], delta, [1.0, 0.0]) / length[..., None]
    J_camera = point_jacobian(points, camera.focal_length_mm)
    J = np.einsum("...k,...kp->...p", direction, J_camera[..., 1, :, :] - J_camera[..., 0, :, :]) @ error.adjoint
    own = camera_errors(points, camera, rim_axis)
    calibrated = 0 if camera.intrinsics_covariance is None else len(camera.intrinsics_covariance)
    covariance = np.zeros((_ALL, _ALL))  # of the pose errors, mm and rad, and of the camera's, px
    covariance[:6, :6] = error.covariance
    covariance[6:, 6:] = np.diag(_camera_uncertainty(camera) ** 2)
    resolution = 0.0 if camera.edge_detector is not None else camera.edge_resolution_px
    J_pixels = np.sign(direction) * own.half_widths_mm / (resolution or 1.0)
    noise = np.sqrt(own.own_variance_mm2) / (_camera_uncertainty(camera)[2] or 1.0)
    offset = own.gradient[..., calibrated] if own.gradient.shape[-1] > calibrated else np.zeros(length.shape)
    g = own.gradient[..., :calibrated]
    calibration = np.sqrt(
        np.maximum(np.einsum("...p,pq,...q->...", g, own.covariance[:calibrated, :calibrated], g), 0.0)
    )
    J = np.concatenate([J, J_pixels, np.stack([noise, offset, calibration], axis=-1)], axis=-1)
    terms = J[..., :, None] * covariance * J[..., None, :]
    variance = np.maximum(terms.sum(axis=(-2, -1)), 0.0)
    each = np.diagonal(terms, axis1=-2, axis2=-1)
    scale = np.where(variance > 0, variance, 1.0)[..., None]
    allowed = np.asarray(relative_tolerance, dtype=float) * length
    on_part = np.linalg.norm(points[..., 1, :] - points[..., 0, :], axis=-1) / length

    def without(sources: tuple[int, ...]) -> NDArray[np.float64]:
        kept = np.ones(_ALL)
        kept[list(sources)] = 0.0
        normal = J * kept
        normal[..., _PIXELS] = 0.0
        variance = np.einsum("...p,pq,...q->...", normal, covariance, normal)
        law = TotalError.of_half_widths(np.sqrt(np.maximum(variance, 0.0)), own.half_widths_mm * kept[_PIXELS])
        return _where(seen, law.central_probability(allowed))

    return ErrorBudget(
        sensitivity=_where(seen, J * on_part[..., None]),
        standard_uncertainty=np.broadcast_to(np.sqrt(covariance.diagonal()), J.shape).copy(),
        own_share=_where(seen, each / scale),
        correlation_share=_where(seen, (terms.sum(axis=-1) - each) / scale),
        probability=without(()),
        probability_without=np.stack([without((k,)) for k in range(_ALL)], axis=-1),
        group_probability_without={name: without(sources) for name, sources in GROUPS.items()},
        combined_uncertainty_mm=_where(seen, np.sqrt(variance) * on_part),
    )


def averaged_error_budget(
    points: ArrayLike,
    camera: Camera,
    error: PoseError,
    allowed_error_mm: float,
    rim_axis: NDArray[np.float64] | None = None,
) -> ErrorBudget:
    """The budget of the mean of k looks at one characteristic, without leading axes.

    What acquisitions share of the pose error acts by the mean of their gradients, what is drawn anew at each by ``1 /
    k`` of its own. A source's share counts both; its sensitivity is the one that a single error of its standard
    uncertainty would need for the same variance, and has no sign.

    Parameters
    ----------
    points
        ``(k, 2, 3)`` mm: both ends of the measurand of each acquisition, in its camera frame.
    rim_axis
        ``(k, 3)``, of each acquisition, as of :func:`~viewgauge.evaluation.camera_errors.camera_errors`.

    Raises
    ------
    InputError
        As :meth:`Acquisitions.of`.
    """
    acquisitions = Acquisitions.of(points, camera, error, rim_axis)
    k = len(acquisitions)
    mean = acquisitions.gradient.mean(axis=0)
    terms = np.zeros((_ALL, _ALL))
    terms[:6, :6] = np.outer(mean, mean) * acquisitions.common_covariance
    terms[:6, :6] += (
        np.einsum("np,nq->pq", acquisitions.gradient, acquisitions.gradient)
        * acquisitions.repeatability_covariance
        / k**2
    )
    terms[[6, 7], [6, 7]] = (acquisitions.half_widths_mm**2).sum(axis=0) / 6 / k**2
    terms[_NOISE, _NOISE] = acquisitions.location_variance_mm2.sum() / k**2
    calibrated = 0 if camera.intrinsics_covariance is None else len(camera.intrinsics_covariance)
    g, of_camera = acquisitions.camera_gradient.mean(axis=0), acquisitions.camera_covariance
    for source, part in ((_CALIBRATION, slice(calibrated)), (_OFFSET, slice(calibrated, None))):
        terms[source, source] = g[part] @ of_camera[part, part] @ g[part]
    own, variance = terms.diagonal().copy(), float(terms.sum())
    scale = variance if variance > 0 else 1.0
    uncertainty = np.concatenate([np.sqrt(np.maximum(error.covariance.diagonal(), 0.0)), _camera_uncertainty(camera)])
    contribution = np.sqrt(np.maximum(own, 0.0))

    def without(sources: tuple[int, ...]) -> NDArray[np.float64]:
        kept = np.ones(_ALL)
        kept[list(sources)] = 0.0
        camera_kept = np.where(
            np.arange(acquisitions.camera_gradient.shape[1]) < calibrated, kept[_CALIBRATION], kept[_OFFSET]
        )
        left = replace(
            acquisitions,
            gradient=acquisitions.gradient * kept[:6],
            half_widths_mm=acquisitions.half_widths_mm * kept[_PIXELS],
            location_variance_mm2=acquisitions.location_variance_mm2 * kept[_NOISE],
            camera_gradient=acquisitions.camera_gradient * camera_kept,
        )
        return np.asarray(left.mean_of(np.arange(k)).central_probability(allowed_error_mm))

    return ErrorBudget(
        sensitivity=np.divide(contribution, uncertainty, out=np.zeros(_ALL), where=uncertainty > 0),
        standard_uncertainty=uncertainty,
        own_share=own / scale,
        correlation_share=(terms.sum(axis=1) - own) / scale,
        probability=without(()),
        probability_without=np.stack([without((source,)) for source in range(_ALL)]),
        group_probability_without={name: without(sources) for name, sources in GROUPS.items()},
        combined_uncertainty_mm=np.asarray(np.sqrt(max(variance, 0.0))),
    )


def _camera_uncertainty(camera: Camera) -> NDArray[np.float64]:
    """Standard uncertainties of the camera's sources, in the order of :data:`SOURCES`."""
    edge_detector = camera.edge_detector
    quantization = 0.0 if edge_detector is not None else camera.edge_resolution_px / np.sqrt(6)
    noise, offset = (0.0, 0.0) if edge_detector is None else (edge_detector.noise_px, edge_detector.bias_px)
    return np.array([quantization, quantization, noise, offset, float(camera.intrinsics_covariance is not None)])


def _where(seen: NDArray[np.bool_], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """NaN where a segment is not seen."""
    values = np.asarray(values)
    expanded = seen.reshape(seen.shape + (1,) * (values.ndim - seen.ndim))
    return np.asarray(np.where(expanded, values, np.nan))
