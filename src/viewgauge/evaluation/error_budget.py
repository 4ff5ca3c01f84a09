"""The error budget of a characteristic: how much of its uncertainty each source causes, and what it would be
without.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..error_sources import (
    ERROR_SOURCES,
    Component,
    ErrorSource,
    LinearTerms,
    SourceKind,
    components_of,
    groups_of,
    sources_of,
)
from ..errors import TotalError
from ..geometry import PoseError, point_jacobian
from ..sensors import Camera
from .averaging import Acquisitions
from .camera_errors import camera_errors

__all__ = ["GROUPS", "SOURCES", "ErrorBudget", "averaged_error_budget", "error_budget"]

SOURCES = tuple(component.name for component in components_of(ERROR_SOURCES))
"""The components that every budget has: the six errors of the pose, pose error frame; quantization of the two ends
along either axis of the image; noise and common offset of a sub-pixel edge detector; and all errors of the camera's
calibration together."""

GROUPS = groups_of(ERROR_SOURCES)
"""Components that are mended together, by place."""

_END_ON_MM = 1e-100
"""Image length up to which a segment counts as seen end-on: no sensor has it, and division by more cannot overflow."""


@dataclass(frozen=True)
class ErrorBudget:
    """Variance shares of a length measured from one viewpoint, at first order; leading axes ``(...)`` of the segments.

    The last axis is that of the s ``components``: those of :data:`SOURCES`, and one a further error of the camera.

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
        For each of ``groups`` ``(...)``: without all its sources.
    combined_uncertainty_mm
        ``(...)`` u of the length on the part, mm (GUM 5.1.2, 5.2.2).
    components, groups
        Of the last axis; and what is mended together, by place.
    """

    sensitivity: NDArray[np.float64]
    standard_uncertainty: NDArray[np.float64]
    own_share: NDArray[np.float64]
    correlation_share: NDArray[np.float64]
    probability: NDArray[np.float64]
    probability_without: NDArray[np.float64]
    group_probability_without: dict[str, NDArray[np.float64]]
    combined_uncertainty_mm: NDArray[np.float64]
    components: tuple[Component, ...]
    groups: dict[str, tuple[int, ...]]

    @property
    def share(self) -> NDArray[np.float64]:
        """``(..., s)``: of each component, its correlations halved between the two; they add up to 1."""
        return self.own_share + self.correlation_share

    @property
    def group_share(self) -> dict[str, NDArray[np.float64]]:
        """For each of ``groups`` ``(...)`` the sum of its shares."""
        return {name: self.share[..., list(places)].sum(axis=-1) for name, places in self.groups.items()}

    @property
    def contribution_mm(self) -> NDArray[np.float64]:
        """``(..., s)``: ``|c_i| u_i``, the standard uncertainty of the length by each source alone, mm."""
        return np.abs(self.sensitivity) * self.standard_uncertainty


@dataclass(frozen=True)
class _Sources:
    """The sources of a camera and its pose, and the places of their components in a budget."""

    sources: tuple[ErrorSource, ...]
    camera: Camera
    pose_error: PoseError

    def __iter__(self) -> Iterator[tuple[ErrorSource, slice]]:
        place = 0
        for source in self.sources:
            yield source, slice(place, place + len(source.components))
            place += len(source.components)

    def places(self, kind: SourceKind) -> list[int]:
        """Of the components of the sources of a kind."""
        return [k for source, places in self if source.kind is kind for k in range(places.start, places.stop)]

    @property
    def uncertainty(self) -> NDArray[np.float64]:
        """``(s,)``: standard uncertainty of each component."""
        each = [source.standard_uncertainty(self.camera, self.pose_error) for source in self.sources]
        return np.concatenate(each)

    def sensitivity(self, terms: LinearTerms) -> NDArray[np.float64]:
        """``(..., s)`` mm on the image."""
        return np.concatenate([source.sensitivity(terms, self.camera) for source in self.sources], axis=-1)

    def probabilities(
        self, without: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], dict[str, NDArray[np.float64]]]:
        """With all components, without each, and without each group, of a function of what is kept ``(s,)``: 1 or 0."""
        count = len(components_of(self.sources))

        def left(places: Sequence[int]) -> NDArray[np.float64]:
            kept = np.ones(count)
            kept[list(places)] = 0.0
            return without(kept)

        each = np.stack([left((k,)) for k in range(count)], axis=-1)
        return left(()), each, {name: left(places) for name, places in groups_of(self.sources).items()}


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
    J_camera = point_jacobian(points, camera.principal_distance_mm)
    J_pose = np.einsum("...k,...kp->...p", direction, J_camera[..., 1, :, :] - J_camera[..., 0, :, :]) @ error.adjoint
    own = camera_errors(points, camera, rim_axis)
    sources = _Sources(sources_of(camera), camera, error)
    J = sources.sensitivity(
        LinearTerms(
            direction,
            J_pose,
            own.half_widths_mm,
            own.anew_mm2,
            {name: own.gradient[..., place] for name, place in own.places.items()},
            {name: own.covariance[place, place] for name, place in own.places.items()},
        )
    )
    covariance = np.diag(sources.uncertainty**2)  # mm, rad, px and others; the errors of the pose are correlated
    pose, quantized = sources.places(SourceKind.POSE), sources.places(SourceKind.TRIANGULAR)
    covariance[np.ix_(pose, pose)] = error.covariance
    terms = J[..., :, None] * covariance * J[..., None, :]
    variance = np.maximum(terms.sum(axis=(-2, -1)), 0.0)
    each = np.diagonal(terms, axis1=-2, axis2=-1)
    scale = np.where(variance > 0, variance, 1.0)[..., None]
    allowed = np.asarray(relative_tolerance, dtype=float) * length
    on_part = np.linalg.norm(points[..., 1, :] - points[..., 0, :], axis=-1) / length

    def without(kept: NDArray[np.float64]) -> NDArray[np.float64]:
        normal = J * kept
        normal[..., quantized] = 0.0
        variance = np.einsum("...p,pq,...q->...", normal, covariance, normal)
        law = TotalError.of_half_widths(np.sqrt(np.maximum(variance, 0.0)), own.half_widths_mm * kept[quantized])
        return _where(seen, law.central_probability(allowed))

    probability, without_each, without_groups = sources.probabilities(without)
    return ErrorBudget(
        sensitivity=_where(seen, J * on_part[..., None]),
        standard_uncertainty=np.broadcast_to(np.sqrt(covariance.diagonal()), J.shape).copy(),
        own_share=_where(seen, each / scale),
        correlation_share=_where(seen, (terms.sum(axis=-1) - each) / scale),
        probability=probability,
        probability_without=without_each,
        group_probability_without=without_groups,
        combined_uncertainty_mm=_where(seen, np.sqrt(variance) * on_part),
        components=components_of(sources.sources),
        groups=groups_of(sources.sources),
    )


def averaged_error_budget(
    points: ArrayLike,
    camera: Camera,
    error: PoseError,
    allowed_error_mm: float,
    rim_axis: NDArray[np.float64] | None = None,
) -> ErrorBudget:
    """The budget of the mean of k acquisitions of one characteristic, without leading axes.

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
    sources = _Sources(sources_of(camera), camera, error)
    terms = _terms_of_mean(acquisitions, sources)
    own, variance = terms.diagonal().copy(), float(terms.sum())
    scale = variance if variance > 0 else 1.0
    uncertainty = sources.uncertainty
    contribution = np.sqrt(np.maximum(own, 0.0))
    every = np.arange(len(acquisitions))

    def without(kept: NDArray[np.float64]) -> NDArray[np.float64]:
        left = _kept(acquisitions, sources, kept)
        return np.asarray(left.mean_of(every).central_probability(allowed_error_mm))

    probability, without_each, without_groups = sources.probabilities(without)
    return ErrorBudget(
        sensitivity=np.divide(contribution, uncertainty, out=np.zeros(len(own)), where=uncertainty > 0),
        standard_uncertainty=uncertainty,
        own_share=own / scale,
        correlation_share=(terms.sum(axis=1) - own) / scale,
        probability=probability,
        probability_without=without_each,
        group_probability_without=without_groups,
        combined_uncertainty_mm=np.asarray(np.sqrt(max(variance, 0.0))),
        components=components_of(sources.sources),
        groups=groups_of(sources.sources),
    )


def _terms_of_mean(acquisitions: Acquisitions, sources: _Sources) -> NDArray[np.float64]:
    """``(s, s)`` mm²: what each pair of components adds to the variance of the mean."""
    k, count = len(acquisitions), len(components_of(sources.sources))
    terms = np.zeros((count, count))
    mean, camera_mean = acquisitions.gradient.mean(axis=0), acquisitions.camera_gradient.mean(axis=0)
    pose = np.ix_(sources.places(SourceKind.POSE), sources.places(SourceKind.POSE))
    terms[pose] = np.outer(mean, mean) * acquisitions.common_covariance
    terms[pose] += (
        np.einsum("np,nq->pq", acquisitions.gradient, acquisitions.gradient)
        * acquisitions.repeatability_covariance
        / k**2
    )
    for source, place in sources:
        at = np.arange(place.start, place.stop)
        if source.kind is SourceKind.TRIANGULAR:
            terms[at, at] = (acquisitions.half_widths_mm**2).sum(axis=0) / 6 / k**2
        elif source.kind is SourceKind.ANEW:
            terms[at, at] = acquisitions.anew_mm2[source.name].sum() / k**2
        elif source.kind is SourceKind.COMMON and source.name in acquisitions.places:
            part = acquisitions.places[source.name]
            g = camera_mean[part]
            terms[at, at] = g @ acquisitions.camera_covariance[part, part] @ g
    return terms


def _kept(acquisitions: Acquisitions, sources: _Sources, kept: NDArray[np.float64]) -> Acquisitions:
    """The acquisitions with the components that are kept, ``(s,)``: 1 or 0."""
    camera_kept = np.ones(acquisitions.camera_gradient.shape[1])
    anew = dict(acquisitions.anew_mm2)
    for source, place in sources:
        if source.kind is SourceKind.ANEW:
            anew[source.name] = anew[source.name] * kept[place.start]
        elif source.kind is SourceKind.COMMON and source.name in acquisitions.places:
            camera_kept[acquisitions.places[source.name]] = kept[place.start]
    return replace(
        acquisitions,
        gradient=acquisitions.gradient * kept[sources.places(SourceKind.POSE)],
        half_widths_mm=acquisitions.half_widths_mm * kept[sources.places(SourceKind.TRIANGULAR)],
        location_variance_mm2=np.sum(list(anew.values()), axis=0),
        camera_gradient=acquisitions.camera_gradient * camera_kept,
    )


def _where(seen: NDArray[np.bool_], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """NaN where a segment is not seen."""
    values = np.asarray(values)
    expanded = seen.reshape(seen.shape + (1,) * (values.ndim - seen.ndim))
    return np.asarray(np.where(expanded, values, np.nan))
