"""The error budget of a dimension: how much of its uncertainty each source causes, and what it would be without."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import TotalError
from ..geometry import Camera, PoseError, point_jacobian
from .looks import Looks

__all__ = ["GROUPS", "SOURCES", "ErrorBudget", "averaged_error_budget", "error_budget"]

SOURCES = ("x", "y", "z", "rx", "ry", "rz", "pixel_u", "pixel_v")
"""The six errors of the pose, head frame, and the location error of the two ends along either axis of the image."""

GROUPS = {"translation": (0, 1, 2), "rotation": (3, 4, 5), "pose": (0, 1, 2, 3, 4, 5), "pixels": (6, 7)}
"""Sources that are mended together, by index."""


_END_ON_MM = 1e-100
"""Image length up to which a segment counts as seen end-on: no sensor has it, and division by more cannot overflow."""


@dataclass(frozen=True)
class ErrorBudget:
    """Variance shares of a length measured from one setting, at first order; leading axes ``(...)`` of the segments.

    Parameters
    ----------
    sensitivity
        ``(..., 8)``: change of the measured length, mm on the part, for one mm or rad of a pose error, or one px of
        either end's location along u or v (GUM 5.1.3).
    standard_uncertainty
        ``(..., 8)``: of each source, mm, rad or px; a pixel's is that of the difference of two uniform errors.
    own_share, correlation_share
        ``(..., 8)``: ``c_i² u_i² / u²`` and ``c_i sum_(j != i) c_j u_ij / u²``; all sixteen add up to 1. The latter are
        negative where errors cancel. They are the structural and the correlative contribution of Li, Rabitz et al.,
        *J. Phys. Chem. A* 114 (2010) 6022-6032; without correlations the former are first-order Sobol indices.
    probability, probability_without
        ``(...)`` Pr{|error| <= T L}, and ``(..., 8)`` what it would be without each source.
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
        """``(..., 8)``: of each source, its correlations halved between the two; they add up to 1."""
        return self.own_share + self.correlation_share

    @property
    def group_share(self) -> dict[str, NDArray[np.float64]]:
        """For each of :data:`GROUPS` ``(...)`` the sum of its shares."""
        return {name: self.share[..., list(sources)].sum(axis=-1) for name, sources in GROUPS.items()}

    @property
    def contribution_mm(self) -> NDArray[np.float64]:
        """``(..., 8)``: ``|c_i| u_i``, the standard uncertainty of the length by each source alone, mm."""
        return np.abs(self.sensitivity) * self.standard_uncertainty


def error_budget(
    start: ArrayLike, end: ArrayLike, camera: Camera, error: PoseError, relative_tolerance: ArrayLike
) -> ErrorBudget:
    """The budget of segments seen by a camera; NaN where an end is not in front of it or the segment is seen end-on.

    First order, as the joint model: ``error = sum_i J_i xi_i + cos g q_u + sin g q_v`` with J the Jacobian of the image
    length with respect to the pose error in the head frame, scaled from the image to the part by nominal length over
    image length.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame.
    relative_tolerance
        T, broadcast against the segments.
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
    covariance = np.zeros((8, 8))  # of the pose errors, mm and rad, and of the pixels', mm on the image
    covariance[:6, :6] = error.covariance
    steps = np.asarray(camera.quantization_step_mm)
    covariance[6:, 6:] = np.diag(steps**2 / 6)
    J = np.concatenate([J, direction], axis=-1)
    terms = J[..., :, None] * covariance * J[..., None, :]
    variance = np.maximum(terms.sum(axis=(-2, -1)), 0.0)
    own = np.diagonal(terms, axis1=-2, axis2=-1)
    scale = np.where(variance > 0, variance, 1.0)[..., None]
    allowed = np.asarray(relative_tolerance, dtype=float) * length
    on_part = np.linalg.norm(points[..., 1, :] - points[..., 0, :], axis=-1) / length
    pitch = np.asarray(camera.pixel_pitch_mm)
    per_unit, unit = np.concatenate([np.ones(6), pitch]), np.concatenate([np.ones(6), 1 / pitch])

    def without(sources: tuple[int, ...]) -> NDArray[np.float64]:
        kept = np.ones(8)
        kept[list(sources)] = 0.0
        pose = np.einsum("...p,pq,...q->...", J[..., :6] * kept[:6], error.covariance, J[..., :6] * kept[:6])
        # the law depends on the direction through the half-widths alone
        angle = np.arctan2(direction[..., 1], direction[..., 0])
        law = TotalError(np.sqrt(np.maximum(pose, 0.0)), steps * kept[6:], angle)
        return _where(seen, law.central_probability(allowed))

    return ErrorBudget(
        sensitivity=_where(seen, J * per_unit * on_part[..., None]),
        standard_uncertainty=np.broadcast_to(np.sqrt(covariance.diagonal()) * unit, J.shape).copy(),
        own_share=_where(seen, own / scale),
        correlation_share=_where(seen, (terms.sum(axis=-1) - own) / scale),
        probability=without(()),
        probability_without=np.stack([without((k,)) for k in range(8)], axis=-1),
        group_probability_without={name: without(sources) for name, sources in GROUPS.items()},
        combined_uncertainty_mm=_where(seen, np.sqrt(variance) * on_part),
    )


def averaged_error_budget(points: ArrayLike, camera: Camera, error: PoseError, allowed_error_mm: float) -> ErrorBudget:
    """The budget of the mean of k looks at one dimension, without leading axes.

    What looks share of the pose error acts by the mean of their gradients, what is drawn anew at each by ``1 / k`` of
    its own. A source's share counts both; its sensitivity is the one that a single error of its standard uncertainty
    would need for the same variance, and has no sign.

    Parameters
    ----------
    points
        ``(k, 2, 3)`` mm: both ends of the gauge of each look, in its camera frame.

    Raises
    ------
    InputError
        As :meth:`Looks.of`.
    """
    looks = Looks.of(points, camera, error)
    k = len(looks)
    mean = looks.gradient.mean(axis=0)
    terms = np.zeros((8, 8))
    terms[:6, :6] = np.outer(mean, mean) * looks.common_covariance
    terms[:6, :6] += np.einsum("np,nq->pq", looks.gradient, looks.gradient) * looks.repeatability_covariance / k**2
    terms[[6, 7], [6, 7]] = (looks.half_widths_mm**2).sum(axis=0) / 6 / k**2
    own, variance = terms.diagonal(), float(terms.sum())
    scale = variance if variance > 0 else 1.0
    pixels = np.array([camera.edge_resolution_px / np.sqrt(6)] * 2)
    uncertainty = np.concatenate([np.sqrt(np.maximum(error.covariance.diagonal(), 0.0)), pixels])
    contribution = np.sqrt(np.maximum(own, 0.0))

    def without(sources: tuple[int, ...]) -> NDArray[np.float64]:
        kept = np.ones(8)
        kept[list(sources)] = 0.0
        gradient, half_widths = looks.gradient * kept[:6], looks.half_widths_mm * kept[6:]
        left = Looks(gradient, half_widths, looks.common_covariance, looks.repeatability_covariance)
        return np.asarray(left.mean_of(np.arange(k)).central_probability(allowed_error_mm))

    return ErrorBudget(
        sensitivity=np.divide(contribution, uncertainty, out=np.zeros(8), where=uncertainty > 0),
        standard_uncertainty=uncertainty,
        own_share=own / scale,
        correlation_share=(terms.sum(axis=1) - own) / scale,
        probability=without(()),
        probability_without=np.stack([without((source,)) for source in range(8)]),
        group_probability_without={name: without(sources) for name, sources in GROUPS.items()},
        combined_uncertainty_mm=np.asarray(np.sqrt(max(variance, 0.0))),
    )


def _where(seen: NDArray[np.bool_], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """NaN where a segment is not seen."""
    values = np.asarray(values)
    expanded = seen.reshape(seen.shape + (1,) * (values.ndim - seen.ndim))
    return np.asarray(np.where(expanded, values, np.nan))
