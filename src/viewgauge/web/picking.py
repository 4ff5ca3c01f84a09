"""What a click in the picture means."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..planning.improve.answers import Answers

__all__ = ["APEX_TO_BASE", "picked"]

APEX_TO_BASE = 0.16
"""Height of the pyramids that stand for cameras, of the part's size."""

_OF_MEASURAND, _OF_CAMERA = 0.04, 0.06  # how near the ray must pass, of the part's size


def picked(
    answers: Answers, size_mm: float, origin: NDArray[np.float64], direction: NDArray[np.float64]
) -> tuple[str, str] | None:
    """The characteristic or the viewpoint that is nearest to a ray.

    Parameters
    ----------
    size_mm
        Diagonal of the part.
    origin, direction
        ``(3,)`` mm and a unit vector, part frame.

    Returns
    -------
    ("characteristic", id) or ("viewpoint", name); None where nothing is near.
    """
    nearest, found = np.inf, None
    for answer in answers.characteristics:
        apart = (
            _from_ray(np.linspace(answer.measurand.start, answer.measurand.end, 33), origin, direction) / _OF_MEASURAND
        )
        if apart < nearest:
            nearest, found = apart, ("characteristic", answer.characteristic.id)
    for name, T in answers.viewpoints.items():
        axis = T[:3, 3] + np.outer(np.linspace(0, APEX_TO_BASE * size_mm, 9), T[:3, 2])
        apart = _from_ray(axis, origin, direction) / _OF_CAMERA
        if apart < nearest:
            nearest, found = apart, ("viewpoint", name)
    return found if nearest < size_mm else None


def _from_ray(points: NDArray[np.float64], origin: NDArray[np.float64], direction: NDArray[np.float64]) -> float:
    """Least distance of points ``(n, 3)`` from a ray; infinite where all are behind its origin."""
    along = (points - origin) @ direction
    apart = np.linalg.norm(points - origin - along[:, None] * direction, axis=1)
    return float(np.where(along > 0, apart, np.inf).min())
