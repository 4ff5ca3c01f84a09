"""Characteristics that no single viewpoint meets, measured from several and averaged: which acquisitions, and how few.

For each characteristic the least number of acquisitions is sought whose mean meets the requirement; then, over all of
them, as few viewpoints beyond those that the plan has as are found; then, from those viewpoints, the most probable
acquisitions. Each step is a heuristic (:mod:`~viewgauge.planning.averaging.acquisition_search`): that fewer
acquisitions or viewpoints would not do is not proven.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .acquisition_search import AcquisitionCandidates, AcquisitionSearch

__all__ = ["ChosenAcquisitions", "plan_acquisitions"]

_Sets = dict[int, tuple[int, ...]]
"""For each characteristic the acquisitions that are averaged, by their place among its candidates."""


@dataclass(frozen=True)
class ChosenAcquisitions:
    """The acquisitions whose mean meets a characteristic.

    Parameters
    ----------
    characteristic
        Its index among those that were asked about.
    viewpoints, measurands
        The k acquisitions: index of the viewpoint, ascending, and of the measurand among the characteristic's.
    probability_single, probability
        Of the best single acquisition, and of the mean.
    deviation_mm
        Standard deviation of the mean's error.
    """

    characteristic: int
    viewpoints: tuple[int, ...]
    measurands: tuple[int, ...]
    probability_single: float
    probability: float
    deviation_mm: float


def plan_acquisitions(
    candidates: Sequence[AcquisitionCandidates],
    planned: Collection[int],
    most: int,
    required: float,
    fewest: Mapping[int, int] | None = None,
) -> tuple[ChosenAcquisitions, ...]:
    """Of several characteristics those that the mean of 2 to ``most`` acquisitions meets, and by which acquisitions.

    Parameters
    ----------
    candidates
        Of each characteristic; none of its acquisitions alone meets the requirement.
    planned
        Viewpoints that the plan has anyway.
    required
        Probability.
    fewest
        For some characteristics the least number of acquisitions to try; 2 for the others.
    """
    searches = {j: AcquisitionSearch(these, required) for j, these in enumerate(candidates) if len(these.viewpoint) > 1}
    found: _Sets = {}
    for j, search in searches.items():
        good = search.candidates.good
        counts = range(max(2, (fewest or {}).get(j, 2)), min(most, int(good.sum())) + 1)
        chosen = next((s for k in counts if search.meets(s := search.most_probable(k, good))), None)
        if chosen is not None:
            found[j] = chosen
    searches = {j: searches[j] for j in found}
    shared = _few_viewpoints(searches, found, set(planned))
    return tuple(_result(j, searches[j].candidates, shared[j]) for j in sorted(shared))


def _few_viewpoints(searches: Mapping[int, AcquisitionSearch], found: _Sets, planned: set[int]) -> _Sets:
    """The same characteristics by as many acquisitions from fewer viewpoints.

    One characteristic after the other takes what others have taken; in one trial a new viewpoint is one that is good
    for many characteristics, in the other the one that is best for its own. The result with fewer viewpoints is taken;
    of equally many, the one whose weakest characteristic is more probable.
    """
    worth = _worth(searches)
    ends = []
    for favour in ({j: np.zeros(len(w)) for j, w in worth.items()}, worth):
        trial: _Sets = {}
        # the hardest first: what they cannot do without serves the others
        for j in sorted(found, key=lambda j: (-len(found[j]), float(searches[j].candidates.probability(found[j])), j)):
            free = searches[j].among(planned | _used(searches, trial))
            trial[j] = searches[j].with_few_new(found[j], free, favour[j])
        ends.append(_most_probable(searches, _without_needless(searches, trial, planned), planned))

    def price(sets: _Sets) -> tuple[int, float]:
        weakest = min((float(searches[j].candidates.probability(sets[j])) for j in sets), default=1.0)
        return len(_used(searches, sets) - planned), -weakest

    return min(ends, key=price)


def _worth(searches: Mapping[int, AcquisitionSearch]) -> dict[int, NDArray[np.float64]]:
    """For each characteristic the worth of the viewpoint of each of its acquisitions.

    The worth of a viewpoint is the sum, over the characteristics, of the least variance over the variance from there.
    """
    total: dict[int, float] = {}
    for search in searches.values():
        variance = np.maximum(search.single_variance, np.finfo(float).tiny)
        for viewpoint, share in zip(search.candidates.viewpoint.tolist(), variance.min() / variance, strict=True):
            total[viewpoint] = total.get(viewpoint, 0.0) + float(share)
    return {j: np.array([total[k] for k in search.candidates.viewpoint.tolist()]) for j, search in searches.items()}


def _without_needless(searches: Mapping[int, AcquisitionSearch], sets: _Sets, planned: set[int]) -> _Sets:
    """The same without new viewpoints that others can replace, tried one by one."""
    used = {j: searches[j].viewpoints(chosen) for j, chosen in sets.items()}
    users = {k: [j for j in used if k in used[j]] for k in sorted(_used(searches, sets) - planned)}
    for viewpoint in sorted(users, key=lambda k: (len(users[k]), k)):
        left = (planned | _used(searches, sets)) - {viewpoint}
        instead: _Sets = {}
        for j in sets:
            if viewpoint in searches[j].viewpoints(sets[j]):
                other = searches[j].most_probable(len(sets[j]), searches[j].among(left))
                if other is None or not searches[j].meets(other):
                    break
                instead[j] = other
        else:
            sets = sets | instead
    return sets


def _most_probable(searches: Mapping[int, AcquisitionSearch], sets: _Sets, planned: set[int]) -> _Sets:
    """From the viewpoints that are there anyway, for each characteristic the most probable as many acquisitions."""
    there = planned | _used(searches, sets)
    most_probable = {}
    for j, chosen in sets.items():
        other = searches[j].most_probable(len(chosen), searches[j].among(there))
        probability = searches[j].candidates.probability
        most_probable[j] = chosen if other is None or probability(other) <= probability(chosen) else other
    return most_probable


def _used(searches: Mapping[int, AcquisitionSearch], sets: _Sets) -> set[int]:
    return set().union(*(searches[j].viewpoints(chosen) for j, chosen in sets.items()))


def _result(characteristic: int, candidates: AcquisitionCandidates, chosen: Sequence[int]) -> ChosenAcquisitions:
    ordered = sorted(chosen, key=lambda i: int(candidates.viewpoint[i]))
    return ChosenAcquisitions(
        characteristic,
        tuple(int(candidates.viewpoint[i]) for i in ordered),
        tuple(int(candidates.measurand[i]) for i in ordered),
        float(candidates.probability(np.arange(len(candidates.viewpoint))[:, None]).max()),
        float(candidates.probability(ordered)),
        float(candidates.acquisitions.mean_of(ordered).std()),
    )
