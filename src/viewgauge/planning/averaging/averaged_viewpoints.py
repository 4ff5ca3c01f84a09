"""Dimensions that no single setting meets, measured from several and averaged: which looks, and how few.

For each dimension the least number of looks is sought whose mean meets the requirement; then, over all of them, as few
settings beyond those that the plan has as are found; then, from those settings, the surest looks. Each step is a
heuristic (:mod:`~viewgauge.planning.averaging.acquisition_search`): that fewer looks or settings would not do is not
proven.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .acquisition_search import LookCandidates, LookSearch

__all__ = ["LookedDimension", "plan_looks"]

_Sets = dict[int, tuple[int, ...]]
"""For each dimension the looks that are averaged, by their place among its candidates."""


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
    searches = {j: LookSearch(these, required) for j, these in enumerate(candidates) if len(these.setting) > 1}
    found: _Sets = {}
    for j, search in searches.items():
        good = search.candidates.good
        counts = range(max(2, (fewest or {}).get(j, 2)), min(most, int(good.sum())) + 1)
        chosen = next((s for k in counts if search.sure(s := search.surest(k, good))), None)
        if chosen is not None:
            found[j] = chosen
    searches = {j: searches[j] for j in found}
    shared = _few_settings(searches, found, set(planned))
    return tuple(_result(j, searches[j].candidates, shared[j]) for j in sorted(shared))


def _few_settings(searches: Mapping[int, LookSearch], found: _Sets, planned: set[int]) -> _Sets:
    """The same dimensions by as many looks from fewer settings.

    One dimension after the other takes what others have taken; in one trial a new setting is one that is good for many
    dimensions, in the other the one that is best for its own. The end with fewer settings is taken, or the surer.
    """
    worth = _worth(searches)
    ends = []
    for favour in ({j: np.zeros(len(w)) for j, w in worth.items()}, worth):
        trial: _Sets = {}
        # the hardest first: what they cannot do without serves the others
        for j in sorted(found, key=lambda j: (-len(found[j]), float(searches[j].candidates.probability(found[j])), j)):
            free = searches[j].among(planned | _used(searches, trial))
            trial[j] = searches[j].with_few_new(found[j], free, favour[j])
        ends.append(_surest(searches, _without_needless(searches, trial, planned), planned))

    def price(sets: _Sets) -> tuple[int, float]:
        weakest = min((float(searches[j].candidates.probability(sets[j])) for j in sets), default=1.0)
        return len(_used(searches, sets) - planned), -weakest

    return min(ends, key=price)


def _worth(searches: Mapping[int, LookSearch]) -> dict[int, NDArray[np.float64]]:
    """For each dimension what the setting of each look is good for: summed over dimensions, least variance over its."""
    total: dict[int, float] = {}
    for search in searches.values():
        variance = np.maximum(search.single_variance, np.finfo(float).tiny)
        for setting, share in zip(search.candidates.setting.tolist(), variance.min() / variance, strict=True):
            total[setting] = total.get(setting, 0.0) + float(share)
    return {j: np.array([total[k] for k in search.candidates.setting.tolist()]) for j, search in searches.items()}


def _without_needless(searches: Mapping[int, LookSearch], sets: _Sets, planned: set[int]) -> _Sets:
    """Without new settings, one by one, in whose place others that are there can step."""
    used = {j: searches[j].settings(chosen) for j, chosen in sets.items()}
    users = {k: [j for j in used if k in used[j]] for k in sorted(_used(searches, sets) - planned)}
    for setting in sorted(users, key=lambda k: (len(users[k]), k)):
        left = (planned | _used(searches, sets)) - {setting}
        instead: _Sets = {}
        for j in sets:
            if setting in searches[j].settings(sets[j]):
                other = searches[j].surest(len(sets[j]), searches[j].among(left))
                if other is None or not searches[j].sure(other):
                    break
                instead[j] = other
        else:
            sets = sets | instead
    return sets


def _surest(searches: Mapping[int, LookSearch], sets: _Sets, planned: set[int]) -> _Sets:
    """From the settings that are there anyway, for each dimension the surest as many looks."""
    there = planned | _used(searches, sets)
    surest = {}
    for j, chosen in sets.items():
        other = searches[j].surest(len(chosen), searches[j].among(there))
        probability = searches[j].candidates.probability
        surest[j] = chosen if other is None or probability(other) <= probability(chosen) else other
    return surest


def _used(searches: Mapping[int, LookSearch], sets: _Sets) -> set[int]:
    return set().union(*(searches[j].settings(chosen) for j, chosen in sets.items()))


def _result(dimension: int, candidates: LookCandidates, chosen: Sequence[int]) -> LookedDimension:
    ordered = sorted(chosen, key=lambda i: int(candidates.setting[i]))
    return LookedDimension(
        dimension,
        tuple(int(candidates.setting[i]) for i in ordered),
        tuple(int(candidates.gauge[i]) for i in ordered),
        float(candidates.probability(np.arange(len(candidates.setting))[:, None]).max()),
        float(candidates.probability(ordered)),
        float(candidates.looks.mean_of(ordered).std()),
    )
