"""Dimensions that no single setting meets, measured from several and averaged: which looks, and how few.

For each dimension the least number of looks is sought whose mean meets the requirement, then as few settings beyond
those that the plan has as may be. The search takes the variance of the mean for its measure, which the law follows
closely, and the law decides. Pairs are looked through in full; larger sets grow from the best pairs by the look that
lowers the variance most, and are mended by exchanging one look at a time. That is a heuristic: that fewer looks or
settings would not do is not proven.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..evaluation import Looks
from ..geometry.pose_error import covariance_factor

__all__ = ["LEAST_SEPARATION_STEPS", "LookCandidates", "LookedDimension", "plan_looks"]

LEAST_SEPARATION_STEPS = 2.0
"""Quantization steps by which both ends must move in the image between two looks whose quantization errors are to
count as independent. Two looks whose images coincide round alike. One step is where the ends are certain to lie in
other cells of the pixel grid; the place in the cell, from which the error follows, is then another, and as good as
even over the cell as soon as what moves the image between the two looks, the repeatability, is half a step or more
(docs: theory, several looks). The other step is room for that."""

_STARTS = 16
_EXCHANGES = 20  # rounds; each lowers the variance, a few are usual
_BLOCK = 256  # rows of the pairs that are looked at at once


@dataclass(frozen=True)
class LookCandidates:
    """The n looks from which one dimension may be measured.

    Parameters
    ----------
    setting
        ``(n,)``: index of each look's setting, each once.
    gauge
        ``(n,)``: index of the gauge among the dimension's.
    looks
        Their errors.
    image_px
        ``(n, 2, 2)``: where the gauge's ends are imaged, px.
    step_px
        Quantization step, px.
    allowed_error_mm
        Largest allowed error of the dimension.
    """

    setting: NDArray[np.int64]
    gauge: NDArray[np.int64]
    looks: Looks
    image_px: NDArray[np.float64]
    step_px: float
    allowed_error_mm: float

    def probability(self, chosen: Sequence[int]) -> float:
        """That the mean of some of the looks is right."""
        return float(self.looks.mean_of(list(chosen)).central_probability(self.allowed_error_mm))


@dataclass(frozen=True)
class LookedDimension:
    """A dimension that the mean of several looks meets.

    Parameters
    ----------
    dimension
        Its index among those that were asked about.
    settings, gauges
        The k looks: index of the setting, ascending, and of the gauge among the dimension's.
    probability_single, probability
        Of the best single look, and of the mean.
    deviation_mm
        Standard deviation of the mean's error.
    """

    dimension: int
    settings: tuple[int, ...]
    gauges: tuple[int, ...]
    probability_single: float
    probability: float
    deviation_mm: float


def plan_looks(
    candidates: Sequence[LookCandidates],
    planned: Collection[int],
    most: int,
    required: float,
    fewest: Mapping[int, int] | None = None,
) -> tuple[LookedDimension, ...]:
    """Of several dimensions those that the mean of 2 to ``most`` looks meets, and by which looks.

    Parameters
    ----------
    candidates
        Of each dimension; none of its looks alone meets the requirement.
    planned
        Settings that the plan has anyway.
    required
        Probability.
    fewest
        For some dimensions the least number of looks to try; 2 for the others.
    """
    searches = {j: _Search(these, required) for j, these in enumerate(candidates) if len(these.setting) > 1}
    found: dict[int, tuple[int, ...]] = {}
    for j, search in searches.items():
        first = max(2, (fewest or {}).get(j, 2))
        sets = (search.surest(k) for k in range(first, min(most, len(candidates[j].setting)) + 1))
        chosen = next((c for c in sets if c and search.probability(c) >= required), None)
        if chosen is not None:
            found[j] = chosen
    # the hardest first: what they cannot do without serves the others
    order = sorted(found, key=lambda j: (-len(found[j]), searches[j].probability(found[j]), j))
    used = {j: searches[j].settings(found[j]) for j in order}
    done: set[int] = set()
    for again in (False, True):  # the second time round all that the others need is known
        for j in order:
            others = [used[i] for i in (order if again else done) if i != j]
            free = set(planned).union(*others)
            found[j] = searches[j].with_few_new(found[j], free)
            used[j] = searches[j].settings(found[j])
            done.add(j)
    return tuple(searches[j].result(j, found[j]) for j in sorted(found))


class _Search:
    """Sets of looks at one dimension."""

    def __init__(self, candidates: LookCandidates, required: float) -> None:
        self._candidates, self._required = candidates, required
        looks = candidates.looks
        self._common = looks.gradient @ covariance_factor(looks.common_covariance)  # (n, 6) mm per unit normal
        self._own = looks.own_variance_mm2
        self._single = (self._common**2).sum(axis=1) + self._own

    def probability(self, chosen: Sequence[int]) -> float:
        return self._candidates.probability(chosen)

    def settings(self, chosen: Sequence[int]) -> set[int]:
        return {int(self._candidates.setting[i]) for i in chosen}

    def surest(self, k: int, among: NDArray[np.bool_] | None = None) -> tuple[int, ...] | None:
        """Of the sets of k looks that are found the surest; None where there is none."""
        among = np.ones(len(self._own), dtype=bool) if among is None else among
        sets = {tuple(sorted(s)) for pair in self._pairs(among) if (s := self._grown(pair, k, among))}
        # ties by the looks themselves: the same result wherever it is computed
        return max(sets, key=lambda s: (self.probability(s), [-i for i in s]), default=None)

    def with_few_new(self, chosen: tuple[int, ...], free: set[int]) -> tuple[int, ...]:
        """As many looks that meet the requirement, from as many free settings as are found."""
        among = np.isin(self._candidates.setting, list(free))
        if among[list(chosen)].all():
            return chosen
        if (alone := self.surest(len(chosen), among)) and self.probability(alone) >= self._required:
            return alone
        for _ in chosen:
            swaps = list(self._swaps(chosen, among))
            if not swaps:
                break
            chosen = max(swaps, key=lambda s: (self.probability(s), [-i for i in s]))
        return chosen

    def result(self, dimension: int, chosen: Sequence[int]) -> LookedDimension:
        candidates = self._candidates
        ordered = sorted(chosen, key=lambda i: int(candidates.setting[i]))
        single = candidates.looks.mean_of(np.arange(len(self._own))[:, None])
        return LookedDimension(
            dimension,
            tuple(int(candidates.setting[i]) for i in ordered),
            tuple(int(candidates.gauge[i]) for i in ordered),
            float(single.central_probability(candidates.allowed_error_mm).max()),
            self.probability(ordered),
            float(candidates.looks.mean_of(ordered).std()),
        )

    def _swaps(self, chosen: tuple[int, ...], among: NDArray[np.bool_]) -> Iterator[tuple[int, ...]]:
        """The sets that meet the requirement with one look less from a new setting."""
        for i in chosen:
            if among[i]:
                continue
            rest = [c for c in chosen if c != i]
            j = self._best_addition(rest, among)
            if j is not None and self.probability(found := tuple(sorted([*rest, j]))) >= self._required:
                yield found

    def _pairs(self, among: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """The best pairs: of each look with its best partner, the best of them."""
        index = np.flatnonzero(among)
        best: list[tuple[float, int, int]] = []
        for first in range(0, len(index), _BLOCK):
            rows = index[first : first + _BLOCK]
            variance = self._single[rows, None] + self._single[index] + 2 * self._common[rows] @ self._common[index].T
            variance = np.where(self._apart(rows, index), variance, np.inf)
            column = np.argmin(variance, axis=1)
            best += zip(variance[np.arange(len(rows)), column], rows, index[column], strict=True)
        pairs = sorted((float(v), int(min(i, j)), int(max(i, j))) for v, i, j in best if v < np.inf)
        return list(dict.fromkeys((i, j) for _, i, j in pairs))[:_STARTS]

    def _grown(self, pair: tuple[int, int], k: int, among: NDArray[np.bool_]) -> list[int] | None:
        chosen = list(pair)
        while len(chosen) < k:
            added = self._best_addition(chosen, among)
            if added is None:
                return None
            chosen.append(added)
        for _ in range(_EXCHANGES):
            before = self._variance(chosen)
            for place in range(k):
                rest = chosen[:place] + chosen[place + 1 :]
                other = self._best_addition(rest, among)
                if other is not None and self._variance([*rest, other]) < self._variance(chosen) * (1 - 1e-9):
                    chosen = [*rest[:place], other, *rest[place:]]
            if not self._variance(chosen) < before:
                break
        return chosen

    def _best_addition(self, chosen: Sequence[int], among: NDArray[np.bool_]) -> int | None:
        """The look that makes the mean's variance least; None where none is apart from all that are chosen."""
        held = list(chosen)
        variance = self._single + 2 * self._common @ self._common[held].sum(axis=0)
        allowed = among & self._apart(np.array(held, dtype=np.int64), np.arange(len(self._own))).all(axis=0)
        return int(np.argmin(np.where(allowed, variance, np.inf))) if allowed.any() else None

    def _variance(self, chosen: Sequence[int]) -> float:
        """Of the sum of the looks."""
        held = list(chosen)
        return float((self._common[held].sum(axis=0) ** 2).sum() + self._own[held].sum())

    def _apart(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(r, c)``: looks from two settings whose images are far enough from each other at both ends."""
        image, setting = self._candidates.image_px, self._candidates.setting
        moved = np.linalg.norm(image[rows][:, None] - image[columns][None], axis=-1).min(axis=-1)
        far = moved >= LEAST_SEPARATION_STEPS * self._candidates.step_px
        return np.asarray(far & (setting[rows][:, None] != setting[columns]))
