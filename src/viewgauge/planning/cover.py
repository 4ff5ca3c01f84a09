"""The fewest settings that cover every dimension: exact minimum set cover by HiGHS."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

__all__ = ["Cover", "minimum_cover", "surest_minimum_cover"]

DEFAULT_TIME_LIMIT_S = 60.0
"""Longest search for the fewest settings, and again for the surest among them. Real parts take well under a
second; a search that is cut off says so by its gap, and only then may two runs differ."""

_ROWS_PER_BLOCK = 1024  # of the pairwise comparison in which dominated settings are found


@dataclass(frozen=True)
class Cover:
    """Chosen settings (ascending indices) and the proven lower bound of their number."""

    chosen: tuple[int, ...]
    lower_bound: int

    @property
    def proven(self) -> bool:
        """No smaller cover exists."""
        return len(self.chosen) == self.lower_bound


def minimum_cover(accepted: NDArray[np.bool_], time_limit_s: float = DEFAULT_TIME_LIMIT_S) -> Cover:
    """Fewest rows of ``accepted`` (n settings, d dimensions) whose union holds every column.

    Every column must be held by some row (ValueError otherwise). When the time is up the best cover so far is
    returned with the bound proven so far.
    """
    if accepted.shape[1] == 0:
        return Cover((), 0)
    if not accepted.any(axis=0).all():
        raise ValueError("a dimension is accepted from no setting")
    rows = _undominated(accepted)
    holds = accepted[rows]
    result = milp(
        np.ones(len(rows)),
        integrality=np.ones(len(rows)),
        bounds=Bounds(0, 1),
        constraints=LinearConstraint(csr_array(holds.T.astype(float)), lb=1, ub=np.inf),
        options={"time_limit": time_limit_s},
    )
    if result.x is None:  # the time was up before a first cover was found
        return Cover(tuple(sorted(rows[_greedy(holds)])), 1)
    chosen = rows[np.nonzero(result.x > 0.5)[0]]
    bound = len(chosen) if result.status == 0 else int(np.ceil(result.mip_dual_bound - 1e-6))
    return Cover(tuple(sorted(int(k) for k in chosen)), max(1, bound))


def surest_minimum_cover(
    probability: NDArray[np.float64], required: float, time_limit_s: float = DEFAULT_TIME_LIMIT_S
) -> Cover:
    """Among the covers of least size the one whose weakest dimension is surest.

    A setting covers a dimension that it measures with at least the required probability. The largest threshold
    at which a cover of the least size still exists is found by bisection over the probabilities that occur.

    Parameters
    ----------
    probability
        ``(n, d)``: settings by dimensions, each dimension reaching ``required`` somewhere.
    """
    smallest = minimum_cover(probability >= required, time_limit_s)
    if not smallest.chosen:
        return smallest
    # a threshold beyond the best of some dimension has no cover; below the cover at hand nothing is gained
    attained = probability[list(smallest.chosen)].max(axis=0).min()
    highest = probability.max(axis=0).min()
    thresholds = np.unique(probability[(probability > attained) & (probability <= highest)])
    best, low, high = smallest, 0, len(thresholds)
    deadline = time.monotonic() + time_limit_s
    while low < high and (left := deadline - time.monotonic()) > 0:
        middle = (low + high) // 2
        cover = minimum_cover(probability >= thresholds[middle], left)
        if len(cover.chosen) == len(smallest.chosen):
            best, low = cover, middle + 1
        else:
            high = middle
    return Cover(best.chosen, smallest.lower_bound)


def _undominated(accepted: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Rows that are no subset of another row (of equal rows the first): a minimum cover needs no other.

    In any cover a dominated row can be replaced by one that dominates it.
    """
    _, first = np.unique(np.packbits(accepted, axis=1), axis=0, return_index=True)
    first = np.sort(first)
    holds = accepted[first].astype(np.float32)
    dominated = np.zeros(len(first), dtype=bool)
    for start in range(0, len(first), _ROWS_PER_BLOCK):
        block = holds[start : start + _ROWS_PER_BLOCK]
        missing = block @ (1 - holds).T  # what row j lacks of row i
        missing[np.arange(len(block)), np.arange(start, start + len(block))] = 1
        dominated[start : start + len(block)] = (missing == 0).any(axis=1)
    return np.asarray(first[~dominated])


def _greedy(holds: NDArray[np.bool_]) -> list[int]:
    """A cover by always taking the row that holds most of what is left."""
    left, chosen = np.ones(holds.shape[1], dtype=bool), []
    while left.any():
        chosen.append(int(np.argmax(holds[:, left].sum(axis=1))))
        left &= ~holds[chosen[-1]]
    return chosen
