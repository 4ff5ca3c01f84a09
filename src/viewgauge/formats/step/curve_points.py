"""Parameters at which a curve is sampled so that its chords stay close to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["arc_parameters", "circle_through", "is_straight", "refined_parameters"]

_FIRST_SPANS = 8
_ROUNDS = 12
_LARGEST_STEP_RAD = np.pi / 6


def arc_parameters(start: float, stop: float, radius: float, chord_error: float) -> NDArray[np.float64]:
    """Evenly spaced angles, rad, between which an arc rises less than the chord error (mm) above its chord.

    The rise is r (1 - cos(step / 2)).
    """
    step = 2.0 * np.arccos(np.clip(1.0 - chord_error / radius, -1.0, 1.0))
    step = min(max(float(step), 1e-3), _LARGEST_STEP_RAD)
    return np.linspace(start, stop, max(2, int(np.ceil((stop - start) / step)) + 1))


def refined_parameters(
    point: Callable[[float], tuple[float, float, float]], start: float, stop: float, chord_error: float
) -> NDArray[np.float64]:
    """Parameters of a curve, refined where its middle lies off the chord by more than the chord error (mm)."""
    parameters = np.linspace(start, stop, _FIRST_SPANS + 1)
    for _ in range(_ROUNDS):
        middle = 0.5 * (parameters[1:] + parameters[:-1])
        ends = np.array([point(float(u)) for u in parameters])
        inner = np.array([point(float(u)) for u in middle])
        off = _distance_to_chord(inner, ends[:-1], ends[1:]) > chord_error
        if not off.any():
            break
        parameters = np.sort(np.concatenate([parameters, middle[off]]))
    return parameters


def is_straight(points: NDArray[np.float64], tolerance: float) -> bool:
    """Whether points ``(n, 3)`` lie within the tolerance (mm) of the segment from the first to the last."""
    if float(np.linalg.norm(points[-1] - points[0])) <= tolerance:
        return False
    return bool(np.all(_distance_to_chord(points, points[:1], points[-1:]) <= tolerance))


def circle_through(
    points: NDArray[np.float64], tolerance: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float] | None:
    """Centre, axis and radius (mm) of the circle on which points ``(n, 3)`` lie within the tolerance (mm), or None.

    The centre c solves 2 (p - m) . c = |p - m|^2 - mean in the points' plane, least squares about their mean m.
    """
    mean = points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(points - mean, full_matrices=False)
    if len(points) < 4 or sizes[2] > tolerance or sizes[1] <= tolerance:
        return None
    flat = (points - mean) @ axes[:2].T
    square = np.einsum("ij,ij->i", flat, flat)
    centre = np.linalg.lstsq(2.0 * flat, square - square.mean(), rcond=None)[0]
    distance = np.linalg.norm(flat - centre, axis=1)
    radius = float(distance.mean())
    if float(np.abs(distance - radius).max()) > tolerance:
        return None
    return mean + centre @ axes[:2], axes[2], radius


def _distance_to_chord(
    points: NDArray[np.float64], starts: NDArray[np.float64], stops: NDArray[np.float64]
) -> NDArray[np.float64]:
    chord = stops - starts
    square = np.einsum("ij,ij->i", chord, chord)
    along = np.einsum("ij,ij->i", points - starts, chord) / np.where(square > 0, square, 1.0)
    foot = starts + np.clip(along, 0.0, 1.0)[:, None] * chord
    return np.asarray(np.linalg.norm(points - foot, axis=1))
