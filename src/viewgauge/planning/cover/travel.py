"""The order in which viewpoints are visited: the shortest closed tour, and the cover that makes it short."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["least_travel", "shortest_tour", "tour_length_mm"]

_MOST_EXACT = 12
"""Viewpoints up to which the shortest tour is found exactly (Held and Karp 1962); 2^11 sets of 11 ends at the most."""


def tour_length_mm(positions: NDArray[np.float64], order: tuple[int, ...]) -> float:
    """Length of a closed tour through positions ``(n, 3)`` mm, straight from one to the next."""
    visited = positions[list(order)]
    return float(np.linalg.norm(visited - np.roll(visited, -1, axis=0), axis=1).sum())


def shortest_tour(positions: NDArray[np.float64]) -> tuple[tuple[int, ...], bool]:
    """A short closed tour that begins at the first of positions ``(n, 3)`` mm, and whether it is proven the shortest.

    Up to 12 positions by dynamic programming (Held and Karp, *J. SIAM* 10 (1962) 196-210); beyond, the nearest
    neighbour first, made shorter by turning parts of it round until nothing helps (2-opt).
    """
    n = len(positions)
    if n <= 3:
        return tuple(range(n)), True
    distance = np.linalg.norm(positions[:, None] - positions, axis=-1)
    if n <= _MOST_EXACT:
        return _exact(distance), True
    return _two_opt(_nearest_neighbour(distance), distance), False


def least_travel(level: NDArray[np.uint16], positions: NDArray[np.float64], chosen: tuple[int, ...]) -> tuple[int, ...]:
    """A cover as good as the chosen one, with a shorter tour where exchanging one viewpoint at a time finds one.

    Parameters
    ----------
    level
        ``(k, d)``: viewpoints by characteristics, 0 = not accepted, else the higher the more probable.
    positions
        ``(k, 3)`` mm.
    chosen
        Rows that cover every characteristic; the weakest characteristic's level is kept, and so is their number.
    """
    best = list(chosen)
    if len(best) < 2:
        return chosen
    least = level[best].max(axis=0).min()
    length = _tour(positions[best])
    improved = True
    while improved:
        improved = False
        for k in range(len(best)):
            others = np.delete(best, k)
            open_ = level[others].max(axis=0) < least
            able = np.flatnonzero((level[:, open_] >= least).all(axis=1))
            near = np.linalg.norm(positions[able, None] - positions[others], axis=-1).sum(axis=1)
            for row in able[np.argsort(near, kind="stable")[:_TRIED]].tolist():
                again = [*others[:k].tolist(), row, *others[k:].tolist()]
                shorter = _tour(positions[again])
                if shorter < length * (1 - 1e-9):
                    best, length, improved = again, shorter, True
                    break
    return tuple(sorted(best))


_TRIED = 32  # viewpoints near to the others that are tried in the place of one


def _tour(positions: NDArray[np.float64]) -> float:
    return tour_length_mm(positions, shortest_tour(positions)[0])


def _exact(distance: NDArray[np.float64]) -> tuple[int, ...]:
    """Over all sets of the positions but the first: the shortest way through a set to each of its members."""
    n = len(distance) - 1
    length = np.full((1 << n, n), np.inf)
    before = np.zeros((1 << n, n), dtype=np.int64)
    for end in range(n):
        length[1 << end, end] = distance[0, end + 1]
    for visited in range(1, 1 << n):
        for end in range(n):
            if visited >> end & 1 and visited != 1 << end:
                ways = length[visited ^ (1 << end)] + distance[1:, end + 1]
                before[visited, end] = np.argmin(ways)
                length[visited, end] = ways[before[visited, end]]
    visited = (1 << n) - 1
    end = int(np.argmin(length[visited] + distance[1:, 0]))
    order = []
    while visited:
        order.append(end + 1)
        visited, end = visited ^ (1 << end), int(before[visited, end])
    return (0, *reversed(order))


def _nearest_neighbour(distance: NDArray[np.float64]) -> list[int]:
    order, left = [0], set(range(1, len(distance)))
    while left:
        order.append(min(left, key=lambda k: (distance[order[-1], k], k)))
        left.remove(order[-1])
    return order


def _two_opt(order: list[int], distance: NDArray[np.float64]) -> tuple[int, ...]:
    n, improved = len(order), True
    while improved:
        improved = False
        for i in range(n - 1):
            for j in range(i + 2, n - (i == 0)):
                a, b, c, d = order[i], order[i + 1], order[j], order[(j + 1) % n]
                gain = distance[a, b] + distance[c, d] - distance[a, c] - distance[b, d]
                if gain > 1e-9 * distance.max():
                    order[i + 1 : j + 1] = reversed(order[i + 1 : j + 1])
                    improved = True
    return tuple(order)
