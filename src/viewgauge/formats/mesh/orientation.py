"""Outward orientation of watertight triangle meshes, and the shells of which they consist."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from .watertight import triangle_sides

__all__ = ["oriented_outward", "shells"]

_Triangles = NDArray[np.int64]


def oriented_outward(vertices: NDArray[np.float64], triangles: _Triangles) -> _Triangles:
    """The triangles ``(m, 3)`` of a watertight mesh, each counter-clockwise seen from outside the material.

    Within each shell the triangles are made to agree with their neighbours; a shell of negative volume is then
    turned. A shell that lies within another (a cavity) and agreed with itself before is turned where the other is.
    """
    pairs, agree = _neighbours(triangles)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(triangles),) * 2).tocsr()
    count, labels = connected_components(graph, directed=False)
    inconsistent = np.zeros(count, dtype=bool)
    inconsistent[labels[pairs[~agree, 0]]] = True
    result = triangles.copy()
    for label in np.flatnonzero(inconsistent):
        turned = _turned_to_agree(int(np.flatnonzero(labels == label)[0]), graph, pairs, agree)
        result[turned] = result[turned][:, ::-1]
    corners = vertices[result]
    low, high = _boxes(corners, labels, count)
    a, b, c = np.moveaxis(corners - low[labels][:, None], 1, 0)
    volumes = np.bincount(labels, np.einsum("ij,ij->i", a, np.cross(b, c)), count)
    first = np.unique(labels, return_index=True)[1]
    inverted = np.zeros(count, dtype=bool)
    for label in np.argsort(-np.prod(high - low, axis=1), kind="stable").tolist():  # what is around comes first
        around = [
            k
            for k in np.flatnonzero(((low < low[label]) & (high[label] < high)).all(axis=1)).tolist()
            if _is_inside(corners[first[label], 0], corners[labels == k])
        ]
        if around and not inconsistent[label]:  # a cavity, or a body in a body: as it was to what is around it
            nearest = min(around, key=lambda k: float(np.prod(high[k] - low[k])))
            inverted[label] = inverted[nearest]
        else:
            inverted[label] = volumes[label] < 0
    turn = inverted[labels]
    result[turn] = result[turn][:, ::-1]
    return result


def shells(triangles: _Triangles) -> list[NDArray[np.int64]]:
    """Indices of the triangles of each shell of a watertight mesh: of those that a chain of sides joins."""
    pairs, _ = _neighbours(triangles)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(triangles),) * 2)
    labels = connected_components(graph, directed=False)[1]
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)


def _is_inside(point: NDArray[np.float64], corners: NDArray[np.float64]) -> bool:
    """Whether a point lies within a shell of triangles ``(m, 3, 3)``: by the solid angle under which it sees them.

    References
    ----------
    Van Oosterom and Strackee, *IEEE Trans. Biomed. Eng.* 30 (1983) 125-126.
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("ij,ij->i", a, b) * lc
    below += np.einsum("ij,ij->i", b, c) * la + np.einsum("ij,ij->i", c, a) * lb
    return abs(float(np.arctan2(above, below).sum())) > 0.75 * 2 * np.pi


def _neighbours(triangles: _Triangles) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Pairs ``(k, 2)`` of triangles that share an edge, and whether they run along it in opposite senses."""
    edges = triangle_sides(triangles)
    ordered = np.sort(edges, axis=1)
    order = np.lexsort((ordered[:, 1], ordered[:, 0]))
    first, second = order[::2], order[1::2]  # watertight: equal edges come in twos
    return np.stack([first // 3, second // 3], axis=1), edges[first, 0] != edges[second, 0]


def _turned_to_agree(
    start: int, graph: coo_array, pairs: NDArray[np.int64], agree: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Triangles of the shell of ``start`` to be turned so that all agree with it."""
    order, predecessors = breadth_first_order(graph, start, directed=False)
    opposed = {frozenset(pair) for pair in pairs[~agree].tolist()}
    turned = {start: False}
    for triangle in order[1:].tolist():
        before = int(predecessors[triangle])
        turned[triangle] = turned[before] ^ (frozenset((before, triangle)) in opposed)
    return np.array([triangle for triangle, turn in turned.items() if turn], dtype=np.int64)


def _boxes(
    corners: NDArray[np.float64], labels: NDArray[np.int32], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner ``(count, 3)`` of each shell."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, labels, corners.min(axis=1))
    np.maximum.at(high, labels, corners.max(axis=1))
    return low, high
