"""Whether triangles enclose a volume without a gap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["is_watertight", "triangle_sides"]


def is_watertight(triangles: NDArray[np.int64], *, oriented: bool = False) -> bool:
    """Whether there are triangles ``(m, 3)``, and each of their sides is shared by exactly two of them.

    Parameters
    ----------
    oriented
        The two must also run along their side in opposite senses, as they do where all face outward.
    """
    if not len(triangles):
        return False
    sides = triangle_sides(triangles)
    size = np.int64(sides.max() + 1)
    ordered = np.sort(sides, axis=1)
    _, counts = np.unique(ordered[:, 0] * size + ordered[:, 1], return_counts=True)
    if not (counts == 2).all():
        return False
    return not oriented or len(np.unique(sides[:, 0] * size + sides[:, 1])) == len(sides)


def triangle_sides(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """Directed sides ``(3 m, 2)``; those of triangle i are rows 3 i to 3 i + 2."""
    return triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
