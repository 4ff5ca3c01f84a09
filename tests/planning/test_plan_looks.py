"""Which looks are averaged: against brute force over small pools, and what is promised of any choice."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from viewgauge.evaluation import Looks
from viewgauge.planning.averaging.acquisition_search import LEAST_SEPARATION_STEPS, LookCandidates
from viewgauge.planning.averaging.averaged_viewpoints import plan_looks
from viewgauge.planning.averaging.shortlist import LookShortlist, look_scores

SPREAD = np.diag([0.01, 0.01, 0.04, 1e-6, 1e-6, 1e-6])


def pool(gradients, widths, common_share, allowed=1.0, settings_=None, image=None, step=1.0):
    """Candidates with given gradients (n, 6) and half-widths (n, 2); images far from each other unless given."""
    n = len(gradients)
    gradients = np.asarray(gradients, dtype=float)
    looks = Looks(gradients, np.asarray(widths, dtype=float), SPREAD * common_share, SPREAD * (1 - common_share))
    far = np.broadcast_to(np.arange(n)[:, None, None] * 100.0, (n, 2, 2))
    return LookCandidates(
        np.arange(n) if settings_ is None else np.asarray(settings_),
        np.arange(n) + 1000,
        looks,
        far if image is None else np.asarray(image, dtype=float),
        step,
        allowed,
        np.ones(n, dtype=bool),
    )


def random_pool(seed, n, share, allowed):
    rng = np.random.default_rng(seed)
    gradients = rng.standard_normal((n, 6)) * [3, 3, 2, 300, 300, 300]
    return pool(gradients, rng.uniform(0, 0.3, (n, 2)), share, allowed)


def surest_by_force(candidates, k):
    sets = np.array(list(itertools.combinations(range(len(candidates.setting)), k)))
    probability = candidates.looks.mean_of(sets).central_probability(candidates.allowed_error_mm)
    return float(probability.max())


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("seed", range(6))
def test_as_few_looks_as_brute_force_over_all_sets(seed, share):
    candidates = random_pool(seed, 9, share, 0.5)
    required = 0.97
    least = next((k for k in range(2, 6) if surest_by_force(candidates, k) >= required), None)
    found = plan_looks([candidates], [], 5, required)
    assert len(found) == (least is not None)
    for looked in found:
        assert len(looked.settings) == least
        assert looked.probability >= required
        # no more than it should be, and not far below the best set of as many (settings the plan needs came first)
        assert looked.probability <= surest_by_force(candidates, least) + 1e-12


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("k", [2, 3, 4])
def test_the_search_finds_the_surest_set_or_one_nearly_as_sure(share, k):
    for seed in range(8):
        candidates = random_pool(100 + seed, 9, share, 0.4)
        best = surest_by_force(candidates, k)
        (looked,) = plan_looks([candidates], [], k, best * 0.98, fewest={0: k})
        assert looked.probability >= best * 0.98


def test_what_is_told_of_a_mean_is_so():
    candidates = random_pool(3, 12, 0.3, 0.6)
    (looked,) = plan_looks([candidates], [], 6, 0.95)
    index = list(looked.settings)
    law = candidates.looks.mean_of(index)
    assert looked.settings == tuple(sorted(looked.settings))
    assert looked.gauges == tuple(i + 1000 for i in index)
    assert looked.probability == float(law.central_probability(0.6))
    assert looked.deviation_mm == float(law.std())
    single = [float(candidates.looks.mean_of([i]).central_probability(0.6)) for i in range(12)]
    assert looked.probability_single == pytest.approx(max(single), abs=1e-12)


def test_identical_looks_gain_nothing_where_all_is_common():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (6, 1))
    assert plan_looks([pool(same, np.zeros((6, 2)), 1.0, 0.3)], [], 6, 0.9) == ()
    (looked,) = plan_looks([pool(same, np.zeros((6, 2)), 0.0, 0.3)], [], 6, 0.9)
    assert len(looked.settings) == 2  # sigma 0.2 / sqrt(2): Pr{|e| <= 0.3} = 0.966; a single one 0.866


def test_opposed_looks_are_found_where_all_is_common():
    gradients = [[2.0, 0, 0, 0, 0, 0]] * 5 + [[-2.1, 0, 0, 0, 0, 0]]
    (looked,) = plan_looks([pool(gradients, np.zeros((6, 2)), 1.0, 0.2)], [], 4, 0.999)
    assert len(looked.settings) == 2
    assert 5 in looked.settings


def test_the_setting_of_two_dimensions_is_taken_once():
    # four equal looks at each: whichever pair the first takes serves the second
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (4, 1))
    first = pool(same, np.zeros((4, 2)), 0.0, 0.3, settings_=[1, 2, 3, 4])
    second = pool(same, np.zeros((4, 2)), 0.0, 0.3, settings_=[3, 4, 5, 6])
    found = plan_looks([first, second], [], 2, 0.9)
    assert len({k for looked in found for k in looked.settings}) == 2


def test_planned_settings_are_preferred_though_less_sure():
    gradients = np.tile([[2.0, 0, 0, 0, 0, 0]], (6, 1))
    gradients[:2] *= 1.05
    (looked,) = plan_looks([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1], 2, 0.9)
    assert looked.settings == (0, 1)
    # where one planned look does and two do not, one
    gradients[1] *= 2
    (looked,) = plan_looks([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1], 2, 0.95)
    assert looked.settings[0] == 0
    assert 1 not in looked.settings


def test_fewer_looks_come_before_fewer_settings():
    gradients = np.tile([[4.0, 0, 0, 0, 0, 0]], (6, 1))
    gradients[4:] = [2.0, 0, 0, 0, 0, 0]
    (looked,) = plan_looks([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1, 2, 3], 4, 0.9)
    assert looked.settings == (4, 5)


@pytest.mark.parametrize("step", [1.0, 0.1])
def test_looks_whose_images_coincide_are_not_averaged(step):
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (3, 1))
    far = LEAST_SEPARATION_STEPS * step
    image = np.zeros((3, 2, 2))
    image[1] = [[0, 0.9 * far], [0, 50]]  # one end does not move enough
    image[2] = [[0, 50], [1.1 * far, 0]]
    found = plan_looks([pool(same, np.full((3, 2), 0.01), 0.0, 0.3, image=image, step=step)], [], 2, 0.9)
    assert [looked.settings for looked in found] in ([(0, 2)], [(1, 2)])
    assert plan_looks([pool(same[:2], np.zeros((2, 2)), 0.0, 0.3, image=image[:2], step=step)], [], 2, 0.9) == ()


def test_a_perfect_locator_needs_no_distance_but_another_setting():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (2, 1))
    image = np.zeros((2, 2, 2))
    assert plan_looks([pool(same, np.zeros((2, 2)), 0.0, 0.3, image=image, step=0.0)], [], 2, 0.9)
    assert plan_looks([pool(same[:1], np.zeros((1, 2)), 0.0, 0.3, step=0.0)], [], 2, 0.9) == ()


def test_what_no_mean_meets_is_left_out():
    hopeless = random_pool(1, 8, 1.0, 1e-6)
    none = pool(np.zeros((0, 6)), np.zeros((0, 2)), 0.0)
    easy = random_pool(2, 8, 0.2, 0.6)
    assert [looked.dimension for looked in plan_looks([hopeless, none, easy], [], 6, 0.9)] == [2]


def test_sixteen_looks_are_found_where_sixteen_are_needed():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (40, 1))
    # sigma 0.2 / 4 = 0.05: 0.1 is two of them, 0.954
    (looked,) = plan_looks([pool(same, np.full((40, 2), 0.001), 0.0, 0.1)], [], 16, 0.952)
    assert len(looked.settings) == 16


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 150), st.integers(0, 150))
def test_a_shortlist_does_not_depend_on_the_chunks(seed, n, cut):
    rng = np.random.default_rng(seed)
    setting, dimension = np.repeat(np.arange(n), 2), np.tile([0, 1], n)
    score = rng.integers(0, 4, (2 * n, 3)).astype(float)  # many ties
    whole = LookShortlist.of(setting, dimension, score)
    first = setting < cut
    parts = [LookShortlist.of(setting[part], dimension[part], score[part]) for part in (first, ~first)]
    for merged in (parts[0].merged(parts[1]), parts[1].merged(parts[0])):
        for name, array in whole.arrays().items():
            np.testing.assert_array_equal(array, merged.arrays()[name])
    again = LookShortlist.of(**whole.arrays())
    np.testing.assert_array_equal(again.setting, whole.setting)


def test_a_shortlist_keeps_the_best_and_what_offsets_it():
    rng = np.random.default_rng(4)
    gradients = np.abs(rng.standard_normal((500, 6))) * [3, 0, 0, 0, 0, 0] + [1, 0, 0, 0, 0, 0]
    gradients[123] *= -3  # one look among 500 errs the other way
    candidates = pool(gradients, np.full((500, 2), 1e-3), 0.9)
    shortlist = LookShortlist.of(np.arange(500), np.zeros(500, int), look_scores(candidates.looks))
    assert len(shortlist.setting) < 330
    assert 123 in shortlist.setting
    assert np.argmin(candidates.looks.mean_of(np.arange(500)[:, None]).var()) in shortlist.setting


def rounding_errors(displacement, draws=200_000):
    """Of one coordinate in two looks, by rounding to whole steps: the image moves by a displacement in between."""
    place = np.random.default_rng(8).uniform(0, 1, draws)
    return place - np.round(place), place + displacement - np.round(place + displacement)


def test_half_a_step_of_repeatability_makes_rounding_errors_independent():
    # what LEAST_SEPARATION_STEPS rests on: the correlation is at most 6/pi² exp(-2 pi² s²), 0.44 % at s = 0.5;
    # 4.4 / sqrt(n): false alarm 1e-5
    moved = LEAST_SEPARATION_STEPS + 0.5 * np.random.default_rng(9).standard_normal(200_000)
    first, second = rounding_errors(moved)
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.0044 + 4.4 / np.sqrt(200_000)
    # and without any, two looks may round alike however far they are from each other: the page says so
    first, second = rounding_errors(7.0)
    assert np.corrcoef(first, second)[0, 1] == pytest.approx(1)


@pytest.mark.parametrize("seed", range(5))
def test_many_dimensions_share_settings(seed):
    # ten dimensions that any two looks meet: brute force over the settings would take two, apart as all are here
    rng = np.random.default_rng(seed)
    pools = [
        pool(np.outer(rng.uniform(1.5, 2.0, 40), [1, 0, 0, 0, 0, 0]), np.zeros((40, 2)), 0.0, 0.3) for _ in range(10)
    ]
    found = plan_looks(pools, [], 2, 0.9)
    assert len(found) == 10
    assert len({k for looked in found for k in looked.settings}) == 2


def test_looks_that_are_good_for_another_dimension_only_serve_where_they_are_taken():
    first = pool(np.outer([2.0, 2, 9, 9], [1, 0, 0, 0, 0, 0]), np.zeros((4, 2)), 0.0, 0.3)
    second = pool(np.outer([2.0, 2, 1.9, 1.9], [1, 0, 0, 0, 0, 0]), np.zeros((4, 2)), 0.0, 0.3)
    second = replace(second, good=np.array([False, False, True, True]))
    one, other = plan_looks([first, second], [], 2, 0.9)
    assert one.settings == other.settings == (0, 1)
    (alone,) = plan_looks([second], [], 2, 0.9)
    assert alone.settings == (2, 3)
