"""The least set of settings, against trying every subset."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from planning_strategies import acceptances, probability_tables

from viewgauge.planning import cover as cover_module
from viewgauge.planning import minimum_cover, surest_minimum_cover


def covers(accepted, chosen) -> bool:
    return all(any(accepted[k][j] for k in chosen) for j in range(accepted.shape[1]))


def every_least_cover(accepted):
    """All covers of least size, by trying the subsets in order of size."""
    for size in range(len(accepted) + 1):
        found = [chosen for chosen in combinations(range(len(accepted)), size) if covers(accepted, chosen)]
        if found:
            return found
    raise AssertionError("no cover at all")


@settings(max_examples=400, deadline=None)
@given(accepted=acceptances())
def test_equals_brute_force(accepted):
    cover = minimum_cover(accepted)
    least = every_least_cover(accepted)
    assert cover.chosen in least
    assert cover.lower_bound == len(least[0])
    assert cover.proven


@settings(max_examples=300, deadline=None)
@given(case=probability_tables())
def test_the_surest_of_the_least_equals_brute_force(case):
    probability, required = case
    cover = surest_minimum_cover(probability, required)
    least = every_least_cover(probability >= required)
    assert len(cover.chosen) == len(least[0])
    assert covers(probability >= required, cover.chosen)
    assert cover.proven
    if probability.shape[1]:
        surest = max(min(max(probability[k, j] for k in c) for j in range(probability.shape[1])) for c in least)
        assert min(max(probability[k, j] for k in cover.chosen) for j in range(probability.shape[1])) == surest


def test_no_dimension_needs_no_setting():
    assert minimum_cover(np.zeros((4, 0), dtype=bool)).chosen == ()
    assert surest_minimum_cover(np.zeros((4, 0)), 0.9).proven
    assert surest_minimum_cover(np.zeros((0, 0)), 0.9).chosen == ()


def test_a_dimension_that_nothing_accepts_is_refused():
    with pytest.raises(ValueError, match="accepted from no setting"):
        minimum_cover(np.array([[True, False], [True, False]]))
    with pytest.raises(ValueError, match="accepted from no setting"):
        minimum_cover(np.zeros((0, 1), dtype=bool))


def test_greedy_is_not_enough():
    """Where always taking the best row needs three rows, two do."""
    accepted = np.array([[1, 1, 1, 1, 0, 0], [1, 0, 1, 0, 1, 0], [0, 1, 0, 1, 0, 1]], dtype=bool)
    assert minimum_cover(accepted).chosen == (1, 2)


def test_the_same_input_gives_the_same_cover():
    rng = np.random.default_rng(3)
    probability = rng.random((100, 15)) ** 0.3
    first = surest_minimum_cover(probability, 0.9)
    assert all(surest_minimum_cover(probability, 0.9) == first for _ in range(3))


def test_the_order_of_settings_does_not_change_how_sure_it_is():
    rng = np.random.default_rng(4)
    probability = rng.random((200, 12)) ** 0.3
    best = [
        probability[order][list(surest_minimum_cover(probability[order], 0.9).chosen)].max(axis=0).min()
        for order in (np.arange(200), rng.permutation(200), rng.permutation(200))
    ]
    assert best[0] == best[1] == best[2]


def test_many_rows_are_reduced_to_the_undominated_across_blocks():
    """More rows than one block of the pairwise comparison holds, each copied: the two whole rows win."""
    rng = np.random.default_rng(5)
    accepted = rng.random((3000, 14)) < 0.3
    accepted[1700] = [True] * 7 + [False] * 7
    accepted[2950] = [False] * 7 + [True] * 7
    twice = np.vstack([accepted, accepted])
    cover = minimum_cover(twice)
    assert len(cover.chosen) == 2
    assert covers(twice, cover.chosen)
    assert max(cover.chosen) < 3000, "of equal rows the first"


def test_hard_instance_is_solved_to_proof():
    """The Steiner triple system A9: 9 points hit all of 12 triples with 5 at least (Fulkerson et al. 1974)."""
    triples = [(a, b, c) for a, b, c in combinations(range(9), 3) if _on_a_line(a, b, c)]
    assert len(triples) == 12
    accepted = np.zeros((9, 12), dtype=bool)
    for j, triple in enumerate(triples):
        accepted[list(triple), j] = True
    cover = minimum_cover(accepted)
    assert len(cover.chosen) == cover.lower_bound == 5


def _on_a_line(*points) -> bool:
    """Three points of the affine plane over GF(3) are on a line if their coordinates sum to 0."""
    return all(sum(p // 3**axis % 3 for p in points) % 3 == 0 for axis in range(2))


# --- when the time is up ---------------------------------------------------------------------------------------------


def random_instance():
    rng = np.random.default_rng(6)
    accepted = rng.random((60, 40)) < 0.15
    accepted[np.arange(40) % 60, np.arange(40)] = True
    return accepted


def test_time_up_before_any_cover_still_gives_a_cover_with_an_honest_bound(monkeypatch):
    monkeypatch.setattr(cover_module, "milp", lambda *_, **__: SimpleNamespace(x=None, status=1, mip_dual_bound=None))
    accepted = random_instance()
    cover = minimum_cover(accepted, time_limit_s=1e-9)
    assert covers(accepted, cover.chosen)
    assert len(set(cover.chosen)) == len(cover.chosen)
    assert cover.lower_bound == 1
    assert not cover.proven


def test_time_up_with_a_cover_at_hand_keeps_it_and_the_bound_proven_so_far(monkeypatch):
    accepted = random_instance()
    rows = cover_module._undominated(accepted)

    def cut_off(c, **_):
        return SimpleNamespace(x=np.ones_like(c), status=1, mip_dual_bound=3.2)

    monkeypatch.setattr(cover_module, "milp", cut_off)
    cover = minimum_cover(accepted)
    assert cover.chosen == tuple(rows)
    assert cover.lower_bound == 4
    assert not cover.proven


def test_a_search_without_time_still_gives_a_cover_with_an_honest_bound():
    accepted = random_instance()
    proven = minimum_cover(accepted)
    assert proven.proven
    cover = surest_minimum_cover(accepted.astype(float), 0.5, time_limit_s=0.0)
    assert covers(accepted, cover.chosen)
    assert cover.lower_bound <= len(proven.chosen) <= len(cover.chosen)
