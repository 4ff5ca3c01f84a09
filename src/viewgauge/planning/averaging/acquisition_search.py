"""Sets of acquisitions of one characteristic whose mean meets the requirement.

The search minimises the variance of the mean, which the probability follows closely; the probability decides. All
pairs are compared; larger sets grow from the best pairs by the acquisition that lowers the variance most, and are
improved by exchanging one acquisition at a time. That is a heuristic: that fewer acquisitions would not do is not
proven.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ...evaluation import Acquisitions
from ...geometry.pose_error import covariance_factor

__all__ = ["LEAST_SEPARATION_STEPS", "AcquisitionCandidates", "AcquisitionSearch"]

LEAST_SEPARATION_STEPS = 2.0
"""Quantization steps by which both ends must move in the image between two acquisitions whose quantization errors are
to count as independent. Two acquisitions whose images coincide round alike. One step is where the ends are certain to
lie in other cells of the pixel grid; the place in the cell, from which the error follows, is then another, and as good
as uniform over the cell as soon as what moves the image between the two acquisitions, the repeatability, is half a step
or more (docs: theory, several viewpoints). The other step is room for that."""

_STARTS = 16
_EXCHANGES = 20  # rounds; each lowers the variance, a few are usual
_HOPELESS = 1.5  # times the variance: the law's shape moves the limit by less for any probability of use
_BLOCK = 256  # rows of the pairs that are compared at once


@dataclass(frozen=True)
class AcquisitionCandidates:
    """The n acquisitions from which one characteristic may be measured.

    Parameters
    ----------
    viewpoint
        ``(n,)``: index of each acquisition's viewpoint, each once.
    measurand
        ``(n,)``: index of the measurand among the characteristic's.
    acquisitions
        Their errors.
    image_px
        ``(n, 2, 2)``: where the measurand's ends are imaged, px.
    step_px
        Quantization step, px.
    allowed_error_mm
        Largest allowed error of the characteristic.
    good
        ``(n,)``: the acquisitions among which the fewest are sought; the others serve only where their viewpoints are
        taken for other characteristics.
    """

    viewpoint: NDArray[np.int64]
    measurand: NDArray[np.int64]
    acquisitions: Acquisitions
    image_px: NDArray[np.float64]
    step_px: float
    allowed_error_mm: float
    good: NDArray[np.bool_]

    def probability(self, chosen: NDArray[np.int64] | Sequence[int]) -> NDArray[np.float64]:
        """Probability that the error of the mean of some of the acquisitions, ``(..., k)``, is allowed."""
        return self.acquisitions.mean_of(chosen).central_probability(self.allowed_error_mm)


class AcquisitionSearch:
    """Searches for sets of acquisitions of one characteristic."""

    def __init__(self, candidates: AcquisitionCandidates, required: float) -> None:
        self.candidates, self._required = candidates, required
        acquisitions = candidates.acquisitions
        self._common = acquisitions.gradient @ covariance_factor(
            acquisitions.common_covariance
        )  # (n, 6) mm per unit normal
        self._own = acquisitions.own_variance_mm2
        self.single_variance = np.asarray((self._common**2).sum(axis=1) + self._own)
        """``(n,)`` mm²: of each acquisition by itself."""

    def meets(self, chosen: Sequence[int] | None) -> bool:
        """The mean of these meets the requirement."""
        return chosen is not None and float(self.candidates.probability(chosen)) >= self._required

    def viewpoints(self, chosen: Sequence[int]) -> set[int]:
        """The viewpoints of some acquisitions."""
        return set(self.candidates.viewpoint[list(chosen)].tolist())

    def among(self, viewpoints: Collection[int]) -> NDArray[np.bool_]:
        """``(n,)``: whether acquisitions are from some of these viewpoints."""
        return np.isin(self.candidates.viewpoint, list(viewpoints))

    def most_probable(self, k: int, among: NDArray[np.bool_]) -> tuple[int, ...] | None:
        """Of the sets of k acquisitions that are found among some the most probable; None where there is none."""
        grown = (self._grown(pair, k, among) for pair in self._pairs(among))
        sets = sorted({tuple(sorted(found)) for found in grown if found})
        return sets[int(np.argmax(self.candidates.probability(np.array(sets))))] if sets else None

    def with_few_new(
        self, chosen: tuple[int, ...], free: NDArray[np.bool_], favour: NDArray[np.float64]
    ) -> tuple[int, ...]:
        """As many acquisitions that meet the requirement, as many of them free as are found; of the others the
        favoured.
        """
        alone = self.most_probable(len(chosen), free)
        if self.meets(alone):
            assert alone is not None
            return alone
        acquisitions = list(chosen)
        for place in range(len(acquisitions)):
            rest = acquisitions[:place] + acquisitions[place + 1 :]
            if free[acquisitions[place]]:
                continue
            others = np.flatnonzero(self._apart(np.array(rest), np.arange(len(self._own))).all(axis=0))
            sum_variance = self._variance(rest) + self._added_variance(rest)
            # far more variance than that of the chosen, which meet the requirement: no probability need be computed
            others = others[
                sum_variance[others] <= _HOPELESS * max(self._variance(acquisitions), self._limit(len(acquisitions)))
            ]
            sets = np.column_stack([np.tile(rest, (len(others), 1)), others])
            others = others[self.candidates.probability(sets) >= self._required]
            others = np.union1d(
                others, acquisitions[place]
            )  # itself too: rounding, in another order, must not refuse it
            order = np.lexsort((others, others != acquisitions[place], -favour[others], ~free[others]))
            acquisitions[place] = int(others[order[0]])
        return tuple(sorted(acquisitions))

    def _pairs(self, among: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """The best pairs: of each acquisition with its best partner, the best of them."""
        index = np.flatnonzero(among)
        best: list[tuple[float, int, int]] = []
        for first in range(0, len(index), _BLOCK):
            rows = index[first : first + _BLOCK]
            variance = self.single_variance[rows, None] + self.single_variance[index]
            variance = variance + 2 * self._common[rows] @ self._common[index].T
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
        """The acquisition that makes the mean's variance least; None where none is apart from all that are chosen."""
        index = np.flatnonzero(among)
        index = index[self._apart(np.array(chosen), index).all(axis=0)]
        return int(index[np.argmin(self._added_variance(chosen)[index])]) if len(index) else None

    def _added_variance(self, chosen: Sequence[int]) -> NDArray[np.float64]:
        """``(n,)``: by how much each further acquisition would raise the variance of the sum of the chosen."""
        return np.asarray(self.single_variance + 2 * self._common @ self._common[list(chosen)].sum(axis=0))

    def _limit(self, k: int) -> float:
        """Variance of the sum of k acquisitions at which a normal error would just meet the requirement."""
        return float((k * self.candidates.allowed_error_mm / ndtri((1 + self._required) / 2)) ** 2)

    def _variance(self, chosen: Sequence[int]) -> float:
        """Of the sum of the acquisitions."""
        held = list(chosen)
        return float((self._common[held].sum(axis=0) ** 2).sum() + self._own[held].sum())

    def _apart(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(r, c)``: acquisitions from two viewpoints whose images are far enough from each other at both ends."""
        image, viewpoint = self.candidates.image_px, self.candidates.viewpoint
        step = image[rows][:, None] - image[columns]
        moved = step[..., 0] ** 2 + step[..., 1] ** 2  # of both ends
        far = np.minimum(moved[..., 0], moved[..., 1]) >= (LEAST_SEPARATION_STEPS * self.candidates.step_px) ** 2
        return np.asarray(far & (viewpoint[rows][:, None] != viewpoint[columns]))
