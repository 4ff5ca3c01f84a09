"""What a stream of viewpoints leaves, against comparing all pairs and against trying every subset."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_strategies import acceptances, streamed_levels

from viewgauge.planning import Undominated, probability_levels
from viewgauge.planning.cover.dominance import maximal_rows


def streamed(index, level, certain, chunks=1, order=None):
    """All rows in the given order, in so many chunks."""
    kept = Undominated(level.shape[1])
    order = np.arange(len(index)) if order is None else np.asarray(order, dtype=int)
    for part in np.array_split(order, chunks):
        kept.add(index[part], level[part], certain[part])
    return kept


def same(a, b) -> bool:
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in ("index", "level", "certain"))


def maximal(index, level, certain) -> list[int]:
    """Indices by the definition, pair by pair."""

    def dominated(i, j):
        return all(level[i][d] <= (level[j][d] if certain[j][d] else 0) for d in range(level.shape[1]))

    rows = range(len(index))
    return sorted(
        int(index[i])
        for i in rows
        if any(level[i])
        and not any(dominated(i, j) and (not dominated(j, i) or index[j] < index[i]) for j in rows if j != i)
    )


def least_and_most_probable(level):
    """Least number of rows that hold every column, and the best weakest level of so many; None without a cover."""
    for size in range(len(level) + 1):
        weakest = [
            min((max((level[k][d] for k in chosen), default=0) for d in range(level.shape[1])), default=1)
            for chosen in combinations(range(len(level)), size)
        ]
        if max(weakest, default=0) > 0:
            return size, max(weakest)
    return None


@settings(max_examples=500, deadline=None)
@given(case=streamed_levels())
def test_keeps_the_maximal_rows_and_no_others(case):
    index, level, certain = case
    kept = streamed(*case)
    assert kept.index.tolist() == maximal(*case)
    assert len(kept) == len(kept.index)
    order = {k: row for row, k in enumerate(index)}
    rows = [order[k] for k in kept.index]
    assert np.array_equal(kept.level, level[rows])
    assert np.array_equal(kept.certain, certain[rows])
    assert (kept.level.dtype, kept.certain.dtype, kept.index.dtype) == (np.uint16, np.bool_, np.int64)


@settings(max_examples=400, deadline=None)
@given(case=streamed_levels(), data=st.data())
def test_neither_order_nor_chunks_nor_merging_matter(case, data):
    index, level, _ = case
    whole = streamed(*case)
    order = data.draw(st.permutations(range(len(index))))
    assert same(streamed(*case, chunks=data.draw(st.integers(1, 5)), order=order), whole)
    machine = np.array([data.draw(st.integers(0, 2)) for _ in index], dtype=int)
    parts = [streamed(*(values[machine == m] for values in case), chunks=2) for m in range(3)]
    merged = Undominated(level.shape[1])
    for m in data.draw(st.permutations(range(3))):
        merged.merge(parts[m])
    assert same(merged, whole)


@settings(max_examples=300, deadline=None)
@given(case=streamed_levels(), data=st.data())
def test_a_row_reported_twice_counts_once(case, data):
    kept = streamed(*case, chunks=2)
    again = data.draw(st.lists(st.integers(0, max(0, len(case[0]) - 1)), max_size=6 if len(case[0]) else 0))
    before = kept.index
    kept.add(*(values[again] for values in case))
    kept.merge(streamed(*case, chunks=3))
    assert np.array_equal(kept.index, before)


@settings(max_examples=300, deadline=None)
@given(case=streamed_levels(most_rows=7, most_columns=4), data=st.data())
def test_the_cover_loses_nothing_even_if_doubtful_levels_turn_out_lower(case, data):
    index, level, certain = case
    kept = np.isin(index, streamed(*case, chunks=2).index)
    assert least_and_most_probable(level[kept]) == least_and_most_probable(level)
    lowered = level.copy()
    for i, d in zip(*np.nonzero(~certain & (level > 0)), strict=True):
        lowered[i, d] = data.draw(st.integers(0, int(level[i, d])))
    assert least_and_most_probable(lowered[kept]) == least_and_most_probable(lowered)


@settings(max_examples=300, deadline=None)
@given(accepted=acceptances())
def test_maximal_sets_equal_those_found_pair_by_pair(accepted):
    sets = [frozenset(np.nonzero(row)[0]) for row in accepted]
    expected = [k for k, a in enumerate(sets) if not any(a < b for b in sets) and a not in sets[:k]]
    assert maximal_rows(accepted).tolist() == expected


def test_no_rows_no_characteristics_and_rows_of_zeros():
    for characteristics in (0, 1, 64, 65):
        kept = streamed(np.arange(4), np.zeros((4, characteristics), np.uint16), np.ones((4, characteristics), bool))
        assert len(kept) == 0
        assert kept.level.shape == kept.certain.shape == (0, characteristics)
        kept.merge(Undominated(characteristics))
        assert len(kept) == 0


@pytest.mark.parametrize("characteristics", [1, 63, 64, 65, 128, 200])
def test_of_equal_rows_the_lowest_index_stays_unless_they_are_in_doubt(characteristics):
    index = np.array([9, 4, 6, 5])
    level = np.full((4, characteristics), 9876, np.uint16)
    certain = np.ones((4, characteristics), bool)
    assert streamed(index, level, certain, chunks=3).index.tolist() == [4]
    certain[:, -1] = False
    assert streamed(index, level, certain, chunks=3).index.tolist() == [4, 5, 6, 9]
    certain[0] = True
    assert streamed(index, level, certain, chunks=3).index.tolist() == [9]


@pytest.mark.parametrize("characteristics", [5, 70])
def test_many_rows_over_many_blocks_equal_the_comparison_of_all_pairs(characteristics):
    rng = np.random.default_rng(11)
    level = rng.integers(0, 4, (1500, characteristics)).astype(np.uint16) * (rng.random((1500, characteristics)) < 0.9)
    level[700:] = np.minimum(level[700:], level[rng.integers(0, 700, 800)])
    certain = rng.random((1500, characteristics)) < 0.98
    index = rng.permutation(1500)
    bound = level * certain
    below = (level[:, None] <= bound[None]).all(axis=2)
    np.fill_diagonal(below, False)
    needless = below & (~below.T | (index[None] < index[:, None]))
    expected = np.sort(index[level.any(axis=1) & ~needless.any(axis=1)])
    assert 10 < len(expected) < 1490
    for chunks in (1, 7):
        assert np.array_equal(streamed(index, level.astype(np.uint16), certain, chunks).index, expected)


def test_an_index_with_two_different_rows_is_refused():
    kept = Undominated(2)
    kept.add(np.array([5]), np.array([[1, 2]], np.uint16), np.ones((1, 2), bool))
    with pytest.raises(ValueError, match="index 5 came with two different rows"):
        kept.add(np.array([5]), np.array([[2, 1]], np.uint16), np.ones((1, 2), bool))
    assert kept.level.tolist() == [[1, 2]], "what was kept is as before"


def test_wrong_shapes_and_types_are_refused():
    kept = Undominated(3)
    level, certain = np.ones((2, 3), np.uint16), np.ones((2, 3), bool)
    with pytest.raises(ValueError, match="shape"):
        kept.add(np.arange(3), level, certain)
    with pytest.raises(ValueError, match="shape"):
        kept.add(np.arange(2), level, certain[:, :2])
    with pytest.raises(ValueError, match="expected uint16 and bool"):
        kept.add(np.arange(2), level.astype(float), certain)
    with pytest.raises(ValueError, match="cannot be merged"):
        kept.merge(Undominated(4))


# --- levels ----------------------------------------------------------------------------------------------------------


@settings(max_examples=500, deadline=None)
@given(
    probability=st.lists(st.floats(0, 1) | st.integers(0, 10000).map(lambda k: k / 10000), min_size=1, max_size=6),
    required=st.floats(0, 1, exclude_min=True),
)
def test_levels_rise_with_the_probability_and_are_zero_only_below_what_is_required(probability, required):
    p = np.sort(np.array([*probability, required, np.nextafter(required, 0), np.nextafter(required, 1)]))
    p = np.clip(p, 0, 1)
    level = probability_levels(p, required)
    assert level.dtype == np.uint16
    assert (np.diff(level.astype(int)) >= 0).all()
    assert np.array_equal(level > 0, p >= required)
    assert (np.abs(level - p * 1e4)[(level > 1)] <= 1).all()


@given(
    probability=st.lists(st.floats(0, 1), min_size=1, max_size=6),
    required=st.floats(0, 1, exclude_min=True),
    candidates=st.sampled_from([100_001, 1_000_000, 1_000_001, 10**12]),
)
def test_of_very_many_candidates_the_levels_are_coarser_and_the_least_number_is_the_same(
    probability, required, candidates
):
    p = np.clip(np.sort(np.array([*probability, required, np.nextafter(required, 0)])), 0, 1)
    level = probability_levels(p, required, candidates)
    assert (np.diff(level.astype(int)) >= 0).all()
    assert np.array_equal(level > 0, p >= required)
    step = max(1e-4, (1 - required) / (50 if candidates <= 1_000_000 else 10))
    sure = p[level > 1]
    assert (np.abs(level[level > 1] - sure / step) <= 1 + 1e-6).all()
    assert len(np.unique(level)) <= 2 + (1 - required) / step + 1


def test_levels_at_the_ends():
    assert probability_levels(np.array([[0.0, 1e-9, 0.95, 1.0, np.nan]]), 1e-9).tolist() == [[0, 1, 9500, 10000, 0]]
