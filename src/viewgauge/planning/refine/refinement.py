"""From the best of the sampled viewpoints to the best there is: fewer, and more probable.

Three steps are tried in turn, each by searches over all poses that the region allows
(:mod:`~viewgauge.planning.refine.pose_search`), which start from the viewpoints at hand:

- *reach*: each characteristic that no viewpoint measures as required gets searches of its own;
- *raise*: each chosen viewpoint moves to where the weakest of what it measures is most probable, and viewpoints are
  sought that are worth more than one at a higher requirement;
- *fewer*: viewpoints are sought that make the cover smaller: those that hold characteristics worth more than one
  viewpoint by the prices of the linear relaxation (column generation), and those that can replace two.

Whatever is found joins the viewpoints to choose from, and the cover is chosen again.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Evaluator
from ..cover.prices import characteristic_prices
from ..cover.viewpoint_pool import ViewpointPool
from ..region import Region
from .pose_search import PoseSearch

__all__ = ["Refinement", "RefinementStep", "Refiner"]

_WIDE, _NEAR, _CLOSE = PoseSearch(64, 12, 2.0), PoseSearch(64, 24, 1.0), PoseSearch(192, 40, 0.5)
_STARTS = 24  # of a search, of the viewpoints at hand
_OTHERS = 11  # viewpoints from which a better pose of one is sought, beside its own
_PAIRS = 30  # of viewpoints that may become one: no more are tried
_ROUNDS = 6  # of searching for fewer in vain
_WORTH_MORE = 1e-6  # than one viewpoint
_STEP = 1e-4  # of the weakest characteristic's probability, from which a change is worth another round
_RAISED = 0.1  # of what lies between the weakest probability and 1: how much higher is asked for

_Score = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class RefinementStep:
    """An arrangement in three numbers."""

    name: str
    count: int
    met: int
    weakest: float


@dataclass(frozen=True)
class Refinement:
    """What refining a plan changed.

    Parameters
    ----------
    steps
        After each step, the sampled plan's own first: its name, the number of viewpoints, the number of characteristics
        met, and the probability of the weakest of them.
    reached
        Indices of characteristics that only viewpoints found here measure as required.
    generated
        How many viewpoints found here were kept to choose from.
    finished
        It ended because nothing helped any more, not because the time was up or it was interrupted.
    """

    steps: tuple[RefinementStep, ...]
    reached: tuple[int, ...]
    generated: int
    finished: bool


class Refiner:
    """Improves an arrangement of viewpoints.

    Parameters
    ----------
    evaluator
        Of all d characteristics.
    region
        Where a viewpoint may be.
    pool
        Viewpoints to choose from, at least those of the arrangement.
    measurand_middle
        ``(d, 3)`` mm, part frame: about where each characteristic is.
    least
        Number of viewpoints that is known to be needed, whatever the viewpoints.
    """

    def __init__(
        self,
        evaluator: Evaluator,
        region: Region,
        required: float,
        pool: ViewpointPool,
        measurand_middle: NDArray[np.float64],
        *,
        seed: int,
        deadline: float,
        least: int = 1,
    ) -> None:
        self._evaluator, self._region, self._required = evaluator, region, required
        self._middle, self._deadline, self._least = measurand_middle, deadline, least
        self._rng = np.random.default_rng(seed)
        self._of: dict[tuple[int, ...], Evaluator] = {}
        self._sampled = len(pool)
        self.pool = pool
        self.nearest: dict[int, NDArray[np.float64]] = {}
        """Of characteristics that were searched for apart, by index, the best pose ``(4, 4)`` mm."""

    def improved(self, chosen: ViewpointPool, bound: int) -> tuple[ViewpointPool, int, Refinement]:
        """A better arrangement or the same, the lower bound among all viewpoints known, and what has changed."""
        reached = self.pool.reached(self._required)
        best, steps, finished = (chosen, bound), [self._reported("sampled", chosen)], False
        try:
            for name, step in (("reach", self._reach), ("raise", self._more_probable), ("fewer", self._fewer)):
                best = self._better(step(*best), best)
                steps.append(self._reported(name, best[0]))
            finished = not self._late()
        except KeyboardInterrupt:
            pass  # what was found so far counts
        found = tuple(np.setdiff1d(best[0].reached(self._required), reached).tolist())
        return *best, Refinement(tuple(steps), found, len(self.pool) - self._sampled, finished)

    def _reported(self, name: str, chosen: ViewpointPool) -> RefinementStep:
        met = len(chosen.reached(self._required))
        return RefinementStep(name, len(chosen), met, chosen.weakest(self._required))

    # --- the three steps ---------------------------------------------------------------------------------------------

    def _reach(self, chosen: ViewpointPool, bound: int) -> tuple[ViewpointPool, int]:
        missing = np.setdiff1d(np.arange(self.pool.probability.shape[1]), self.pool.reached(self._required))
        if not len(missing):
            return chosen, bound
        for j in missing.tolist():
            if self._late():
                break
            found = self._acquisition([j], lambda p: p[:, 0], _WIDE, _NEAR)
            first = found.taken(found.probability[:, j].argsort()[-1:])
            found = self._searched(first, np.array([j]), lambda p: p[:, 0], _CLOSE)
            self._add(found)
            self.nearest[j] = found.T_part_camera[0]
        return self._chosen_again((chosen, bound))

    def _fewer(self, chosen: ViewpointPool, bound: int) -> tuple[ViewpointPool, int]:
        idle = 0
        while len(chosen) > max(self._least, 1) and idle < _ROUNDS and not self._late():
            known = len(self.pool)
            found = self._price(self._required)
            if idle == 0:
                self._merge(chosen)
            if len(self.pool) == known and not found:
                break
            again = self._chosen_again((chosen, bound))
            idle = 0 if len(again[0]) < len(chosen) else idle + 1
            if not idle:
                again = self._more_probable(*again)
            chosen, bound = again
        return chosen, bound

    def _more_probable(self, chosen: ViewpointPool, bound: int) -> tuple[ViewpointPool, int]:
        best = self._moved(chosen), bound
        while len(best[0]) and not self._late():
            weakest = best[0].weakest(self._required)
            self._price(weakest + _RAISED * (1 - weakest))
            again = self._chosen_again(best)
            again = self._moved(again[0]), again[1]
            if again[0].weakest(self._required) < weakest + _STEP:
                return self._better(again, best)
            best = again
        return best

    # --- their parts -------------------------------------------------------------------------------------------------

    def _moved(self, chosen: ViewpointPool) -> ViewpointPool:
        """Each viewpoint where the weakest of what it measures is most probable, again and again until little
        changes.
        """
        while len(chosen) and not self._late():
            weakest, sum_before = chosen.weakest(self._required), chosen.best().sum()
            for k in range(len(chosen)):
                best = chosen.best()
                mine = np.flatnonzero((chosen.measured_from() == k) & (best >= self._required))
                if not len(mine) or self._late():
                    continue
                others = np.delete(chosen.probability[:, mine], k, axis=0).max(axis=0, initial=0.0)
                chosen = self._better((self._replaced(chosen, k, mine, partial(_weakest, others)), 0), (chosen, 0))[0]
            if chosen.weakest(self._required) < weakest + _STEP and chosen.best().sum() < sum_before + _STEP:
                break
        self._add(chosen)
        return chosen

    def _replaced(self, chosen: ViewpointPool, k: int, mine: NDArray[np.int64], score: _Score) -> ViewpointPool:
        """Viewpoint k where it scores best, sought from where it is and from the best others for what it measures."""
        order = np.argsort(-score(self.pool.probability[:, mine]), kind="stable")[:_OTHERS]
        starts = chosen.taken(np.array([k])).joined(self.pool.taken(order))
        found = self._searched(starts, mine, score, _NEAR)
        first = found.taken(score(found.probability[:, mine]).argsort()[-1:])
        rows = np.arange(len(chosen))
        others = chosen.taken(rows[rows != k]).joined(self._searched(first, mine, score, _CLOSE))
        return others.taken(np.insert(rows[:-1], k, len(rows) - 1))

    def _price(self, threshold: float) -> bool:
        """Search for viewpoints worth more than one; whether there was any."""
        pool = self.pool.taken(self.pool.worthwhile(self._required))
        reached = self.pool.reached(self._required)
        if not len(reached):
            return False
        prices, _ = characteristic_prices(pool.probability[:, reached] >= threshold)
        worth = reached[prices > 0]
        price = prices[prices > 0]

        def score(p: NDArray[np.float64]) -> NDArray[np.float64]:
            return _counted(p, threshold) @ price

        found = self._acquisition(worth.tolist(), score, _NEAR)
        return bool(((found.probability[:, worth] >= threshold) @ price > 1 + _WORTH_MORE).any())

    def _merge(self, chosen: ViewpointPool) -> None:
        """Search for viewpoints that replace two of the chosen ones, first of those that measure the least."""
        owner, met = chosen.measured_from(), chosen.best() >= self._required
        pairs = itertools.combinations(range(len(chosen)), 2)
        of_both = [np.flatnonzero(met & np.isin(owner, pair)) for pair in pairs]
        for both in sorted(of_both, key=len)[:_PAIRS]:
            if self._late():
                return
            self._acquisition(both.tolist(), lambda p: _counted(p, self._required).mean(axis=1), _NEAR)

    def _acquisition(self, characteristics: Sequence[int], score: _Score, *searches: PoseSearch) -> ViewpointPool:
        """Search from the best viewpoints at hand, one search after the other; what is found joins the pool."""
        asked = np.array(characteristics, dtype=np.int64)
        found = self.pool.taken(np.argsort(-score(self.pool.probability[:, asked]), kind="stable")[:_STARTS])
        for search in searches:
            found = self._searched(found, asked, score, search)
        self._add(found)
        return found

    def _searched(
        self, starts: ViewpointPool, characteristics: NDArray[np.int64], score: _Score, search: PoseSearch
    ) -> ViewpointPool:
        evaluator = self._evaluator_of(tuple(characteristics.tolist()))

        def value(poses: NDArray[np.float64]) -> NDArray[np.float64]:
            values = np.full(len(poses), -np.inf)
            allowed = np.flatnonzero(self._region.allows(poses))
            if len(allowed):
                values[allowed] = score(evaluator.probabilities(poses[allowed]))
            return values

        poses = starts.T_part_camera
        ahead = self._middle[characteristics].mean(axis=0) - poses[:, :3, 3]
        distance = np.linalg.norm(ahead, axis=1)
        depth = np.einsum("ni,ni->n", ahead, poses[:, :3, 2])
        poses, _ = search.best(poses, np.maximum(depth, 0.2 * distance), value, self._rng)
        return ViewpointPool(poses, self._certain_probability(poses))

    def _certain_probability(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Probabilities of all characteristics; 0 where the small-error model does not answer for one."""
        table = self._evaluator.table(poses)
        return np.where(table.visible & (table.validity == 0), table.probability, 0.0)

    def _evaluator_of(self, characteristics: tuple[int, ...]) -> Evaluator:
        if characteristics not in self._of:
            self._of[characteristics] = self._evaluator.of(characteristics)
        return self._of[characteristics]

    def _add(self, found: ViewpointPool) -> None:
        """Add to the pool what no viewpoint there makes needless."""
        some = found.taken(np.flatnonzero((found.probability >= self._required).any(axis=1)))
        joined = self.pool.joined(some)
        kept = joined.worthwhile(self._required)
        new = kept[kept >= len(self.pool)]
        if len(new):
            self.pool = self.pool.joined(joined.taken(new))

    def _chosen_again(self, best: tuple[ViewpointPool, int]) -> tuple[ViewpointPool, int]:
        cover = self.pool.most_probable_cover(self._required, max(0.0, self._deadline - time.monotonic()))
        return self._better(cover, best)

    def _better(self, a: tuple[ViewpointPool, int], b: tuple[ViewpointPool, int]) -> tuple[ViewpointPool, int]:
        """The one that meets more, then has fewer viewpoints, then is more probable; of equal ones the latter."""
        return a if self._rank(a[0]) > self._rank(b[0]) else b

    def _rank(self, chosen: ViewpointPool) -> tuple[float, ...]:
        best = chosen.best()
        met = best >= self._required
        return int(met.sum()), -len(chosen), chosen.weakest(self._required), float(best[met].sum())

    def _late(self) -> bool:
        return time.monotonic() >= self._deadline


def _counted(probability: NDArray[np.float64], threshold: float) -> NDArray[np.float64]:
    """1 where the threshold is reached, and below it less than a half, the more the nearer: it leads uphill."""
    return np.where(probability >= threshold, 1.0, 0.5 * probability / threshold)


def _weakest(otherwise: NDArray[np.float64], probability: NDArray[np.float64]) -> NDArray[np.float64]:
    """The least of each row, and by a little their mean, so that the others count where the least is the same."""
    probability = np.maximum(probability, otherwise)
    return np.asarray(probability.min(axis=1) + 1e-4 * probability.mean(axis=1))
