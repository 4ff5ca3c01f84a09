"""The closed bodies of a mesh that has several."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .watertight import is_watertight

__all__ = ["closed_bodies"]

_Triangles = NDArray[np.int64]


def closed_bodies(triangles: _Triangles) -> list[NDArray[np.int64]] | None:
    """Indices of the triangles of each body, every one watertight by itself; None where the mesh has gaps.

    Bodies that share sides (two boxes face to face) are told apart by the order of the file, which has one body after
    the other: a body ends where every side of its triangles has found its partner.
    """
    if is_watertight(triangles):
        return [np.arange(len(triangles))]
    bodies, first, unpaired = [], 0, set[tuple[int, int]]()
    for index, (a, b, c) in enumerate(triangles.tolist()):
        for side in ((a, b), (b, c), (c, a)):
            unpaired ^= {side if side[0] < side[1] else side[::-1]}
        if not unpaired:
            bodies.append(np.arange(first, index + 1))
            first = index + 1
    closed = not unpaired and all(is_watertight(triangles[body]) for body in bodies)
    if closed and bodies:
        return bodies
    outer = _without_shared_faces(triangles)
    return [outer] if is_watertight(triangles[outer]) else None


def _without_shared_faces(triangles: _Triangles) -> NDArray[np.int64]:
    """Indices of the triangles that have no twin of the same corners: two bodies meet where there is one."""
    _, same, count = np.unique(np.sort(triangles, axis=1), axis=0, return_inverse=True, return_counts=True)
    return np.flatnonzero(count[same.reshape(-1)] == 1)
