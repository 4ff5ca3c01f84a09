"""Corners of triangles that lie in nearly one place, made one vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .watertight import is_watertight

__all__ = ["welded"]

_OF_DIAGONAL = (1e-6, 1e-5)
_FLOAT32_STEPS = 4  # by which the corners of a mesh that is written in single precision may differ


def welded(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64], float]:
    """The mesh with vertices of one place merged, and the distance within which they were, mm; 0 where all are equal.

    Equal corners are always merged. Where that leaves gaps, corners within 1e-6 of the diagonal of the part's box are
    merged as well (or within four steps of single precision at its largest coordinate, if that is more); and within
    1e-5 of the diagonal, if that alone closes the surface. A wider gap is taken for one of the part's own.

    Returns
    -------
    Vertices ``(n, 3)`` mm, triangles ``(m, 3)`` with three different corners each, and the distance.
    """
    places, same = np.unique(vertices + 0.0, axis=0, return_inverse=True)  # + 0.0: -0.0 becomes 0.0
    exact = _with_corners(triangles, same.reshape(-1))
    if not len(places) or is_watertight(exact):
        return places, exact, 0.0
    diagonal = float(np.linalg.norm(np.ptp(places, axis=0)))
    single = _FLOAT32_STEPS * float(np.spacing(np.float32(np.abs(places).max())))
    best: tuple[NDArray[np.float64], NDArray[np.int64], float] | None = None
    for share in _OF_DIAGONAL:
        distance = max(share * diagonal, min(single, _OF_DIAGONAL[-1] * diagonal))
        number = _clusters(places, distance)
        found = places[np.unique(number, return_index=True)[1]], _with_corners(exact, number), distance
        if len(found[0]) == len(places):
            found = places, exact, 0.0
        if best is None or is_watertight(found[1]):
            best = found
        if is_watertight(found[1]):
            break
    assert best is not None
    return best


def _with_corners(triangles: NDArray[np.int64], number: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles by new numbers of their vertices, without those that have collapsed."""
    renumbered: NDArray[np.int64] = number[triangles]
    a, b, c = renumbered.T
    proper: NDArray[np.int64] = renumbered[(a != b) & (b != c) & (c != a)]
    return proper


def _clusters(places: NDArray[np.float64], distance: float) -> NDArray[np.int64]:
    """``(n,)``: one number for the places that a chain of short steps joins."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(places).query_pairs(distance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(places),) * 2)
    number: NDArray[np.int64] = np.asarray(connected_components(graph, directed=False)[1]).astype(np.int64)
    return number
