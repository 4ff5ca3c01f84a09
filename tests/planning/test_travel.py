"""Tours against all permutations, and covers that keep what they measure while the tour gets shorter."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from planning_strategies import level_tables

from viewgauge.planning import minimum_cover
from viewgauge.planning.cover.travel import least_travel, shortest_tour, tour_length_mm

COORDINATES = st.sampled_from([0.0, 1.0, 1.0 + 1e-9, 300.0]) | st.floats(-500, 500)


def positions(most):
    return st.integers(0, most).flatmap(lambda n: hnp.arrays(float, (n, 3), elements=COORDINATES))


@given(positions(6))
def test_no_order_is_shorter(places):
    order, proven = shortest_tour(places)
    assert proven
    assert sorted(order) == list(range(len(places)))
    lengths = [tour_length_mm(places, p) for p in itertools.permutations(range(len(places)))]
    assert tour_length_mm(places, order) <= min(lengths) + 1e-6


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.integers(13, 20))
def test_many_viewpoints_on_a_circle_are_visited_around_it(seed, n):
    """On a convex curve the shortest tour is the curve's own order; beyond 12 it is said not to be proven."""
    angle = np.sort(np.random.default_rng(seed).uniform(0, 2 * np.pi, n))
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1) * 400
    mixed = np.random.default_rng(seed).permutation(n)
    order, proven = shortest_tour(circle[mixed])
    assert not proven
    # 2-opt takes out all crossings, and on a convex curve only the shortest tour has none
    assert tour_length_mm(circle[mixed], order) == pytest.approx(tour_length_mm(circle, tuple(range(n))), rel=1e-9)


@given(level_tables(), st.integers(0, 2**32 - 1))
def test_a_shorter_tour_measures_as_much_and_as_surely(level, seed):
    """By brute force over all covers of that size: what is exchanged never is worse, nor the tour longer."""
    places = np.random.default_rng(seed).uniform(-300, 300, (len(level), 3))
    chosen = minimum_cover(level > 0).chosen
    again = least_travel(level, places, chosen)
    assert len(again) == len(chosen)
    if level.shape[1]:
        assert level[list(again)].max(axis=0).min() >= level[list(chosen)].max(axis=0).min()
    before, after = (tour_length_mm(places[list(c)], shortest_tour(places[list(c)])[0]) for c in (chosen, again))
    assert after <= before + 1e-9


def test_of_two_equal_viewpoints_the_nearer_is_taken():
    level = np.array([[9000, 0], [0, 9000], [0, 9500], [0, 8000]], dtype=np.uint16)
    places = np.array([[0.0, 0, 0], [900.0, 0, 0], [100.0, 0, 0], [10.0, 0, 0]])
    assert least_travel(level, places, (0, 1)) == (0, 2), "nearer, and as sure; the nearest is not sure enough"
