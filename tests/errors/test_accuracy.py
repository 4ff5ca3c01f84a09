"""The accuracy law (eq. 20) against the definition, quadrature and draws."""

import itertools
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.integrate import quad

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import viewgauge as vg
from strategies import angles, probabilities, scales
from viewgauge.errors import Accuracy, IndependentTotalError, NormalRatio, TotalError

SKEW = (NormalRatio(1.0, 0.12, 0.9, 1.0), NormalRatio(0.5, 0.1, -1.0, 1.0))
LAWS = {
    "pixels only": Accuracy(TotalError(0.0, 1.0, 0.4), 5.0),
    "displacement only": Accuracy(TotalError(0.3, 0.0, 0.4), 5.0),
    "both": Accuracy(TotalError(0.3, (1.0, 0.7), 0.4), 5.0),
    "error as large as the length": Accuracy(TotalError(3.0, (1.0, 0.7), 0.4), 2.0),
    "independent": Accuracy(IndependentTotalError(SKEW, (1, -1), 1.0, 0.4), 50.0),
}
each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def integral(function, low, high):
    cuts = np.linspace(low, high, 61)
    return sum(quad(function, a, b, epsabs=1e-12, epsrel=1e-10)[0] for a, b in itertools.pairwise(cuts))


@each_law
def test_density_has_mass_one_and_the_stated_moments(law):
    low = float(law.ppf(1e-9))
    assert integral(law.pdf, low, 1.0) == pytest.approx(1, abs=2e-9)
    mean = integral(lambda x: x * law.pdf(x), low, 1.0)
    assert mean == pytest.approx(float(law.mean()), abs=1e-7)
    assert integral(lambda x: (x - mean) ** 2 * law.pdf(x), low, 1.0) == pytest.approx(float(law.var()), rel=1e-5)
    for q in (0.1, 0.5, 0.8):
        x = float(law.ppf(q))
        assert integral(law.pdf, low, x) == pytest.approx(q, abs=3e-9)


@each_law
def test_it_is_the_law_of_one_minus_the_relative_error(law):
    tolerance = np.array([0.0, 0.01, 0.1, 0.5, 2.0])
    expected = law.error.cdf(tolerance * law.length_mm) - law.error.cdf(-tolerance * law.length_mm)
    np.testing.assert_allclose(law.success_probability(tolerance), expected, atol=1e-10)
    np.testing.assert_allclose(law.sf(1 - tolerance), expected, atol=1e-10)
    np.testing.assert_allclose(law.cdf(1 - tolerance) + law.sf(1 - tolerance), 1)
    np.testing.assert_array_equal(law.cdf([1.0, 1.5]), [1, 1])
    assert law.pdf(1.01) == 0
    assert law.support()[1] == 1
    np.testing.assert_array_equal(law.ppf([0, 1]), np.array(law.support()))


@each_law
def test_draws_follow_the_law(law):
    # Kolmogorov-Smirnov on 20 000 draws, seed fixed; false alarm 1e-4 for each of the laws
    draws = law.rvs(20_000, random_state=20240614)
    assert (draws <= 1).all()
    assert stats.kstest(draws, law.cdf).pvalue > 1e-4
    assert draws.mean() == pytest.approx(float(law.mean()), abs=5 * float(law.std()) / math.sqrt(20_000))


@settings(deadline=None)
@given(scales(1e-3, 1e3), scales(1e-3, 1e3), angles(), st.floats(0.01, 1e3), probabilities())
def test_quantile_inverts_the_cdf(sigma, pitch, angle, length, q):
    assume(1e-9 < sigma + pitch < 1e9)
    law = Accuracy(TotalError(sigma, pitch, angle), length)
    x = float(law.ppf(q))
    assert np.isfinite(x)
    # between neighbouring doubles the cdf moves by this much
    step = float(law.pdf(x)) * max(np.spacing(abs(x)), 1e-16)
    assert law.cdf(x) == pytest.approx(q, abs=1e-12 + 8 * step)


def test_expected_accuracy_may_be_negative_and_certain_without_error():
    assert Accuracy(TotalError(30.0, 1.0, 0.3), 2.0).mean() < 0
    perfect = Accuracy(TotalError(0.0, 0.0, 0.3), 2.0)
    assert (perfect.mean(), perfect.var(), perfect.success_probability(0.0)) == (1, 0, 1)


def test_parameters_broadcast():
    law = Accuracy(TotalError([0.1, 0.2, 0.3], 1.0, 0.4), [[5.0], [10.0]])
    for word in ("mean", "var", "std", "median", "rvs"):
        assert getattr(law, word)().shape == (2, 3), word
    for word in ("pdf", "cdf", "sf", "success_probability"):
        assert getattr(law, word)(0.9).shape == (2, 3), word
    alone = Accuracy(TotalError(0.2, 1.0, 0.4), 10.0)
    assert law.mean()[1, 1] == alone.mean()
    assert law.ppf(0.3)[1, 1] == pytest.approx(float(alone.ppf(0.3)), rel=1e-13)


@pytest.mark.parametrize("length", [0.0, -1.0, math.nan, [1.0, 0.0], "long"])
def test_a_length_that_is_none_is_refused(length):
    with pytest.raises(vg.InputError, match="length_mm"):
        Accuracy(TotalError(0.1, 1.0, 0.3), length)


@pytest.mark.parametrize("tolerance", [-0.1, math.nan])
def test_a_tolerance_that_is_none_is_refused(tolerance):
    with pytest.raises(vg.InputError, match="relative_tolerance"):
        LAWS["both"].success_probability(tolerance)
