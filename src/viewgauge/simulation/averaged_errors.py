"""The full camera model for the mean of several viewpoints: one pose error that they share, and one of its own for
each.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from ..geometry import PoseError
from ..geometry.pose_error import covariance_factor
from ..sensors import Camera
from .camera_draws import CameraDraws, drawn_view
from .full_camera import (
    Estimate,
    camera_length_errors,
    displaced_length_errors,
    displacements,
    nominal_length,
    require_points,
)

__all__ = ["estimate_averaged_probability", "simulate_mean_errors"]

_DRAWS_PER_BLOCK = 100_000  # bounds the memory of a block to some 50 MB


def simulate_mean_errors(
    points: ArrayLike,
    camera: Camera,
    error: PoseError,
    draws: int,
    rng: np.random.Generator,
    rim_axis: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Error of the mean of k acquisitions of one characteristic, ``(draws,)`` mm of the characteristic.

    Each draw takes one common displacement of the scene, and for each acquisition another one that comes after it (both
    with true rotations, pose error frame), projects both ends, adds quantization errors and measures the length.
    The result of an acquisition is the measurand's length times measured over nominal image length. It is NaN where an
    end is behind the camera.

    Parameters
    ----------
    points
        ``(k, 2, 3)`` mm: both ends of the measurand of each acquisition, in its camera frame.
    rim_axis
        ``(k, 3)``, of each acquisition: as of :func:`~viewgauge.simulation.camera_draws.drawn_view`.

    Raises
    ------
    InputError
        If the common part of the pose error is not stated, or a measurand cannot be imaged.
    """
    acquisitions = _require_acquisitions(points)
    common, own = _factors(error)
    rotation, shift = displacements(rng.standard_normal((draws, 6)) @ common.T)
    total, width = np.zeros(draws), CameraDraws.width(camera)
    of_camera = CameraDraws.of(camera, rng.random((draws, width))) if not camera.is_plain else None
    axes = [None] * len(acquisitions) if rim_axis is None else list(rim_axis)
    for ends, axis in zip(acquisitions, axes, strict=True):
        own_rotation, own_shift = displacements(rng.standard_normal((draws, 6)) @ own.T)
        both = np.einsum("ijn,jkn->ikn", own_rotation, rotation)
        moved = np.einsum("ijn,jn->in", own_rotation, shift) + own_shift
        if of_camera is None:
            located = rng.random((draws, 2, 2)) - 0.5
            errors = displaced_length_errors(ends, camera, error, (both, moved), located[:, 1] - located[:, 0])
        else:
            own_draws = CameraDraws.of(camera, rng.random((draws, width))).with_common(of_camera, camera)
            errors = camera_length_errors(drawn_view(ends, camera, axis), error, (both, moved), own_draws)
        total += errors * (np.linalg.norm(ends[1] - ends[0]) / nominal_length(ends, camera))
    return total / len(acquisitions)


def estimate_averaged_probability(
    points: ArrayLike,
    camera: Camera,
    error: PoseError,
    allowed_error_mm: float,
    *,
    draws: int = 1_000_000,
    confidence: float = 0.999,
    rng: np.random.Generator | int | None = None,
    rim_axis: NDArray[np.float64] | None = None,
) -> Estimate:
    """Pr{|mean of k acquisitions - nominal| <= allowed error} of one characteristic, by drawing (points as above)."""
    if not (np.isfinite(allowed_error_mm) and allowed_error_mm >= 0):
        raise InputError("must be finite and not negative", key="allowed_error_mm", got=allowed_error_mm)
    if draws < 1:
        raise InputError("must be at least 1", key="draws", got=draws)
    if not 0 < confidence < 1:
        raise InputError("must lie between 0 and 1", key="confidence", got=confidence)
    generator = np.random.default_rng(rng)
    successes = 0
    for block in range(0, draws, _DRAWS_PER_BLOCK):
        errors = simulate_mean_errors(points, camera, error, min(_DRAWS_PER_BLOCK, draws - block), generator, rim_axis)
        with np.errstate(invalid="ignore"):
            successes += int((np.abs(errors) <= allowed_error_mm).sum())
    return Estimate.of(successes, draws, confidence)


def _require_acquisitions(points: ArrayLike) -> NDArray[np.float64]:
    acquisitions = np.asarray(points, dtype=float)
    if acquisitions.ndim != 3 or acquisitions.shape[1:] != (2, 3) or not len(acquisitions):
        raise InputError("not k measurands, each with both its ends", key="points", got=f"shape {acquisitions.shape}")
    return require_points(acquisitions[:, 0], acquisitions[:, 1])


def _factors(error: PoseError) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Factors ``(6, 6)`` of the common and of the repeatability covariance."""
    common, own = error.common_covariance, error.repeatability_covariance
    if common is None or own is None:
        raise InputError(
            "the part of the pose error that is common to all acquisitions is not stated",
            key="common_covariance",
            expected="a 6x6 covariance; zeros if there is none",
        )
    return covariance_factor(common), covariance_factor(own)
