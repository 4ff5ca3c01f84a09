"""The full camera model, by brute force: true rotations, euclidean image length, every error drawn.

This module judges the probability laws; it shares geometry with them and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..error_sources import DrawnView
from ..exceptions import InputError
from ..geometry import PoseError, invert, transform
from ..sensors import Camera
from .camera_draws import CameraDraws, drawn_view, measured_images

__all__ = [
    "Estimate",
    "camera_length_errors",
    "displaced_length_errors",
    "displacements",
    "draw_pose_errors",
    "estimate_success_probability",
    "exact_length_errors",
    "nominal_length",
    "require_points",
    "simulate_length_errors",
]


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
        from scipy.stats import beta  # late: slow to import, and the first-order prediction does without

        tail = (1 - confidence) / 2
        low = 0.0 if successes == 0 else float(beta.ppf(tail, successes, draws - successes + 1))
        high = 1.0 if successes == draws else float(beta.ppf(1 - tail, successes + 1, draws - successes))
        return cls(successes / draws, low, high, draws)


def draw_pose_errors(error: PoseError, draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Displacements ``(draws, 4, 4)`` of the scene, pose error frame: Trans(d) Rot_x Rot_y Rot_z (eq. 6)."""
    rotations, shifts = displacements(rng.standard_normal((draws, 6)) @ error.factor.T)
    displacement = np.zeros((draws, 4, 4))
    displacement[:, :3, :3] = np.moveaxis(rotations, -1, 0)
    displacement[:, :3, 3] = shifts.T
    displacement[:, 3, 3] = 1.0
    return displacement


def displacements(twist: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rotations ``(3, 3, n)``, Rot_x Rot_y Rot_z, and shifts ``(3, n)`` mm of pose errors ``(n, 6)``.

    By hand: it is done for every draw, and SciPy's ``Rotation.from_euler`` takes seven times as long.
    """
    (sx, sy, sz), (cx, cy, cz) = np.sin(twist[:, 3:].T), np.cos(twist[:, 3:].T)
    rotation = np.empty((3, 3, len(twist)))
    rotation[0] = cy * cz, -cy * sz, sy
    rotation[1] = cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy
    rotation[2] = sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy
    return rotation, twist[:, :3].T


def exact_length_errors(
    points: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    twist: NDArray[np.float64],
    quantization: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Measured less nominal image length for given errors, ``(n,)`` mm: all that every estimate here rests on.

    A pose error moves both ends by the same rigid motion, they are projected, quantization errors are added, and
    the euclidean length is taken. NaN where an end is carried behind the camera.

    Parameters
    ----------
    points
        ``(2, 3)`` mm, camera frame, in front of the camera.
    twist
        ``(n, 6)`` pose errors [x, y, z, rx, ry, rz], mm and rad, pose error frame.
    quantization
        ``(n, 2)``: the end's less the start's location error along u and v, in quantization steps.
    """
    return displaced_length_errors(points, camera, error, displacements(twist), quantization)


def displaced_length_errors(
    points: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    displacement: tuple[NDArray[np.float64], NDArray[np.float64]],
    quantization: NDArray[np.float64],
) -> NDArray[np.float64]:
    """:func:`exact_length_errors` for displacements of the scene: rotations ``(3, 3, n)``, shifts ``(3, n)`` mm."""
    (u1, v1), (u2, v2) = displaced_images(points, camera, error, displacement)
    step_u, step_v = camera.quantization_step_mm
    delta_u, delta_v = u2 - u1 + step_u * quantization[:, 0], v2 - v1 + step_v * quantization[:, 1]
    return np.asarray(np.sqrt(delta_u * delta_u + delta_v * delta_v) - nominal_length(points, camera))


def camera_length_errors(
    view: DrawnView,
    error: PoseError,
    displacement: tuple[NDArray[np.float64], NDArray[np.float64]],
    draws: CameraDraws,
) -> NDArray[np.float64]:
    """:func:`displaced_length_errors` of a camera with a lens, a calibration and an edge detector, whose errors are
    drawn.

    Parameters
    ----------
    view
        From :func:`~viewgauge.simulation.camera_draws.drawn_view`.
    """
    points, camera = view.points, view.camera
    images = np.moveaxis(np.array(displaced_images(points, camera, error, displacement)), -1, 0)  # (n, 2, 2)
    seen = measured_images(images, view, draws)
    return np.asarray(np.linalg.norm(seen[:, 1] - seen[:, 0], axis=-1) - nominal_length(points, camera))


def displaced_images(
    points: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    displacement: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Ideal images u and v ``(n,)``, mm, of both ends, for displacements of the scene."""
    assert error.T_camera_frame is not None  # set by PoseError
    orientation, origin = error.T_camera_frame[:3, :3], error.T_camera_frame[:3, 3]
    rotation, shift = displacement
    shifted = orientation @ shift + origin[:, None]
    turned = (orientation @ rotation.reshape(3, -1)).reshape(3, 3, -1)
    ends = transform(invert(error.T_camera_frame), points)
    images = []
    for end in ends:
        x, y, z = turned[:, 0] * end[0] + turned[:, 1] * end[1] + turned[:, 2] * end[2] + shifted
        with np.errstate(divide="ignore"):
            magnification = np.where(z > 0, camera.principal_distance_mm / z, np.nan)
        images.append((x * magnification, y * magnification))
    return images


def nominal_length(points: NDArray[np.float64], camera: Camera) -> float:
    """Image length of ``(2, 3)`` mm points, camera frame, without any error, mm."""
    return float(np.linalg.norm(np.diff(camera.project(points), axis=0)))


def require_points(start: ArrayLike, end: ArrayLike) -> NDArray[np.float64]:
    """Both ends ``(..., 2, 3)`` mm, or InputError unless they are finite and in front of the camera."""
    points = np.stack([np.asarray(start, dtype=float), np.asarray(end, dtype=float)], axis=-2)
    if points.shape[-2:] != (2, 3) or not np.isfinite(points).all() or (points[..., 2] <= 0).any():
        raise InputError("start and end must be finite points in front of the camera", got=points.tolist())
    return points


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
    points = require_points(start, end)
    if points.shape != (2, 3):
        raise InputError("one segment at a time: start and end are points in front of the camera", got=points.shape)
    twist = rng.standard_normal((draws, 6)) @ error.factor.T
    if not camera.is_plain:
        drawn = CameraDraws.of(camera, rng.random((draws, CameraDraws.width(camera))))
        return camera_length_errors(drawn_view(points, camera), error, displacements(twist), drawn)
    located = rng.random((draws, 2, 2)) - 0.5
    return exact_length_errors(points, camera, error, twist, located[:, 1] - located[:, 0])


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
