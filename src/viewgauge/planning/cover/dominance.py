"""Viewpoints that no other makes needless, kept while candidates stream by."""

# Why a dominated viewpoint is not needed, and why the order of arrival does not matter.
#
# Row i holds levels a_i (0 = not accepted); b_i is a_i where certain and 0 elsewhere, so b_i <= a_i. Write i <= j,
# "i is dominated by j", for a_i <= b_j in every characteristic. This is transitive: a_i <= b_j <= a_j <= b_k. If i <= j
# and j <= i then a_i <= b_j <= a_j <= b_i <= a_i, so the two are equal and without doubt. Hence
#     i < j  iff  i <= j, and (not j <= i, or j has the lower index)
# is a strict order: it is irreflexive, and if i < j < k then i <= k; would k <= i hold too, all three were equal and
# certain, their indices falling from i over j to k, so i < k in either case. Kept are its maximal elements.
#
# Any order, chunks, machines. The set is finite, so every removed row is below a maximal one. Let S be a part of the
# rows R. A row maximal in R is maximal in S, if there; so nothing that R keeps is lost by keeping max(S) alone, and
# what is removed from max(S) + (R \ S) is below something there, hence in R. What is not maximal in R is below some
# row maximal in R, which is still there. So max(max(S) + (R \ S)) = max(R), for chunks and for merged parts alike.
#
# The cover. Lower any doubtful levels: a' <= a, with a' = a where certain, so b <= a'. If i <= j then
# a'_i <= a_i <= b_j <= a'_j. For a set C of rows let C* have in the place of each removed row a kept one above it.
# Then |C*| <= |C|, and in each characteristic the best level of C*, after the lowering, is at least that of C. So for
# every threshold t a set of k rows that reaches t in every characteristic exists among the kept if it exists at all.
# With t = 1: the least number K is unchanged. With k = K and each t: so is the best weakest level of K viewpoints. A
# row of zeros adds to no cover.

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["Undominated", "maximal_rows", "probability_levels"]

LEVELS = 10_000
"""Levels of probability 1, at the finest."""

_SHARES: tuple[tuple[int, int | None], ...] = ((100_000, None), (1_000_000, 50))
_FEWEST_SHARES = 10
"""Up to how many candidates what lies between the requirement and certainty has how many steps; None: steps of 1e-4."""

_SAMPLE = 512  # rows from which the pivots of the bit masks are taken
_BLOCK = 16  # rows whose bit masks are compared at once: the compiler makes vector instructions of it

_compiled: Callable[[Any], Any] = numba.njit(cache=True, nogil=True)


def probability_levels(probability: NDArray[np.float64], required: float, candidates: int = 0) -> NDArray[np.uint16]:
    r"""Probability in steps: 0 where it misses what is required, else :math:`\max(1, \lfloor p / step \rfloor)`.

    The steps are of 1e-4: the model agrees with the full camera model to 1.5e-4, so a finer comparison of two
    viewpoints means nothing. The fewer levels differ, the more viewpoints are found needless; of very many candidates
    almost none would be, and the search for needless ones, not the evaluation, would take the time. So of more than
    100,000 the steps are a fiftieth of what lies between the requirement and certainty, of more than a million a tenth,
    and never finer. The least number of viewpoints does not depend on the steps; the weakest characteristic's
    probability is the best to within one. Of two probabilities the greater never has the lower level. Whatever is at
    least ``required`` has level 1 at least, however low the requirement.

    Parameters
    ----------
    probability
        ``(...)``, in [0, 1].
    candidates
        Number of viewpoints among which the choice is.
    """
    shares = next((shares for most, shares in _SHARES if candidates <= most), _FEWEST_SHARES)
    step = 1 / LEVELS if shares is None else max(1 / LEVELS, (1 - required) / shares)
    # the quotient is rounded once and monotone; the tolerance lets whole steps be whole
    level = np.clip(np.floor(probability * (1 / step) + 1e-9), 1, LEVELS)
    return np.where(probability >= required, level, 0).astype(np.uint16)


class Undominated:
    """The viewpoints that a least and most probable cover may need, of all that were added.

    A viewpoint is needless if one other is, in every characteristic and beyond doubt, at least as probable; of equal
    ones without doubt the lowest index stays, and what accepts nothing is dropped. The least number of viewpoints that
    cover every characteristic stays the same, and so does the best level that the weakest characteristic can have in
    such a cover, also when doubtful levels turn out lower (proof at the top of this file). What is kept depends
    neither on the order in which viewpoints arrive nor on how they are parted or merged.

    An index names one viewpoint: repeated with the same levels it counts once, met with different ones it is refused.

    Parameters
    ----------
    characteristics
        Number of characteristics d of a row.
    """

    def __init__(self, characteristics: int) -> None:
        self._rows = _Rows.of(
            np.zeros(0, np.int64), np.zeros((0, characteristics), np.uint16), np.zeros((0, characteristics), np.bool_)
        )
        self._characteristics = characteristics

    def add(self, index: NDArray[np.int64], level: NDArray[np.uint16], certain: NDArray[np.bool_]) -> None:
        """Take in m viewpoints.

        Parameters
        ----------
        index
            ``(m,)``, names of the viewpoints.
        level
            ``(m, d)``, 0 where not accepted, else the higher the more probable.
        certain
            ``(m, d)``: False where the level may yet turn out lower, never higher.
        """
        index, level, certain = np.asarray(index), np.asarray(level), np.asarray(certain)
        expected = (len(index), self._characteristics)
        if level.shape != expected or certain.shape != expected:
            raise ValueError(f"level {level.shape} and certain {certain.shape} should both have the shape {expected}")
        if level.dtype != np.uint16 or certain.dtype != np.bool_:
            raise ValueError(f"level is {level.dtype} and certain {certain.dtype}; expected uint16 and bool")
        holds = level.any(axis=1)
        self._take(_Rows.of(index[holds].astype(np.int64), level[holds], certain[holds]))

    def merge(self, other: Undominated) -> None:
        """Take in what another has kept."""
        if other._characteristics != self._characteristics:
            raise ValueError(f"{other._characteristics} characteristics cannot be merged into {self._characteristics}")
        self._take(other._rows)

    def _take(self, new: _Rows) -> None:
        old_stays, new_stays = self._rows.sift(new)
        self._rows = self._rows.part(old_stays).joined(new.part(new_stays)).without_repeats()

    def __len__(self) -> int:
        return len(self._rows.index)

    @property
    def index(self) -> NDArray[np.int64]:
        """``(k,)``, ascending."""
        return np.sort(self._rows.index)

    @property
    def level(self) -> NDArray[np.uint16]:
        """``(k, d)``, in the order of ``index``."""
        return self._rows.level[np.argsort(self._rows.index)]

    @property
    def certain(self) -> NDArray[np.bool_]:
        """``(k, d)``, in the order of ``index``."""
        return self._rows.certain[np.argsort(self._rows.index)]


def maximal_rows(level: NDArray[np.uint16] | NDArray[np.bool_]) -> NDArray[np.int64]:
    """Rows of ``(n, d)``, free of doubt, that no other row reaches everywhere (of equal rows the first), ascending."""
    rows = _Rows.of(np.arange(len(level)), level.astype(np.uint16), np.ones(level.shape, np.bool_))
    nothing = rows.part(np.zeros(len(level), np.bool_))
    return np.sort(rows.index[nothing.sift(rows)[1]])


@dataclass(frozen=True)
class _Rows:
    """Viewpoints in falling order of (sum of certain levels, sum of levels), then by index: dominators come first.

    i <= j means a_i <= b_j, so sum b_i <= sum a_i <= sum b_j <= sum a_j: the dominator has no smaller sum. Are the
    sums of b equal, then a_i = b_j, and j comes first by its sum of levels or, being equal to i, by its index.
    """

    index: NDArray[np.int64]
    level: NDArray[np.uint16]
    certain: NDArray[np.bool_]
    bound: NDArray[np.uint16]  # the level where certain, else 0
    score: NDArray[np.int64]  # sums of bound
    total: NDArray[np.int64]  # sums of level

    @classmethod
    def of(cls, index: NDArray[np.int64], level: NDArray[np.uint16], certain: NDArray[np.bool_]) -> _Rows:
        bound = level * certain
        score, total = bound.sum(axis=1, dtype=np.int64), level.sum(axis=1, dtype=np.int64)
        return cls(index, level, certain, bound, score, total)._ordered()

    def _fields(self) -> tuple[NDArray[Any], ...]:
        return self.index, self.level, self.certain, self.bound, self.score, self.total

    def _ordered(self) -> _Rows:
        order = np.lexsort((self.index, -self.total, -self.score))
        return _Rows(*(values[order] for values in self._fields()))

    def part(self, chosen: NDArray[np.bool_]) -> _Rows:
        return self if chosen.all() else _Rows(*(values[chosen] for values in self._fields()))

    def joined(self, other: _Rows) -> _Rows:
        both = zip(self._fields(), other._fields(), strict=True)
        return _Rows(*(np.concatenate(pair) for pair in both))._ordered()

    def without_repeats(self) -> _Rows:
        """Each index once; ValueError if it came with different levels."""
        order = np.argsort(self.index, kind="stable")
        repeat = np.nonzero(self.index[order[1:]] == self.index[order[:-1]])[0]
        stays = np.ones(len(order), np.bool_)
        for first, second in zip(order[repeat], order[repeat + 1], strict=True):
            same_level = (self.level[first] == self.level[second]).all()
            if not (same_level and (self.bound[first] == self.bound[second]).all()):
                raise ValueError(f"index {self.index[first]} came with two different rows of levels")
            stays[second] = False
        return self.part(stays)

    def sift(self, new: _Rows) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which rows stay of these, of which none dominates another, and which of ``new``."""
        pivots = _pivots(self if len(self.index) >= _SAMPLE else new)
        stays: tuple[NDArray[np.bool_], NDArray[np.bool_]] = _sift(
            *(
                part
                for rows in (self, new)
                for part in (
                    rows.index,
                    rows.level,
                    rows.bound,
                    rows.score,
                    rows.total,
                    _masks(rows.level, pivots),
                    _masks(rows.bound, pivots),
                )
            )
        )
        return stays


def _pivots(rows: _Rows) -> NDArray[np.uint16]:
    """A level that about half of the accepting rows reach, and 1, ``(2, d)``; any others would do, less fast."""
    sample = rows.bound[:: max(1, len(rows.bound) // _SAMPLE)]
    lowest = np.ones(sample.shape[1], np.uint16)
    if not len(sample):
        return lowest[None]
    upper_half = len(sample) - ((sample > 0).sum(axis=0) + 1) // 2
    middle = np.take_along_axis(np.sort(sample, axis=0), np.minimum(upper_half, len(sample) - 1)[None], axis=0)[0]
    return np.stack([middle, lowest]) if (middle > 1).any() else lowest[None]


@_compiled
def _masks(values: Any, pivots: Any) -> Any:
    """Bit masks ``(words, n)`` of the characteristics that reach each pivot."""
    rows, columns = values.shape
    words = (columns + 63) // 64
    masks = np.zeros((pivots.shape[0] * words, rows), np.uint64)
    for i in range(rows):
        for p in range(pivots.shape[0]):
            for j in range(columns):
                bit = np.uint64(values[i, j] >= pivots[p, j]) << np.uint64(j & 63)
                masks[p * words + (j >> 6), i] |= bit
    return masks


@_compiled
def _sift(
    old_index: Any, old_level: Any, old_bound: Any, old_score: Any, old_total: Any, old_asks: Any, old_gives: Any,
    new_index: Any, new_level: Any, new_bound: Any, new_score: Any, new_total: Any, new_asks: Any, new_gives: Any,
) -> Any:  # fmt: skip
    """Rows of both parts in their common order, each against the maximal ones before it; old against new only."""
    n, m = old_index.size, new_index.size
    old_stays, new_stays = np.zeros(n, np.bool_), np.zeros(m, np.bool_)
    old_masks, old_at, old_sums = _empty(old_gives.shape[0], n)
    new_masks, new_at, new_sums = _empty(new_gives.shape[0], m)
    olds, news = 0, 0
    i, k = 0, 0
    while i < n or k < m:
        take_old = k == m
        if i < n and k < m:
            if old_score[i] != new_score[k]:
                take_old = old_score[i] > new_score[k]
            elif old_total[i] != new_total[k]:
                take_old = old_total[i] > new_total[k]
            else:
                take_old = old_index[i] <= new_index[k]
        if take_old:
            if not _below(old_level[i], old_total[i], old_asks[:, i], new_bound, new_masks, new_at, new_sums, news):
                old_stays[i] = True
                old_masks[:, olds], old_at[olds], old_sums[olds] = old_gives[:, i], i, old_score[i]
                olds += 1
            i += 1
        else:
            level, total, asks = new_level[k], new_total[k], new_asks[:, k]
            if not (
                _below(level, total, asks, old_bound, old_masks, old_at, old_sums, olds)
                or _below(level, total, asks, new_bound, new_masks, new_at, new_sums, news)
            ):
                new_stays[k] = True
                new_masks[:, news], new_at[news], new_sums[news] = new_gives[:, k], k, new_score[k]
                news += 1
            k += 1
    return old_stays, new_stays


@_compiled
def _empty(words: int, rows: int) -> Any:
    """Room for rows that stay: their masks, whole blocks of them, their places, and their sums."""
    return np.zeros((words, rows + _BLOCK), np.uint64), np.zeros(rows, np.int64), np.zeros(rows, np.int64)


@_compiled
def _below(level: Any, total: int, asks: Any, bound: Any, masks: Any, at: Any, sums: Any, count: int) -> bool:
    """Whether a row is dominated by one of the first ``count``; sums fall, so too small a sum ends the search."""
    lacks = np.empty(_BLOCK, np.uint64)
    for start in range(0, count, _BLOCK):
        if sums[start] < total:
            return False
        lacks[:] = 0
        for word in range(asks.size):
            ask, gives = asks[word], masks[word, start : start + _BLOCK]
            for b in range(_BLOCK):
                lacks[b] |= ask & ~gives[b]
        full = 0
        for b in range(_BLOCK):
            full += lacks[b] == 0
        if full:
            for b in range(min(_BLOCK, count - start)):
                if lacks[b] == 0 and _reaches(bound[at[start + b]], level):
                    return True
    return False


@_compiled
def _reaches(bound: Any, level: Any) -> bool:
    for j in range(level.size):  # noqa: SIM110 # numba's loop is the fast one
        if bound[j] < level[j]:
            return False
    return True
