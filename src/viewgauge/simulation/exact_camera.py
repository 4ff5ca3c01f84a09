"""The exact camera, by brute force: true rotations, euclidean image length, every error drawn.

This module judges the probability laws; it shares geometry with them and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation
from scipy.stats import beta

from ..exceptions import InputError
from ..geometry import Camera, PoseError, invert, transform

__all__ = ["Estimate", "draw_pose_errors", "estimate_success_probability", "simulate_length_errors"]


@dataclass(frozen=True)
class Estimate:
    """A probability estimated from draws, with its exact binomial (Clopper-Pearson) confidence interval."""

    probability: float
    low: float
    high: float
    draws: int

    @classmethod
    def of(cls, successes: int, draws: int, confidence: float) -> Estimate:
        """Interval of Clopper and Pearson, *Biometrika* 26 (1934) 404-413."""
        tail = (1 - confidence) / 2
        low = 0.0 if successes == 0 else float(beta.ppf(tail, successes, draws - successes + 1))
        high = 1.0 if successes == draws else float(beta.ppf(1 - tail, successes + 1, draws - successes))
        return cls(successes / draws, low, high, draws)


def draw_pose_errors(error: PoseError, draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Displacements ``(draws, 4, 4)`` of the scene, head frame: Trans(d) Rot_x Rot_y Rot_z (eq. 6)."""
    # the correlation matrix is factored, not the covariance: mm would drown rad in rounding errors
    deviations = np.sqrt(error.covariance.diagonal())
    scale = np.where(deviations > 1e-150, deviations, 1.0)  # smaller underflow when squared
    values, vectors = np.linalg.eigh(error.covariance / np.outer(scale, scale))
    twist = rng.standard_normal((draws, 6)) @ (vectors * np.sqrt(np.maximum(values, 0.0))).T * deviations
    displacement = np.zeros((draws, 4, 4))
    displacement[:, :3, :3] = Rotation.from_euler("XYZ", twist[:, 3:]).as_matrix()
    displacement[:, :3, 3] = twist[:, :3]
    displacement[:, 3, 3] = 1.0
    return displacement


def simulate_length_errors(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    draws: int,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Measured less nominal image length of one segment, ``(draws,)`` mm.

    Each draw displaces the scene by a pose error, projects both ends, adds to each coordinate of each end a
    uniform error of one quantization step, and measures the euclidean length. A draw that carries an end behind
    the camera gives NaN.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, camera frame.
    """
    points = np.stack([np.asarray(start, dtype=float), np.asarray(end, dtype=float)])
    if points.shape != (2, 3) or not np.isfinite(points).all() or (points[:, 2] <= 0).any():
        raise InputError("start and end must be finite points in front of the camera", got=points.tolist())
    assert error.T_camera_head is not None  # set by PoseError
    displaced_head = transform(
        draw_pose_errors(error, draws, rng)[:, None], transform(invert(error.T_camera_head), points)
    )
    image = camera.project(transform(error.T_camera_head, displaced_head))
    image = image + (rng.random(image.shape) - 0.5) * np.asarray(camera.quantization_step_mm)
    nominal = np.linalg.norm(np.diff(camera.project(points), axis=0))
    return np.asarray(np.linalg.norm(image[:, 1] - image[:, 0], axis=-1) - nominal)


def estimate_success_probability(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: float,
    *,
    draws: int = 1_000_000,
    confidence: float = 0.999,
    rng: np.random.Generator | int | None = None,
) -> Estimate:
    """Pr{|measured - nominal| <= T L} of one segment, by drawing (start, end: ``(3,)`` mm, camera frame)."""
    if not (np.isfinite(relative_tolerance) and relative_tolerance >= 0):
        raise InputError("must be finite and not negative", key="relative_tolerance", got=relative_tolerance)
    if draws < 1:
        raise InputError("must be at least 1", key="draws", got=draws)
    if not 0 < confidence < 1:
        raise InputError("must lie between 0 and 1", key="confidence", got=confidence)
    generator = np.random.default_rng(rng)
    ends = np.stack([np.asarray(start, dtype=float), np.asarray(end, dtype=float)])
    allowed = relative_tolerance * np.linalg.norm(np.diff(camera.project(ends), axis=0))
    successes = 0
    for block in range(0, draws, _DRAWS_PER_BLOCK):
        count = min(_DRAWS_PER_BLOCK, draws - block)
        errors = simulate_length_errors(start, end, camera, error, count, generator)
        with np.errstate(invalid="ignore"):
            successes += int((np.abs(errors) <= allowed).sum())
    return Estimate.of(successes, draws, confidence)


_DRAWS_PER_BLOCK = 250_000  # bounds the memory of a block to about 100 MB
