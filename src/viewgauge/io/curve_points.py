"""Parameters at which a curve is sampled so that its chords stay close to it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["arc_parameters", "refined_parameters"]

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


def _distance_to_chord(
    points: NDArray[np.float64], starts: NDArray[np.float64], stops: NDArray[np.float64]
) -> NDArray[np.float64]:
    chord = stops - starts
    square = np.einsum("ij,ij->i", chord, chord)
    along = np.einsum("ij,ij->i", points - starts, chord) / np.where(square > 0, square, 1.0)
    foot = starts + np.clip(along, 0.0, 1.0)[:, None] * chord
    return np.asarray(np.linalg.norm(points - foot, axis=1))
