"""How many viewpoints any plan needs at least, wherever in the region its cameras are.

The region of eye positions is parted into cells, and for each cell and viewing direction a set of characteristics is
found that holds all that can be measured from there (:mod:`cells`). The viewpoints of any plan lie in such cells, so
their sets cover all characteristics, and no plan has fewer viewpoints than the least cover by the sets. Cells whose
sets are part of what an actual viewpoint measures need no splitting; of the others those with the largest sets are
split, and the bound rises. The same holds for what might be measured from the middle of a cell: the bound cannot rise
above the least cover by such sets, and when it is as high, or a plan at hand is, the search ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Setup
from ...part import Characteristic
from ..cover.dominance import maximal_rows
from ..cover.minimum_cover import minimum_cover
from ..region import Region
from .cells import CellSets
from .eye_region import first_cell, halves

__all__ = ["ViewpointsBound", "viewpoints_lower_bound"]

_SPLIT_AT_ONCE = 2048
_WORK = 400_000_000  # pairs of a cell and a viewing direction with a measurand's end: some 10 s
_SMALLEST = 1e-4  # of the region's size: cells are not split any more
_COVER_TIME_S = 5.0


@dataclass(frozen=True)
class ViewpointsBound:
    """The least number of viewpoints.

    Parameters
    ----------
    count
        No plan in the region measures all characteristics with fewer viewpoints.
    apart
        Ids of ``count`` > 1 characteristics of which no two can be measured from one viewpoint, where such are known;
        else empty.
    cells
        Cells of eye positions that were examined.
    """

    count: int
    apart: tuple[str, ...]
    cells: int


def viewpoints_lower_bound(
    characteristics: Sequence[Characteristic],
    setup: Setup,
    region: Region,
    *,
    attained: NDArray[np.bool_] | None = None,
    enough: int | None = None,
    work: int = _WORK,
) -> ViewpointsBound:
    """Lower bound of the number of viewpoints that measure all characteristics, over the continuous region.

    Parameters
    ----------
    characteristics
        Those that the plan measures. One that can be measured from nowhere counts for nothing.
    attained
        ``(n, d)``: what actual viewpoints measure, such as the candidates; spares work.
    enough
        Number of viewpoints of a known plan: reached, the bound is as high as it can be.
    work
        Pairs of a cell and a viewing direction with an end of a measurand that are examined at most.
    """
    if not characteristics:
        return ViewpointsBound(0, (), 0)
    sets = CellSets(characteristics, setup, region)
    known = np.zeros((0, len(characteristics)), dtype=bool) if attained is None else np.asarray(attained, dtype=bool)
    low, high = first_cell(region)
    smallest = _SMALLEST * float((high - low).max(initial=0.0))
    found = _Cells.of(sets, low, high)
    best, rows, examined = -1, known, 1
    while True:
        middle = (found.low + found.high) / 2
        known = np.concatenate([known, sets.of(middle, middle)[1]])
        known = known[maximal_rows(known)]
        found = found.part(~_part_of_some(found.sets, known))
        every = np.concatenate([known, found.sets])
        every = every[maximal_rows(every)]
        count = _least_cover(every)
        if count >= best:
            best, rows = count, every
        if (enough is not None and best >= enough) or sets.examined >= work:
            break
        spent = max(sets.examined, 1) / examined
        split = found.largest(every, smallest, max(int((work - sets.examined) / (4 * spent)), 1))
        if not len(split):
            break
        halved = halves(found.low[split], found.high[split])
        examined += len(halved[0])
        found = found.part(~np.isin(found.owner, split)).joined(_Cells.of(sets, *halved))
    apart = _apart(rows, best) if best > 1 else []
    return ViewpointsBound(best, tuple(characteristics[j].id for j in apart), examined)


@dataclass(frozen=True)
class _Cells:
    """Cells ``(n, 3)`` to ``(n, 3)`` mm, and m sets ``(m, d)`` of characteristics, each of the cell ``owner``."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    owner: NDArray[np.int64]
    sets: NDArray[np.bool_]

    @classmethod
    def of(cls, sets: CellSets, low: NDArray[np.float64], high: NDArray[np.float64]) -> _Cells:
        return cls(low, high, *sets.of(low, high))

    def part(self, kept: NDArray[np.bool_]) -> _Cells:
        """Only some of the sets, and the cells that own one."""
        cells, owner = np.unique(self.owner[kept], return_inverse=True)
        return _Cells(self.low[cells], self.high[cells], owner, self.sets[kept])

    def largest(self, maximal: NDArray[np.bool_], smallest_mm: float, most: int) -> NDArray[np.int64]:
        """Cells with a set among the maximal ones, the biggest cells first."""
        which = np.unique(self.owner[np.isin(_keys(self.sets), _keys(maximal))])
        size = (self.high - self.low)[which].max(axis=1, initial=0.0)
        which, size = which[size > smallest_mm], size[size > smallest_mm]
        return np.asarray(which[np.argsort(-size, kind="stable")[: min(_SPLIT_AT_ONCE, most)]])

    def joined(self, other: _Cells) -> _Cells:
        return _Cells(
            np.concatenate([self.low, other.low]),
            np.concatenate([self.high, other.high]),
            np.concatenate([self.owner, other.owner + len(self.low)]),
            np.concatenate([self.sets, other.sets]),
        )


def _keys(sets: NDArray[np.bool_]) -> NDArray[np.void]:
    """One value for each set ``(m, d)``, equal for equal sets."""
    packed = np.ascontiguousarray(np.packbits(sets, axis=1))
    return packed.view(np.dtype((np.void, packed.shape[1])))[:, 0]


def _part_of_some(sets: NDArray[np.bool_], others: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """``(m,)``: the set ``(m, d)`` is part of one of the others ``(k, d)``."""
    shared = sets.astype(np.float32) @ others.T.astype(np.float32)
    return np.asarray((shared == sets.sum(axis=1)[:, None]).any(axis=1))


def _least_cover(sets: NDArray[np.bool_]) -> int:
    """No fewer of the sets cover what they cover together."""
    covered = sets[:, sets.any(axis=0)]
    return minimum_cover(covered, _COVER_TIME_S).lower_bound if covered.shape[1] else 0


def _apart(sets: NDArray[np.bool_], count: int) -> list[int]:
    """``count`` characteristics of which no two are in one set, if they are found; else none."""
    together = sets.T.astype(np.float32) @ sets.astype(np.float32) > 0
    measurable = np.flatnonzero(together.diagonal())
    for first in measurable:
        chosen = [int(first)]
        left = measurable[~together[first, measurable]]
        while len(left):
            # next the one that rules out the fewest of those left
            chosen.append(int(left[together[np.ix_(left, left)].sum(axis=1).argmin()]))
            left = left[~together[chosen[-1], left]]
        if len(chosen) >= count:
            return sorted(chosen[:count])
    return []
