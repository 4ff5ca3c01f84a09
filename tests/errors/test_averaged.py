"""The law of the mean of several viewpoints against sums of differences in high precision, and against other laws."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy import stats

import viewgauge as vg
from strategies import angles, positions, scales
from viewgauge.errors import TotalError
from viewgauge.errors.joint.averaged import AveragedError

STATED = 1e-10  # what the class promises
USUAL = 1e-12  # where no width is far smaller than the others


def integrated(y, sigma, order):
    """The normal law (or step) with this sigma, integrated ``order`` times; order -1: its density."""
    if sigma == 0:
        return y**order / mp.factorial(order) if y > 0 else mp.mpf(0)
    before, current = mp.npdf(y, 0, sigma), mp.ncdf(y, 0, sigma)
    if order < 0:
        return before
    for m in range(1, order + 1):
        before, current = current, (y * current + sigma**2 * before) / m
    return current


def exact(x, sigma, widths, order=0):
    """cdf (order 0) or density (-1): each triangular error is a second difference of what is integrated twice.

    Equal widths share their places, so that 32 of them make 65 terms. Digits that cancel are added.
    """
    widths = [w for w in widths if w > 0]
    m = order + 2 * len(widths)
    smallest, widest = min([*widths, *([sigma] if sigma else [])]), max([*widths, sigma, abs(x)])
    with mp.workdps(int(40 + 2 * m * (1 + math.log10(widest * len(widths) / smallest)))):
        sums = {mp.mpf(x): mp.mpf(1)}
        for w in map(mp.mpf, widths):
            new = {}
            for at, weight in sums.items():
                for step, factor in ((-w, 1), (0, -2), (w, 1)):
                    new[at + step] = new.get(at + step, 0) + factor * weight / w**2
            sums = new
        return float(mp.fsum(c * integrated(at, mp.mpf(sigma), m) for at, c in sums.items()))


EQUAL = [(s, [0.25] * n) for s, n in ((0.0, 4), (0.05, 4), (1.0, 4), (0.0, 8), (0.05, 8), (0.0, 32), (1.0, 32))]
MIXED = [(s, w) for s in (0.0, 0.2) for w in ([1.0, 0.4, 0.7], [1.0, 0.3, 0.9, 0.2], [1.0, 0.5, 0.75, 0.25, 0.125])]
HARD = [
    (0.0, [1.0, 1e-4, 1e-5]),  # the widest series
    (0.0, [1.0, 2e-6, 1e-6, 1e-6]),  # partly folded into sigma
    (1e-5, [1.0, 1e-3, 1e-5]),
    (1.0, [1e-5, 1e-5, 1e-5]),
    (1e-6, [1.0, 1.0, 1e-3]),
]


@pytest.mark.parametrize(("sigma", "widths"), EQUAL + MIXED)
def test_probabilities_and_densities_equal_the_differences_in_high_precision(sigma, widths):
    law = AveragedError(sigma, widths)
    peak = exact(0.0, sigma, widths, -1)
    for x in (0.0, 0.1, 0.4, 1.0, 1.7, 2.9):
        truth = exact(-x, sigma, widths)
        assert law.cdf(-x) == pytest.approx(truth, abs=USUAL)
        assert law.central_probability(x) == pytest.approx(1 - 2 * truth, abs=2 * USUAL)
        assert law.pdf(x) == pytest.approx(exact(x, sigma, widths, -1), abs=STATED * peak)


@pytest.mark.parametrize(("sigma", "widths"), HARD)
def test_widths_of_very_different_size(sigma, widths):
    law = AveragedError(sigma, widths)
    for x in (1e-7, 1e-5, 1e-3, 0.3, 1 - 1e-5, 1.0, 1 + 1e-6):
        assert law.central_probability(x) == pytest.approx(1 - 2 * exact(-x, sigma, widths), abs=STATED)
        # the kink of the widest: the density is promised to 2e-6 of its peak there
        assert law.pdf(x) == pytest.approx(exact(x, sigma, widths, -1), abs=2e-6 * exact(0.0, sigma, widths, -1))


@settings(max_examples=200, deadline=None)
@given(positions(), scales(), scales(), scales(), angles())
@example(0.0, 0.0, 0.0, 0.0, 0.3)
def test_one_acquisition_is_the_total_error(position, sigma, width, height, angle):
    total = TotalError(sigma, (width, height), angle)
    widths = [float(total.quantization.half_width_u), float(total.quantization.half_width_v)]
    x = position * float(total.std())
    for widths_too in (widths, [*widths, 0.0, 0.0]):
        law = AveragedError(sigma, widths_too)
        assert law.cdf(x) == pytest.approx(float(total.cdf(x)), abs=1e-12)
        assert law.central_probability(abs(x)) == pytest.approx(float(total.central_probability(abs(x))), abs=1e-12)
        assert law.pdf(x) == pytest.approx(float(total.pdf(x)), rel=1e-12)
        assert law.mean_absolute() == pytest.approx(float(total.mean_absolute()), rel=1e-12)
        assert law.var() == pytest.approx(float(total.var()), rel=1e-12)


@settings(max_examples=150, deadline=None)
@given(scales(), st.lists(scales(), min_size=1, max_size=6), st.floats(0, 9), st.floats(0, 9))
def test_it_is_a_law_whatever_the_sizes(sigma, widths, first, second):
    law = AveragedError(sigma, widths)
    assume(law.var() > 1e-200)  # no underflow in the comparisons themselves
    low, high = sorted((first * float(law.std()), second * float(law.std())))
    inner, outer = law.central_probability([low, high])
    assert 0 <= inner <= 1
    assert outer >= inner - STATED
    assert law.cdf(-low) == pytest.approx(1 - float(law.cdf(low)), abs=1e-15)
    # Chebyshev, and E|X| between what symmetry and Jensen allow
    if low > 1e-3 * float(law.std()):
        assert 1 - inner <= float(law.var()) / low**2 + STATED
    assert 0.7 * float(law.std()) <= law.mean_absolute() <= float(law.std()) * (1 + 1e-9)


def test_all_triangles_far_below_sigma_leave_the_normal_law():
    x = np.array([0.1, 1.0, 2.0])
    law = AveragedError(1.0, [1e-9] * 6)
    np.testing.assert_allclose(law.central_probability(x), stats.norm.cdf(x) - stats.norm.cdf(-x), atol=1e-14)


def test_many_equal_triangles_tend_to_the_normal_law():
    # the fourth cumulant of a triangle of variance 1/6 is -1/60: Edgeworth's first term, -(k4/24) He3(x) phi(x)
    law = AveragedError(0.0, np.full(32, math.sqrt(6 / 32)))
    x = np.array([-1.5, -0.5, 0.7])
    edgeworth = stats.norm.cdf(x) + (36 / 60 / 32 / 24) * (x**3 - 3 * x) * stats.norm.pdf(x)
    np.testing.assert_allclose(law.cdf(x), edgeworth, atol=2e-5)  # the next terms are of order 1/32²


def test_expected_absolute_error_is_the_integral_of_the_tails():
    for sigma, widths in [(0.0, [1.0, 0.6, 0.3]), (0.4, [1.0, 1.0, 0.2, 0.1]), (2.0, [0.5] * 6)]:
        law = AveragedError(sigma, widths)
        x = np.linspace(0, 9 * float(law.std()) + sum(widths), 20001)
        tails = 1 - law.central_probability(x)
        assert law.mean_absolute() == pytest.approx(np.trapezoid(tails, x), rel=1e-6)  # 20 000 steps


def test_draws_follow_the_law():
    # Kolmogorov-Smirnov on 20 000 draws, seed fixed; false alarm 1e-4 each
    for sigma, widths in [(0.0, [1.0, 0.6, 0.3]), (0.4, [1.0, 1.0, 0.2, 0.1])]:
        law = AveragedError(sigma, widths)
        assert stats.kstest(law.rvs(20_000, random_state=5), law.cdf).pvalue > 1e-4


def test_quantiles_support_and_broadcasting():
    law = AveragedError([[0.0], [0.5]], [[1.0, 0.5, 0.5], [0.2, 0.1, 0.0], [0.0, 0.0, 0.0]])
    assert law.var().shape == law.rvs(random_state=1).shape == law.mean_absolute().shape == (2, 3)
    q = np.array([0.01, 0.5, 0.9])[:, None, None]
    some = np.s_[:, 0, :2]
    np.testing.assert_allclose(law.cdf(law.ppf(q))[some], np.broadcast_to(q, (3, 2, 3))[some], atol=1e-9)
    low, high = law.support()
    np.testing.assert_allclose(high, [[2.0, 0.3, 0.0], [np.inf] * 3])
    np.testing.assert_array_equal(low, -high)
    alone = AveragedError(0.5, [1.0, 0.5, 0.5])
    assert law.cdf(0.3)[1, 0] == alone.cdf(0.3)
    assert law.central_probability([[[0.4]], [[-1.0]]]).shape == (2, 2, 3)
    np.testing.assert_array_equal(law.central_probability(0.0)[0], [0, 0, 1])  # no error at all: always 0
    assert np.isnan(alone.cdf(math.nan))


@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf, "x"])
def test_bad_parameters_are_refused(bad):
    with pytest.raises(vg.InputError, match="sigma"):
        AveragedError(bad, [1.0, 1.0])
    with pytest.raises(vg.InputError, match="half_widths"):
        AveragedError(1.0, [1.0, bad])
    with pytest.raises(vg.InputError, match="last axis"):
        AveragedError(1.0, 1.0)
