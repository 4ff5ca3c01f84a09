"""Distances between a point and boxes of eye positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["box_distances"]


def box_distances(
    point: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and greatest distance ``(n,)`` mm from a point ``(3,)`` to the boxes between corners ``(n, 3)`` mm."""
    nearest = np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0), axis=1)
    return nearest, np.linalg.norm(np.maximum(high - point, point - low), axis=1)
