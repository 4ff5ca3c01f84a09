"""The least set of viewpoints, against trying every subset."""

from __future__ import annotations

import time
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_strategies import acceptances, level_tables

from viewgauge.planning import minimum_cover, most_probable_minimum_cover
from viewgauge.planning.cover import minimum_cover as cover_module


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
@given(level=level_tables())
def test_the_most_probable_of_the_least_equals_brute_force(level):
    cover = most_probable_minimum_cover(level)
    least = every_least_cover(level > 0)
    assert len(cover.chosen) == len(least[0])
    assert covers(level > 0, cover.chosen)
    assert cover.proven
    if level.shape[1]:
        most_probable = max(min(max(level[k, j] for k in c) for j in range(level.shape[1])) for c in least)
        assert min(max(level[k, j] for k in cover.chosen) for j in range(level.shape[1])) == most_probable


@settings(max_examples=200, deadline=None)
@given(accepted=acceptances())
def test_the_reductions_keep_the_least_number(accepted):
    needed, rows, columns = cover_module._reduced(accepted)
    assert set(needed).isdisjoint(rows.tolist())
    left = accepted[np.ix_(rows, columns)]
    assert (left.sum(axis=0) > 1).all(), "of one holder the column is gone with it"
    assert len(needed) + len(every_least_cover(left)[0]) == len(every_least_cover(accepted)[0])
    parts = cover_module._components(left)
    assert sorted(j for _, c in parts for j in c) == list(range(len(columns)))
    assert len({k for r, _ in parts for k in r}) == sum(len(r) for r, _ in parts)


@settings(max_examples=200, deadline=None)
@given(accepted=acceptances(), data=st.data())
def test_no_prices_bound_too_high_and_what_they_exclude_is_in_no_least_cover(accepted, data):
    least = every_least_cover(accepted)
    if not least[0]:
        return
    some = st.lists(st.integers(1, 9), min_size=accepted.shape[1], max_size=accepted.shape[1])
    some = np.array(data.draw(some))
    for prices in (some, cover_module._best_prices(accepted, some)):
        assert cover_module._price_bound(accepted, prices) <= len(least[0])
        affordable = cover_module._affordable(accepted, prices, len(least[0]))
        assert all(affordable[list(chosen)].all() for chosen in least)


@pytest.mark.parametrize("closing", ["search", "HiGHS"])
@pytest.mark.parametrize("columns", [9, 70])
def test_both_ways_to_close_the_gap_equal_brute_force(closing, columns):
    """Instances in which the greedy cover is often too large, with more columns than one word of the bit set too."""
    rng = np.random.default_rng(columns)
    for _ in range(60):
        accepted = rng.random((12, columns)) < rng.choice([0.3, 0.6])
        accepted[rng.integers(0, 12, columns), np.arange(columns)] = True
        least = len(every_least_cover(accepted)[0])
        for most in range(1, least + 2):
            if closing == "search":
                found, decided = cover_module._searched(accepted, most)
                assert decided
            else:
                found, bound = cover_module._solved(accepted, most, time.monotonic() + 60)
                assert bound > most if found is None else bound == len(found)
            if most < least:
                assert found is None
            else:
                assert covers(accepted, found)
                assert len(found) <= most


def test_independent_parts_are_solved_apart():
    rng = np.random.default_rng(8)
    parts = [rng.random((10, 7)) < 0.4 for _ in range(4)]
    for part in parts:
        part[np.arange(7), np.arange(7)] = True
    whole = np.zeros((40, 28), dtype=bool)
    for k, part in enumerate(parts):
        whole[10 * k : 10 * k + 10, 7 * k : 7 * k + 7] = part
    cover = minimum_cover(whole[rng.permutation(40)][:, rng.permutation(28)])
    assert len(cover.chosen) == cover.lower_bound == sum(len(every_least_cover(part)[0]) for part in parts)


def test_no_characteristic_needs_no_viewpoint():
    assert minimum_cover(np.zeros((4, 0), dtype=bool)).chosen == ()
    assert most_probable_minimum_cover(np.zeros((4, 0), np.uint16)).proven
    assert most_probable_minimum_cover(np.zeros((0, 0), np.uint16)).chosen == ()


def test_a_characteristic_that_nothing_accepts_is_refused():
    with pytest.raises(ValueError, match="accepted from no viewpoint"):
        minimum_cover(np.array([[True, False], [True, False]]))
    with pytest.raises(ValueError, match="accepted from no viewpoint"):
        minimum_cover(np.zeros((0, 1), dtype=bool))


def test_greedy_is_not_enough():
    """Where always taking the best row needs three rows, two do."""
    accepted = np.array([[1, 1, 1, 1, 0, 0], [1, 0, 1, 0, 1, 0], [0, 1, 0, 1, 0, 1]], dtype=bool)
    assert minimum_cover(accepted).chosen == (1, 2)


def test_the_cover_depends_on_the_set_of_rows_alone():
    """The same rows in any order give the same rows, and of equal ones the first."""
    rng = np.random.default_rng(3)
    level = rng.integers(0, 3000, (150, 12)) * (rng.random((150, 12)) < 0.4)
    level = np.vstack([level, level[:75]]).astype(np.uint16)
    for find in (most_probable_minimum_cover, lambda table: minimum_cover(table > 1500)):
        first = find(level)
        assert find(level) == first
        assert max(first.chosen) < 150
        for _ in range(4):
            order = rng.permutation(225)
            again = find(level[order])
            assert again.lower_bound == first.lower_bound
            chosen = level[order][list(again.chosen)]
            if find is most_probable_minimum_cover:
                assert {tuple(row) for row in chosen} == {tuple(row) for row in level[list(first.chosen)]}
            for k in again.chosen:
                equal = (level[order] == level[order][k]).all(axis=1)
                assert find is not most_probable_minimum_cover or k == np.nonzero(equal)[0][0]


def test_of_many_rows_the_two_that_are_whole_are_found():
    """Among thousands of rows, each of them twice."""
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
    """One whose greedy cover has 8 rows and whose price bound is 6; the least number is 7."""
    rng = np.random.default_rng(10)
    accepted = rng.random((60, 40)) < 0.15
    accepted[np.arange(40) % 60, np.arange(40)] = True
    return accepted


@pytest.fixture
def cut_off(monkeypatch):
    """Has HiGHS end out of time with the outcome given as a function of the true one; the search does nothing."""

    def arrange(outcome):
        now, true = [0.0], scipy.optimize.milp

        def milp(*args, **options):
            now[0] = np.inf
            return SimpleNamespace(status=1, **outcome(true(*args, **{**options, "options": {}})))

        monkeypatch.setattr(cover_module, "_SEARCH_STEPS", 0)
        monkeypatch.setattr(cover_module, "time", SimpleNamespace(monotonic=lambda: now[0]))
        monkeypatch.setattr(scipy.optimize, "milp", milp)

    return arrange


@pytest.mark.parametrize(
    ("bound", "known", "rows", "lower_bound"),
    [(None, False, 8, 6), (4.2, False, 8, 6), (6.2, False, 8, 7), (None, True, 7, 6), (6.2, True, 7, 7)],
)
def test_time_up_gives_the_best_cover_and_bound_so_far(cut_off, bound, known, rows, lower_bound):
    cut_off(lambda true: {"x": true.x if known else None, "mip_dual_bound": bound})
    accepted = random_instance()
    cover = minimum_cover(accepted)
    assert covers(accepted, cover.chosen)
    assert (len(cover.chosen), cover.lower_bound) == (rows, lower_bound)
    assert cover.proven == (rows == lower_bound)


def test_a_search_without_time_still_gives_a_cover_with_an_honest_bound():
    accepted = random_instance()
    proven = minimum_cover(accepted)
    assert proven.proven
    cover = most_probable_minimum_cover(accepted.astype(np.uint16), time_limit_s=0.0)
    assert covers(accepted, cover.chosen)
    assert cover.lower_bound <= len(proven.chosen) <= len(cover.chosen)
