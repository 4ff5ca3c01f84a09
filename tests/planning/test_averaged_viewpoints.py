"""Which acquisitions are averaged: against brute force over small pools, and what is promised of any choice."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from viewgauge.evaluation import Acquisitions
from viewgauge.planning.averaging.acquisition_search import LEAST_SEPARATION_STEPS, AcquisitionCandidates
from viewgauge.planning.averaging.averaged_viewpoints import plan_acquisitions
from viewgauge.planning.averaging.shortlist import AcquisitionShortlist, acquisition_scores

SPREAD = np.diag([0.01, 0.01, 0.04, 1e-6, 1e-6, 1e-6])


def pool(gradients, widths, common_share, allowed=1.0, viewpoints_=None, image=None, step=1.0):
    """Candidates with given gradients (n, 6) and half-widths (n, 2); images far from each other unless given."""
    n = len(gradients)
    gradients = np.asarray(gradients, dtype=float)
    acquisitions = Acquisitions(
        gradients, np.asarray(widths, dtype=float), SPREAD * common_share, SPREAD * (1 - common_share)
    )
    far = np.broadcast_to(np.arange(n)[:, None, None] * 100.0, (n, 2, 2))
    return AcquisitionCandidates(
        np.arange(n) if viewpoints_ is None else np.asarray(viewpoints_),
        np.arange(n) + 1000,
        acquisitions,
        far if image is None else np.asarray(image, dtype=float),
        step,
        allowed,
        np.ones(n, dtype=bool),
    )


def random_pool(seed, n, share, allowed):
    rng = np.random.default_rng(seed)
    gradients = rng.standard_normal((n, 6)) * [3, 3, 2, 300, 300, 300]
    return pool(gradients, rng.uniform(0, 0.3, (n, 2)), share, allowed)


def most_probable_by_force(candidates, k):
    sets = np.array(list(itertools.combinations(range(len(candidates.viewpoint)), k)))
    probability = candidates.acquisitions.mean_of(sets).central_probability(candidates.allowed_error_mm)
    return float(probability.max())


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("seed", range(6))
def test_as_few_acquisitions_as_brute_force_over_all_sets(seed, share):
    candidates = random_pool(seed, 9, share, 0.5)
    required = 0.97
    least = next((k for k in range(2, 6) if most_probable_by_force(candidates, k) >= required), None)
    found = plan_acquisitions([candidates], [], 5, required)
    assert len(found) == (least is not None)
    for looked in found:
        assert len(looked.viewpoints) == least
        assert looked.probability >= required
        # no more than it should be, and not far below the best set of as many (viewpoints the plan needs came first)
        assert looked.probability <= most_probable_by_force(candidates, least) + 1e-12


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("k", [2, 3, 4])
def test_the_search_finds_the_most_probable_set_or_one_nearly_as_sure(share, k):
    for seed in range(8):
        candidates = random_pool(100 + seed, 9, share, 0.4)
        best = most_probable_by_force(candidates, k)
        (looked,) = plan_acquisitions([candidates], [], k, best * 0.98, fewest={0: k})
        assert looked.probability >= best * 0.98


def test_what_is_reported_of_a_mean_is_so():
    candidates = random_pool(3, 12, 0.3, 0.6)
    (looked,) = plan_acquisitions([candidates], [], 6, 0.95)
    index = list(looked.viewpoints)
    law = candidates.acquisitions.mean_of(index)
    assert looked.viewpoints == tuple(sorted(looked.viewpoints))
    assert looked.measurands == tuple(i + 1000 for i in index)
    assert looked.probability == float(law.central_probability(0.6))
    assert looked.deviation_mm == float(law.std())
    single = [float(candidates.acquisitions.mean_of([i]).central_probability(0.6)) for i in range(12)]
    assert looked.probability_single == pytest.approx(max(single), abs=1e-12)


def test_identical_acquisitions_gain_nothing_where_all_is_common():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (6, 1))
    assert plan_acquisitions([pool(same, np.zeros((6, 2)), 1.0, 0.3)], [], 6, 0.9) == ()
    (looked,) = plan_acquisitions([pool(same, np.zeros((6, 2)), 0.0, 0.3)], [], 6, 0.9)
    assert len(looked.viewpoints) == 2  # sigma 0.2 / sqrt(2): Pr{|e| <= 0.3} = 0.966; a single one 0.866


def test_opposed_acquisitions_are_found_where_all_is_common():
    gradients = [[2.0, 0, 0, 0, 0, 0]] * 5 + [[-2.1, 0, 0, 0, 0, 0]]
    (looked,) = plan_acquisitions([pool(gradients, np.zeros((6, 2)), 1.0, 0.2)], [], 4, 0.999)
    assert len(looked.viewpoints) == 2
    assert 5 in looked.viewpoints


def test_the_viewpoint_of_two_characteristics_is_taken_once():
    # four equal looks at each: whichever pair the first takes serves the second
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (4, 1))
    first = pool(same, np.zeros((4, 2)), 0.0, 0.3, viewpoints_=[1, 2, 3, 4])
    second = pool(same, np.zeros((4, 2)), 0.0, 0.3, viewpoints_=[3, 4, 5, 6])
    found = plan_acquisitions([first, second], [], 2, 0.9)
    assert len({k for looked in found for k in looked.viewpoints}) == 2


def test_planned_viewpoints_are_preferred_though_less_sure():
    gradients = np.tile([[2.0, 0, 0, 0, 0, 0]], (6, 1))
    gradients[:2] *= 1.05
    (looked,) = plan_acquisitions([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1], 2, 0.9)
    assert looked.viewpoints == (0, 1)
    # where one planned look does and two do not, one
    gradients[1] *= 2
    (looked,) = plan_acquisitions([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1], 2, 0.95)
    assert looked.viewpoints[0] == 0
    assert 1 not in looked.viewpoints


def test_fewer_acquisitions_come_before_fewer_viewpoints():
    gradients = np.tile([[4.0, 0, 0, 0, 0, 0]], (6, 1))
    gradients[4:] = [2.0, 0, 0, 0, 0, 0]
    (looked,) = plan_acquisitions([pool(gradients, np.zeros((6, 2)), 0.0, 0.3)], [0, 1, 2, 3], 4, 0.9)
    assert looked.viewpoints == (4, 5)


@pytest.mark.parametrize("step", [1.0, 0.1])
def test_acquisitions_whose_images_coincide_are_not_averaged(step):
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (3, 1))
    far = LEAST_SEPARATION_STEPS * step
    image = np.zeros((3, 2, 2))
    image[1] = [[0, 0.9 * far], [0, 50]]  # one end does not move enough
    image[2] = [[0, 50], [1.1 * far, 0]]
    found = plan_acquisitions([pool(same, np.full((3, 2), 0.01), 0.0, 0.3, image=image, step=step)], [], 2, 0.9)
    assert [looked.viewpoints for looked in found] in ([(0, 2)], [(1, 2)])
    assert plan_acquisitions([pool(same[:2], np.zeros((2, 2)), 0.0, 0.3, image=image[:2], step=step)], [], 2, 0.9) == ()


def test_a_perfect_edge_detector_needs_no_distance_but_another_viewpoint():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (2, 1))
    image = np.zeros((2, 2, 2))
    assert plan_acquisitions([pool(same, np.zeros((2, 2)), 0.0, 0.3, image=image, step=0.0)], [], 2, 0.9)
    assert plan_acquisitions([pool(same[:1], np.zeros((1, 2)), 0.0, 0.3, step=0.0)], [], 2, 0.9) == ()


def test_what_no_mean_meets_is_left_out():
    hopeless = random_pool(1, 8, 1.0, 1e-6)
    none = pool(np.zeros((0, 6)), np.zeros((0, 2)), 0.0)
    easy = random_pool(2, 8, 0.2, 0.6)
    assert [looked.characteristic for looked in plan_acquisitions([hopeless, none, easy], [], 6, 0.9)] == [2]


def test_sixteen_acquisitions_are_found_where_sixteen_are_needed():
    same = np.tile([[2.0, 0, 0, 0, 0, 0]], (40, 1))
    # sigma 0.2 / 4 = 0.05: 0.1 is two of them, 0.954
    (looked,) = plan_acquisitions([pool(same, np.full((40, 2), 0.001), 0.0, 0.1)], [], 16, 0.952)
    assert len(looked.viewpoints) == 16


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 150), st.integers(0, 150))
def test_a_shortlist_does_not_depend_on_the_chunks(seed, n, cut):
    rng = np.random.default_rng(seed)
    viewpoint, characteristic = np.repeat(np.arange(n), 2), np.tile([0, 1], n)
    score = rng.integers(0, 4, (2 * n, 3)).astype(float)  # many ties
    whole = AcquisitionShortlist.of(viewpoint, characteristic, score)
    first = viewpoint < cut
    parts = [AcquisitionShortlist.of(viewpoint[part], characteristic[part], score[part]) for part in (first, ~first)]
    for merged in (parts[0].merged(parts[1]), parts[1].merged(parts[0])):
        for name, array in whole.arrays().items():
            np.testing.assert_array_equal(array, merged.arrays()[name])
    again = AcquisitionShortlist.of(**whole.arrays())
    np.testing.assert_array_equal(again.viewpoint, whole.viewpoint)


def test_a_shortlist_keeps_the_best_and_what_offsets_it():
    rng = np.random.default_rng(4)
    gradients = np.abs(rng.standard_normal((500, 6))) * [3, 0, 0, 0, 0, 0] + [1, 0, 0, 0, 0, 0]
    gradients[123] *= -3  # one acquisition among 500 errs the other way
    candidates = pool(gradients, np.full((500, 2), 1e-3), 0.9)
    shortlist = AcquisitionShortlist.of(np.arange(500), np.zeros(500, int), acquisition_scores(candidates.acquisitions))
    assert len(shortlist.viewpoint) < 330
    assert 123 in shortlist.viewpoint
    assert np.argmin(candidates.acquisitions.mean_of(np.arange(500)[:, None]).var()) in shortlist.viewpoint


def rounding_errors(displacement, draws=200_000):
    """Of one coordinate in two acquisitions, by rounding to whole steps: the image moves by a displacement in
    between.
    """
    place = np.random.default_rng(8).uniform(0, 1, draws)
    return place - np.round(place), place + displacement - np.round(place + displacement)


def test_half_a_step_of_repeatability_makes_rounding_errors_independent():
    # what LEAST_SEPARATION_STEPS rests on: the correlation is at most 6/pi² exp(-2 pi² s²), 0.44 % at s = 0.5;
    # 4.4 / sqrt(n): false alarm 1e-5
    moved = LEAST_SEPARATION_STEPS + 0.5 * np.random.default_rng(9).standard_normal(200_000)
    first, second = rounding_errors(moved)
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.0044 + 4.4 / np.sqrt(200_000)
    # and without any, two acquisitions may round alike however far they are from each other: the page says so
    first, second = rounding_errors(7.0)
    assert np.corrcoef(first, second)[0, 1] == pytest.approx(1)


@pytest.mark.parametrize("seed", range(5))
def test_many_characteristics_share_viewpoints(seed):
    # ten characteristics that any two acquisitions meet: brute force over the viewpoints would take two, apart as all
    # are here
    rng = np.random.default_rng(seed)
    pools = [
        pool(np.outer(rng.uniform(1.5, 2.0, 40), [1, 0, 0, 0, 0, 0]), np.zeros((40, 2)), 0.0, 0.3) for _ in range(10)
    ]
    found = plan_acquisitions(pools, [], 2, 0.9)
    assert len(found) == 10
    assert len({k for looked in found for k in looked.viewpoints}) == 2


def test_acquisitions_that_are_good_for_another_characteristic_only_serve_where_they_are_taken():
    first = pool(np.outer([2.0, 2, 9, 9], [1, 0, 0, 0, 0, 0]), np.zeros((4, 2)), 0.0, 0.3)
    second = pool(np.outer([2.0, 2, 1.9, 1.9], [1, 0, 0, 0, 0, 0]), np.zeros((4, 2)), 0.0, 0.3)
    second = replace(second, good=np.array([False, False, True, True]))
    one, other = plan_acquisitions([first, second], [], 2, 0.9)
    assert one.viewpoints == other.viewpoints == (0, 1)
    (alone,) = plan_acquisitions([second], [], 2, 0.9)
    assert alone.viewpoints == (2, 3)
