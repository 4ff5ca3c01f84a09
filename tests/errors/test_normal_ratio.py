"""The ratio of normals against the printed values, quadrature in 40 digits, and itself."""

import csv
import math
import sys
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.integrate import quad

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from ratio_strategies import ratios

import viewgauge as vg
from strategies import probabilities
from viewgauge.errors import NormalRatio, marsaglia_form

REFERENCE = Path(__file__).resolve().parents[3] / "shared" / "reference"
EVERYDAY = [
    (2.0, 2.0, 0.5, 1.0),
    (1.0, 1.0, -0.9, 2.0),
    (2.0, 1.0, 0.0, -5.0),
    (1.0, 0.1, 0.6, 1.0),
    (1.0, 2.0, 0.7, 0.0),
]
each_ratio = pytest.mark.parametrize("parameters", EVERYDAY, ids=str)


def table(name):
    path = REFERENCE / name
    if not path.exists():
        pytest.skip(f"reference values ({name}) are not beside this checkout")
    with path.open() as file:
        return list(csv.DictReader(file))


def parameters_of(row):
    return [float(row[k]) for k in ("sigma_numerator", "sigma_denominator", "correlation", "mean_denominator")]


def log_density(w, s1, s2, r, mu):
    """Logarithm of the integral of |y| times the joint density at (w y, y), in 40 digits.

    The integrand is divided by its Gaussian factor's peak: an adaptive rule that judges its error absolutely stops at
    once where all values are tiny.
    """
    with mp.workdps(40):
        w, s1, s2, r, mu = map(mp.mpf, (w, s1, s2, r, mu))
        q2 = 1 - r * r
        half_curvature = (w**2 / s1**2 - 2 * r * w / (s1 * s2) + 1 / s2**2) / (2 * q2)
        top = mu * (1 / s2**2 - r * w / (s1 * s2)) / (2 * q2) / half_curvature
        width = 1 / mp.sqrt(2 * half_curvature)

        def exponent(y):
            a, b = w * y / s1, (y - mu) / s2
            return -(a * a - 2 * r * a * b + b * b) / (2 * q2)

        peak = exponent(top)
        cuts = [*range(-20, 21, 2), *[-top / width] * (abs(top) < 20 * width)]
        mass = mp.quad(lambda k: abs(top / width + k) * mp.exp(exponent(top + k * width) - peak), sorted(cuts))
        return peak + mp.log(mass * width**2 / (2 * mp.pi * s1 * s2 * mp.sqrt(q2)))


# --- reference values ---------------------------------------------------------------------------------------


def test_density_equals_the_reference():
    """1e-10 relative: the table has about 12 digits (its SOURCE.md); values below 1e-300 print as 0."""
    rows = table("ratio_normal.csv")
    assert len(rows) == 160
    for row in rows:
        value, printed = float(NormalRatio(*parameters_of(row)).pdf(float(row["value"]))), float(row["pdf"])
        assert value == pytest.approx(printed, rel=1e-10, abs=1e-300)


def test_cdf_equals_the_reference():
    for row in table("ratio_normal.csv"):
        law, w, expected = NormalRatio(*parameters_of(row)), float(row["value"]), float(row["cdf"])
        assert law.cdf(w) == pytest.approx(expected, abs=1e-12)
        assert law.sf(w) == pytest.approx(1 - expected, abs=1e-12)


def test_marsaglias_example_to_its_printed_digits():
    printed = {row["quantity"]: float(row["value"]) for row in table("marsaglia_2006.csv")}
    form = marsaglia_form(30.5, 32, 5, 4, 0.8)
    found = {
        "a": form.a,
        "b": form.b,
        "r": form.r,
        "s": form.s,
        "practical_mean_z_over_w": form.practical_mean(),
        "practical_sigma_z_over_w": form.practical_std(),
    }
    assert found.keys() == printed.keys()
    for name, value in found.items():
        assert round(float(value), 6) == printed[name], name


# --- against quadrature -------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.01, 100.0),
    st.floats(0.01, 100.0),
    st.one_of(st.sampled_from([0.0, 0.999999, -1 + 1e-9]), st.floats(-0.999, 0.999)),
    st.floats(-30.0, 30.0),
    st.floats(-50.0, 50.0),
)
@example(1.0, 1.0, 0.5, 0.0, 2.0)
@example(1.0, 0.01, 0.3, 10.0, 3.0)  # underflows: the logarithm does not
def test_density_equals_the_integral_of_the_joint_density(s1, s2, r, mu, w):
    log = float(log_density(w * s1 / s2, s1, s2, r, mu))
    # the exponent, of size |log|, is rounded, and 1 - |r| magnifies the rounding of w
    tolerance = 1e-12 + 4e-16 * abs(log) / (1 - abs(r))
    assert NormalRatio(s1, s2, r, mu).logpdf(w * s1 / s2) == pytest.approx(log, abs=max(tolerance, 1e-12 * abs(log)))


@each_ratio
def test_density_has_mass_one_and_the_cdf_is_its_integral(parameters):
    law = NormalRatio(*parameters)

    def over_angle(low, high):  # w = tan(angle): the tails of 1/w² are whole
        return sum(
            quad(lambda t: float(law.pdf(math.tan(t))) / math.cos(t) ** 2, a, b, epsabs=1e-13, epsrel=1e-12)[0]
            for a, b in zip(np.linspace(low, high, 41)[:-1], np.linspace(low, high, 41)[1:], strict=True)
        )

    right = math.pi / 2 - 1e-9  # leaves out a mass of 1e-9 times the density of the angle there
    assert over_angle(-right, right) == pytest.approx(1, abs=2e-9)
    for w in (-3.0, -0.4, 0.0, 0.7, 2.0):
        assert over_angle(-1.0, math.atan(w)) == pytest.approx(float(law.cdf(w) - law.cdf(math.tan(-1.0))), abs=1e-12)


@settings(deadline=None)
@given(ratios(), probabilities())
@example((1.0, 1.0, 0.0, 0.0), 1e-12)
def test_quantile_inverts_the_cdf(parameters, q):
    law = NormalRatio(*parameters)
    w = law.ppf(q)
    assert np.isfinite(w)
    # between neighbouring doubles (of w, and of the end of its bracket) the cdf moves by this much
    step = float(law.pdf(w)) * (abs(np.spacing(w)) + 1e-15 * parameters[0] / max(abs(parameters[3]), parameters[1]))
    assert law.cdf(w) == pytest.approx(q, abs=1e-12 + 8 * step)


@settings(deadline=None)
@given(ratios(), st.floats(-100, 100))
def test_symmetries(parameters, w):
    s1, s2, r, mu = parameters
    law = NormalRatio(s1, s2, r, mu)
    assert law.cdf(w) == pytest.approx(float(NormalRatio(s1, s2, r, -mu).cdf(w)), abs=1e-15)
    assert law.cdf(w) == pytest.approx(float(NormalRatio(s1, s2, -r, mu).sf(-w)), abs=1e-15)
    assert law.cdf(w) + law.sf(w) == pytest.approx(1, abs=1e-14)
    assert law.pdf(w) == NormalRatio(s1, s2, -r, mu).pdf(-w)
    assert 0 <= law.cdf(w) <= 1
    assert law.pdf(w) >= 0


@settings(deadline=None)
@given(ratios(), st.floats(-20, 20), st.floats(1e-9, 1e3))
def test_cdf_does_not_fall(parameters, w, step):
    law = NormalRatio(*parameters)
    assert law.cdf(w + step) >= law.cdf(w) - 1e-14


@each_ratio
def test_draws_follow_the_law(parameters):
    # Kolmogorov-Smirnov on 20 000 draws, seed fixed; false alarm 1e-4 for each of the laws
    law = NormalRatio(*parameters)
    assert stats.kstest(law.rvs(20_000, random_state=20240612), law.cdf).pvalue > 1e-4


# --- special cases ------------------------------------------------------------------------------------------


def test_without_mean_it_is_a_cauchy_law():
    # the paper's case f = C3: location r s1/s2, scale s1 sqrt(1 - r²)/s2
    x = np.linspace(-9, 9, 31)
    expected = stats.cauchy(loc=0.6 * 3 / 2, scale=3 * 0.8 / 2)
    law = NormalRatio(3.0, 2.0, 0.6, 0.0)
    np.testing.assert_allclose(law.pdf(x), expected.pdf(x), rtol=1e-13)
    np.testing.assert_allclose(law.cdf(x), expected.cdf(x), atol=1e-14)
    np.testing.assert_allclose(law.ppf([1e-9, 0.2, 0.7]), expected.ppf([1e-9, 0.2, 0.7]), rtol=1e-6)
    assert law.mode() == pytest.approx(0.9)
    assert np.isnan(law.mean())
    assert np.isnan(law.var())


@pytest.mark.parametrize("mu", [4.0, -4.0])
def test_without_spread_of_the_denominator_it_is_normal(mu):
    x = np.linspace(-3, 3, 31)
    expected = stats.norm(scale=0.75)
    for law in (NormalRatio(3.0, 0.0, 0.6, mu), NormalRatio(3.0, 1e-14, 0.6, mu)):
        np.testing.assert_allclose(law.pdf(x), expected.pdf(x), rtol=1e-12)
        np.testing.assert_allclose(law.cdf(x), expected.cdf(x), atol=1e-13)
        assert law.mean() == pytest.approx(0, abs=1e-13)
        assert law.std() == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("law", "value"), [(NormalRatio(0.0, 1.0, 0.3, 2.0), 0.0), (NormalRatio(3.0, 2.0, -1.0, 0.0), -1.5)]
)
def test_a_single_value(law, value):
    np.testing.assert_array_equal(law.cdf([value - 1e-9, value, math.nan]), [0, 1, math.nan])
    np.testing.assert_array_equal(law.sf([value - 1e-9, value]), [1, 0])
    np.testing.assert_array_equal(law.pdf([value - 1, value]), [0, math.inf])
    np.testing.assert_array_equal(law.ppf([0, 0.3, 1]), [value] * 3)
    assert (law.mode(), law.mean(), law.var()) == (value, value, 0)
    assert law.support() == (value, value)
    np.testing.assert_array_equal(law.rvs(3), [value] * 3)


def test_full_correlation_is_the_limit_of_near_correlation():
    x = np.array([-2.0, -0.3, 0.1, 0.4, 1.7])
    for r in (-1.0, 1.0):
        whole, near = NormalRatio(1.0, 0.5, r, 2.0), NormalRatio(1.0, 0.5, r * (1 - 1e-13), 2.0)
        np.testing.assert_allclose(whole.pdf(x), near.pdf(x), rtol=1e-8)
        np.testing.assert_allclose(whole.cdf(x), near.cdf(x), atol=1e-12)
    # X = Z, Y = 2 + Z/2: X/Y <= 1 where Z <= 4 and Y > 0, or Y < 0
    assert NormalRatio(1.0, 0.5, 1.0, 2.0).cdf(1.0) == pytest.approx(
        float(stats.norm.cdf(4) - stats.norm.cdf(-4)), abs=1e-14
    )


def test_far_tails_and_extreme_scales():
    law = NormalRatio(1.0, 0.01, 0.5, 1.0)
    assert law.pdf(60.0) >= 0
    assert law.logpdf(-1e6) == pytest.approx(float(log_density(-1e6, 1.0, 0.01, 0.5, 1.0)), rel=1e-12)
    np.testing.assert_array_equal(law.cdf([-math.inf, math.inf]), [0, 1])
    np.testing.assert_array_equal(law.pdf([-math.inf, math.inf]), [0, 0])
    tiny, huge = NormalRatio(1e-200, 1e-210, 0.5, 1e-209), NormalRatio(1e210, 1e200, 0.5, 1e201)
    for q in (1e-6, 0.3, 0.999):
        assert tiny.ppf(q) == pytest.approx(float(huge.ppf(q)), rel=1e-12)
    # the weight of the Cauchy tails: density of Y at 0 times E|X| given Y = 0, over w
    cauchy = NormalRatio(2.0, 1.0, 0.0, 3.0)
    weight = stats.norm.pdf(3) * 2 * math.sqrt(2 / math.pi)
    assert cauchy.sf(1e9) == pytest.approx(weight / 1e9, rel=1e-3)


# --- mode and practical moments -----------------------------------------------------------------------------


@settings(deadline=None)
@given(ratios())
@example((1.0, 1.0, 1 - 1e-12, 0.01))
@example((1.0, 1.0, 0.99, 0.3))
def test_mode_is_the_highest_density_and_has_the_sign_of_the_correlation(parameters):
    s1, s2, r, mu = parameters
    law = NormalRatio(*parameters)
    peak = float(law.mode())
    assert peak * r >= 0
    if r == 0:
        assert peak == 0
    scale = s1 / max(abs(mu), s2)
    around = np.concatenate([scale * np.linspace(-5, 5, 401), law.ppf(np.linspace(0.01, 0.99, 99))])
    assert (law.logpdf(around) <= law.logpdf(peak) + 1e-9).all()


def test_the_papers_statements_on_figures_3_and_4():
    by_r = NormalRatio(1.0, 1.0, [0.0, 0.2, 0.4, 0.6, 0.8, 0.9], 2.0)
    assert (np.diff(by_r.mode()) > 0).all()
    assert (np.diff(by_r.pdf(by_r.mode())) > 0).all()
    by_mu = NormalRatio(2.0, 2.0, 0.5, [1.0, 5.0, 10.0, 20.0])
    assert (np.diff(by_mu.mode()) < 0).all()
    assert (np.diff(by_mu.pdf(by_mu.mode())) > 0).all()


@pytest.mark.parametrize("r", [-0.95, 0.0, 0.5, 1.0])
@pytest.mark.parametrize(("b", "rel"), [(6.0, 2e-3), (8.0, 1e-6), (11.9, 1e-12), (12.1, 1e-12), (1000.0, 1e-12)])
def test_practical_moments_are_those_of_a_denominator_that_keeps_off_zero(b, r, rel):
    # the denominator kept above one standard deviation; by conditioning on it, 30 digits
    with mp.workdps(30):
        B, R = mp.mpf(b), mp.mpf(r)
        cuts = [-min(B - 1, mp.mpf(16)), -4, 0, 4, 16]
        first = mp.quad(lambda z: mp.npdf(z) * R * z / (B + z), cuts)
        second = mp.quad(lambda z: mp.npdf(z) * (R * R * z * z + 1 - R * R) / (B + z) ** 2, cuts)
    law = NormalRatio(3.0, 0.5, r, 0.5 * b)
    assert law.mean() == pytest.approx(float(first) * 6, rel=20 * rel)
    assert law.var() == pytest.approx(float(second - first**2) * 36, rel=20 * rel)


def test_practical_moments_are_not_given_near_zero():
    laws = NormalRatio(1.0, 1.0, 0.5, [3.99, 4.0, -3.99, -4.0])
    np.testing.assert_array_equal(np.isnan(laws.mean()), [True, False, True, False])
    np.testing.assert_array_equal(np.isnan(laws.var()), [True, False, True, False])
    # Marsaglia's fits are good to 1 and 2 percent of the spread
    form, law = marsaglia_form(0.0, 8.0, 1.0, 1.0, 0.05), NormalRatio(1.0, 1.0, 0.05, 8.0)
    assert form.practical_mean() == pytest.approx(float(law.mean()), abs=0.01 * float(law.std()))
    assert form.practical_std() == pytest.approx(float(law.std()), rel=0.02)


@settings(deadline=None)
@given(
    st.floats(-5, 5),
    st.floats(-9, 9, allow_subnormal=False),
    st.floats(0.1, 5),
    st.floats(0.1, 5),
    st.floats(-0.99, 0.99),
)
def test_marsaglias_form_is_the_same_law(mean_z, mean_w, sigma_z, sigma_w, rho):
    # the pair (z - s w) r and w / s_w is uncorrelated with unit variances, and has the means a and ±b
    form = marsaglia_form(mean_z, mean_w, sigma_z, sigma_w, rho)
    scale = form.r / sigma_w
    variance = scale**2 * (sigma_z**2 - 2 * form.s * rho * sigma_z * sigma_w + form.s**2 * sigma_w**2)
    assert variance == pytest.approx(1, rel=1e-9)
    assert rho * sigma_z * sigma_w - form.s * sigma_w**2 == pytest.approx(0, abs=1e-12)
    sign = -1.0 if mean_w / sigma_w < 0 else 1.0
    assert scale * (mean_z - form.s * mean_w) == pytest.approx(sign * float(form.a), abs=1e-9)
    assert mean_w / sigma_w == pytest.approx(sign * float(form.b))


def test_parameters_broadcast_element_by_element():
    law = NormalRatio([[1.0], [0.0], [2.0]], [1.0, 0.0, 0.1, 3.0], 0.5, 2.0)
    for word in ("mean", "var", "std", "median", "mode", "rvs"):
        assert getattr(law, word)().shape == (3, 4), word
    x = np.linspace(-1, 1, 5)[:, None, None]
    for word in ("pdf", "logpdf", "cdf", "sf"):
        assert getattr(law, word)(x).shape == (5, 3, 4), word
    assert law.interval(0.9)[0].shape == (3, 4)
    alone = NormalRatio(2.0, 0.1, 0.5, 2.0)
    np.testing.assert_array_equal(law.cdf(x)[:, 2, 2], alone.cdf(x[:, 0, 0]))
    assert law.mode()[2, 2] == alone.mode()


@pytest.mark.parametrize(
    ("parameters", "name"),
    [
        ((-1.0, 1.0, 0.0, 1.0), "sigma_numerator"),
        ((1.0, math.nan, 0.0, 1.0), "sigma_denominator"),
        ((1.0, 1.0, 1.0000001, 1.0), "correlation"),
        ((1.0, 1.0, 0.0, math.inf), "mean_denominator"),
        ((1.0, 0.0, 0.0, 0.0), "mean_denominator"),
    ],
)
def test_bad_parameters_are_refused(parameters, name):
    with pytest.raises(vg.InputError, match=name):
        NormalRatio(*parameters)


@pytest.mark.parametrize(
    ("parameters", "name"),
    [
        ((1, 1, 0.0, 1.0, 0.5), "sigma_numerator"),
        ((1, 1, 1.0, 0.0, 0.5), "sigma_denominator"),
        ((1, 1, 1.0, 1.0, 1.0), "correlation"),
    ],
)
def test_what_has_no_standard_form_is_refused(parameters, name):
    with pytest.raises(vg.InputError, match=name):
        marsaglia_form(*parameters)
