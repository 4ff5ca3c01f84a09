"""The fewest viewpoints that cover every characteristic: exact minimum set cover.

What the exact reductions leave is parted into independent components. Each is bracketed between a greedy cover and the
price bound below; a gap is closed by a depth-first search of limited work and, where that is not enough, by HiGHS.

*Price bound*: give each characteristic j a whole price p_j >= 0, and let S be the highest price of what one viewpoint
holds. A cover by k viewpoints pays for everything, so ``sum p <= k S``. The best prices are the dual solution of the
linear relaxation; rounded to whole numbers they bound without any tolerance. With at most K viewpoints allowed, a
viewpoint r is in no cover if what it leaves is too dear for the others: ``sum p - p(r) > (K - 1) S``. (Caprara, Toth,
Fischetti 2000, Algorithms for the set covering problem, Annals of Operations Research 98, sections 2 and 3.)
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cover_search import descend
from .dominance import maximal_rows

__all__ = ["Cover", "minimum_cover", "most_probable_minimum_cover"]

DEFAULT_TIME_LIMIT_S = 60.0
"""Longest search for the fewest viewpoints, and again for the most probable among them. Real parts take well under a
second; a search that is cut off says so by its gap, and only then may two runs differ."""

_SEARCH_STEPS = 200_000_000  # of one depth-first search, about 2 s; counted, not timed, so that two runs agree
_PRICE_UNIT = 1 << 30  # the price that stands for 1 in the linear relaxation


@dataclass(frozen=True)
class Cover:
    """Chosen viewpoints (ascending indices) and the proven lower bound of their number."""

    chosen: tuple[int, ...]
    lower_bound: int

    @property
    def proven(self) -> bool:
        """No smaller cover exists."""
        return len(self.chosen) == self.lower_bound


def minimum_cover(accepted: NDArray[np.bool_], time_limit_s: float = DEFAULT_TIME_LIMIT_S) -> Cover:
    """Fewest rows of ``accepted`` (n viewpoints, d characteristics) whose union holds every column.

    Every column must be held by some row (ValueError otherwise). The cover depends on the set of rows alone, not on
    their order; of equal rows it has the first. When the time is up the best cover so far is returned with the bound
    proven so far.
    """
    _require_cover(accepted)
    rows = _in_order_of_content(accepted)
    chosen, bound = _fewest(accepted[rows], time.monotonic() + time_limit_s)
    return Cover(tuple(sorted(rows[chosen].tolist())), bound)


def most_probable_minimum_cover(
    level: NDArray[np.uint16], time_limit_s: float = DEFAULT_TIME_LIMIT_S, gap: float = 0.0
) -> Cover:
    """Among the covers of least size the one whose weakest characteristic is most probable.

    A viewpoint covers a characteristic at which its level is not 0. The highest threshold at which a cover of the least
    size still exists is found by bisection over the levels that occur. The cover depends on the set of rows alone,
    not on their order; of equal rows it has the first.

    Parameters
    ----------
    level
        ``(n, d)``: viewpoints by characteristics, 0 = not accepted, else the higher the more probable; each
        characteristic above 0 somewhere (ValueError otherwise).
    time_limit_s
        Of the search for the fewest, and again of that for the most probable; when it is up, the best so far.
    gap
        The search for the fewest ends when the lower bound is within this share of the number of viewpoints.
    """
    _require_cover(level > 0)
    rows = _in_order_of_content(level)
    chosen, bound = _fewest(level[rows] > 0, time.monotonic() + time_limit_s, gap=gap)
    if not chosen:
        return Cover((), 0)
    deadline = time.monotonic() + time_limit_s
    best = rows[chosen]
    # a threshold above the best of some characteristic has no cover; at or below the cover at hand nothing is gained
    thresholds = np.unique(level[level <= level.max(axis=0).min()])
    low, high = int(np.searchsorted(thresholds, _weakest(level[best]), side="right")), len(thresholds)
    while low < high and time.monotonic() < deadline:
        # what no cover of this size holds at a threshold, none holds at a higher one
        holds = level[rows] >= thresholds[low - 1]
        rows = rows[_affordable(holds, _best_prices(holds, np.ones(holds.shape[1], np.int64)), len(best))]
        middle = (low + high) // 2
        chosen, _ = _fewest(level[rows] >= thresholds[middle], deadline, enough=len(best))
        if chosen and len(chosen) <= len(best):
            best = rows[chosen]
            low = int(np.searchsorted(thresholds, _weakest(level[best]), side="right"))
        else:
            high = middle
    return Cover(tuple(sorted(best.tolist())), bound)


def _require_cover(accepted: NDArray[np.bool_]) -> None:
    if not accepted.any(axis=0).all():
        raise ValueError("a characteristic is accepted from no viewpoint")


def _weakest(level: NDArray[np.uint16]) -> int:
    return int(level.max(axis=0).min())


def _in_order_of_content(level: NDArray[np.uint16] | NDArray[np.bool_]) -> NDArray[np.int64]:
    """The undominated rows, sorted by what they hold: what follows sees nothing of their order."""
    if level.shape[1] == 0:
        return np.zeros(0, np.int64)
    rows = maximal_rows(level)
    return np.asarray(rows[np.lexsort(level[rows].T)])


# --- the fewest ------------------------------------------------------------------------------------------------------


@dataclass
class _Component:
    """A part of the problem that shares no row and no column with the others, bracketed by cover and bound."""

    rows: NDArray[np.int64]
    holds: NDArray[np.bool_]
    cover: list[int]
    bound: int
    prices: NDArray[np.int64]

    @property
    def open(self) -> bool:
        return self.bound < len(self.cover)


def _fewest(
    holds: NDArray[np.bool_], deadline: float, enough: int | None = None, gap: float = 0.0
) -> tuple[list[int], int]:
    """A least cover and the lower bound of the number of rows.

    With ``enough`` the search ends as soon as it is known whether a cover of so many rows exists. Without any cover,
    which a threshold may have, nothing is chosen and the bound is one more than there are rows. With ``gap`` it ends
    when the bound is within this share of the number of rows.
    """
    if not holds.any(axis=0).all():
        return [], len(holds) + 1
    needed, rows, columns = _reduced(holds)
    split = _components(holds[np.ix_(rows, columns)])
    parts = [_bracketed(rows[r], holds[np.ix_(rows[r], columns[c])]) for r, c in split]
    while time.monotonic() < deadline:
        bound = len(needed) + sum(part.bound for part in parts)
        size = len(needed) + sum(len(part.cover) for part in parts)
        if size - bound <= gap * size or (enough is not None and (size <= enough or bound > enough)):
            break
        part = min((part for part in parts if part.open), key=lambda part: part.holds.size)
        most = len(part.cover) - 1
        if enough is not None:
            most = min(most, enough - (bound - part.bound))
        _narrow(part, most, deadline)
    chosen = needed + [int(part.rows[k]) for part in parts for k in part.cover]
    return sorted(chosen), len(needed) + sum(part.bound for part in parts)


def _reduced(holds: NDArray[np.bool_]) -> tuple[list[int], NDArray[np.int64], NDArray[np.int64]]:
    """Rows that some least cover has, and the rows and columns among which the rest of it is to be chosen.

    In turn until nothing changes: a row that is part of another is left out (in any cover the other takes its place);
    a column is left out whose holders include all holders of another (which covers it); the only holder of a column
    is in every cover.
    """
    needed: list[int] = []
    rows, columns = np.arange(holds.shape[0]), np.arange(holds.shape[1])
    while True:
        before = len(rows), len(columns)
        rows = rows[maximal_rows(holds[np.ix_(rows, columns)])]
        columns = columns[maximal_rows(~holds[np.ix_(rows, columns)].T)]
        part = holds[np.ix_(rows, columns)]
        sole = np.unique(np.nonzero(part[:, part.sum(axis=0) == 1])[0])
        needed += rows[sole].tolist()
        columns = columns[~part[sole].any(axis=0)]
        if len(columns) == 0:
            return needed, rows[:0], columns
        rows = np.delete(rows, sole)
        if (len(rows), len(columns)) == before:
            return needed, rows, columns


def _components(holds: NDArray[np.bool_]) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Rows and columns of each part that no row joins to another."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    if holds.shape[1] == 0:
        return []
    count, label = connected_components(csr_array(holds.T.astype(np.float32) @ holds), directed=False)
    groups = [np.nonzero(label == k)[0] for k in range(count)]
    return [(np.nonzero(holds[:, columns].any(axis=1))[0], columns) for columns in groups]


def _bracketed(rows: NDArray[np.int64], holds: NDArray[np.bool_]) -> _Component:
    """The greedy cover by numbers, and where that is not least the one by prices too, with the price bound."""
    size = holds.sum(axis=1)
    simple = np.asarray(_PRICE_UNIT // np.where(holds, size[:, None], 0).max(axis=0), np.int64)
    cover = _greedy(holds, np.ones(holds.shape[1], np.int64))
    part = _Component(rows, holds, cover, _price_bound(holds, simple), simple)
    if part.open:
        part.prices = _best_prices(holds, simple)
        part.bound = max(part.bound, _price_bound(holds, part.prices))
        part.cover = min(part.cover, _greedy(holds, part.prices + 1), key=len)
    return part


def _greedy(holds: NDArray[np.bool_], worth: NDArray[np.int64]) -> list[int]:
    """A cover by always taking the row whose new columns are worth most, without rows that the others make needless."""
    left, chosen = np.ones(holds.shape[1], dtype=bool), []
    while left.any():
        chosen.append(int(np.argmax(holds @ (worth * left))))
        left &= ~holds[chosen[-1]]
    times = holds[chosen].sum(axis=0)
    for k in chosen.copy():
        if (times[holds[k]] > 1).all():
            chosen.remove(k)
            times -= holds[k]
    return chosen


# --- bounds ----------------------------------------------------------------------------------------------------------


def _best_prices(holds: NDArray[np.bool_], otherwise: NDArray[np.int64]) -> NDArray[np.int64]:
    """Whole prices of the columns that bound best: of the dual of the linear relaxation."""
    from scipy.optimize import linprog  # slow to import
    from scipy.sparse import csr_array

    rows, columns = holds.shape
    result = linprog(np.ones(rows), A_ub=csr_array(-holds.T.astype(float)), b_ub=-np.ones(columns), method="highs-ds")
    if result.x is None or not result.ineqlin.marginals.min() < 0:
        return otherwise
    return np.asarray(np.maximum(-result.ineqlin.marginals, 0) * _PRICE_UNIT, np.int64)


def _price_bound(holds: NDArray[np.bool_], prices: NDArray[np.int64]) -> int:
    return -int(-prices.sum() // (holds @ prices).max())


def _affordable(holds: NDArray[np.bool_], prices: NDArray[np.int64], most: int) -> NDArray[np.bool_]:
    """Rows that may be in a cover of at most so many rows, by the price bound."""
    paid = holds @ prices
    return np.asarray(prices.sum() - paid <= (most - 1) * paid.max())


# --- closing the gap -------------------------------------------------------------------------------------------------


def _narrow(part: _Component, most: int, deadline: float) -> None:
    """Find a cover of at most so many rows, or raise the bound beyond, or as near to it as the time allows."""
    rows = np.nonzero(_affordable(part.holds, part.prices, most))[0]
    bound: float = np.inf  # of the covers by these rows
    if part.holds[rows].any(axis=0).all():
        needed, left, columns = _reduced(part.holds[rows])
        found, bound = _closed(part.holds[np.ix_(rows[left], columns)], most - len(needed), deadline)
        bound += len(needed)
        if found is not None:
            part.cover = rows[[*needed, *left[found]]].tolist()
    part.bound = max(part.bound, int(min(bound, most + 1, len(part.cover))))


def _closed(holds: NDArray[np.bool_], most: int, deadline: float) -> tuple[list[int] | None, float]:
    """A cover of at most so many rows, if one was found, and the lower bound of their number."""
    if holds.shape[1] == 0:
        return ([], 0) if most >= 0 else (None, np.inf)
    if most <= 0:
        return None, np.inf
    found, decided = _searched(holds, most)
    if decided:
        return found, 1 if found is not None else np.inf
    return _solved(holds, most, deadline)


def _solved(holds: NDArray[np.bool_], most: int, deadline: float) -> tuple[list[int] | None, float]:
    """By HiGHS."""
    from scipy.optimize import Bounds, LinearConstraint, milp  # slow to import
    from scipy.sparse import csr_array

    ones = np.ones(len(holds))
    result = milp(
        ones,
        integrality=ones,
        bounds=Bounds(0, 1),
        constraints=[
            LinearConstraint(csr_array(holds.T.astype(float)), lb=1, ub=np.inf),
            LinearConstraint(ones[None], ub=most),
        ],
        options={"time_limit": max(0.0, deadline - time.monotonic())},
    )
    if result.status == 2:  # infeasible
        return None, np.inf
    found = None if result.x is None else np.nonzero(result.x > 0.5)[0].tolist()
    if result.status == 0 and found is not None:
        return found, len(found)
    return found, 1 if result.mip_dual_bound is None else np.ceil(result.mip_dual_bound - 1e-6)


def _searched(holds: NDArray[np.bool_], most: int) -> tuple[list[int] | None, bool]:
    """A cover of at most so many rows by depth-first search, and whether the search came to its end.

    At each node the column left that has the fewest holders is covered by each of them in turn, the cheapest remainder
    first; a remainder too dear for the rows that may still be taken is skipped, and a row whose turn is over is in no
    later branch, since every cover with it has been tried.
    """
    columns = np.argsort(holds.sum(axis=0), kind="stable")  # bit 0 has the fewest holders
    holds = holds[:, columns]
    prices = _best_prices(holds, np.ones(holds.shape[1], np.int64))
    packed = np.packbits(holds, axis=1, bitorder="little")
    packed = np.pad(packed, ((0, 0), (0, -packed.shape[1] % 8)))
    padded = np.pad(prices, (0, 8 * packed.shape[1] - len(prices))).reshape(-1, 8)
    bits = np.unpackbits(np.arange(256, dtype=np.uint8)[:, None], axis=1, bitorder="little").astype(np.int64)
    paid = holds @ prices
    holders = [rows[np.argsort(-paid[rows], kind="stable")] for rows in map(np.flatnonzero, holds.T)]
    ends = np.cumsum([0, *map(len, holders)])
    everything = np.pad(np.packbits(np.ones(len(prices), bool), bitorder="little"), (0, 8))[: packed.shape[1]]
    path, decided = descend(
        np.ascontiguousarray(packed).view(np.uint64), everything.copy().view(np.uint64), np.concatenate(holders), ends,
        padded @ bits.T, paid, most, _SEARCH_STEPS,
    )  # fmt: skip
    return (sorted(set(path.tolist())) if len(path) else None), bool(decided)
