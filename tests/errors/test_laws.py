"""SpatialQuantization and TotalError speak scipy.stats: every word checked against another."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from scipy import stats
from scipy.integrate import quad

import viewgauge as vg
from strategies import angles, probabilities, scales
from viewgauge.errors import SpatialQuantization, TotalError

LAWS = {
    "square pixels": SpatialQuantization(1.0, 0.3),
    "wide pixels": SpatialQuantization((1.5, 0.7), -2.0),
    "along u": SpatialQuantization(2.0, 0.0),
    "along v, nearly": SpatialQuantization(2.0, math.pi / 2 - 1e-9),
    "pixels and some displacement": TotalError(0.2, 1.0, 0.8),
    "pixels and much displacement": TotalError(3.0, (1.0, 0.5), 2.5),
    "displacement only": TotalError(0.7, 0.0, 1.0),
    "hardly any displacement": TotalError(1e-6, 1.0, 0.8),
}
each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def pieces(law, upper=math.inf):
    """Intervals between the kinks of the density; the normal part ends at 12 sigma (3e-33)."""
    sigma = getattr(law, "sigma_displacement_mm", np.array(0.0))
    quantization = getattr(law, "quantization", law)
    a, b = float(quantization.half_width_u), float(quantization.half_width_v)
    kinks = {i * a + j * b for i, j in itertools.product((-1, 0, 1), repeat=2)}
    cuts = {k + i * float(sigma) for k in kinks for i in (-12, -3, -1, 0, 1, 3, 12)}
    cuts = sorted({c for c in cuts if c < upper} | ({upper} if upper < math.inf else set()))
    return list(itertools.pairwise(cuts))


def integral(function, law, upper=math.inf):
    # quad reports an error near 1e-15 on such smooth pieces
    return sum(quad(function, low, high, epsabs=1e-14, epsrel=1e-13)[0] for low, high in pieces(law, upper))


@each_law
def test_density_has_mass_one_and_the_stated_moments(law):
    assert integral(law.pdf, law) == pytest.approx(1, abs=1e-12)
    assert integral(lambda x: x * law.pdf(x), law) == pytest.approx(float(law.mean()), abs=1e-12)
    assert integral(lambda x: x * x * law.pdf(x), law) == pytest.approx(float(law.var()), rel=1e-11)
    assert law.std() == pytest.approx(math.sqrt(law.var()))


@each_law
def test_cdf_is_the_integral_of_the_density(law):
    for x in np.array([-2.5, -1.3, -0.2, 0.0, 0.4, 1.9]) * law.std():
        assert law.cdf(x) == pytest.approx(integral(law.pdf, law, upper=x), abs=1e-12)
        assert law.sf(x) == pytest.approx(1 - integral(law.pdf, law, upper=x), abs=1e-12)


@each_law
def test_expected_absolute_error_is_the_integral_of_the_density(law):
    if isinstance(law, TotalError):
        assert law.mean_absolute() == pytest.approx(integral(lambda x: abs(x) * law.pdf(x), law), rel=1e-11)


@each_law
def test_interval_holds_its_probability_with_equal_tails(law):
    for confidence in (0.05, 0.5, 0.95, 0.999):
        low, high = law.interval(confidence)
        assert law.cdf(low) == pytest.approx((1 - confidence) / 2, abs=1e-13)
        assert law.sf(high) == pytest.approx((1 - confidence) / 2, abs=1e-13)
    assert law.median() == pytest.approx(0, abs=1e-12)


@each_law
def test_quantiles_at_and_beyond_the_ends(law):
    low, high = law.support()
    np.testing.assert_array_equal(law.ppf([0, 1]), [low, high])
    assert np.isnan(law.ppf([-0.1, 1.1, np.nan])).all()
    assert (law.cdf(low), law.cdf(high)) == (0, pytest.approx(1, abs=1e-15))


@each_law
def test_deep_quantiles_stay_in_order(law):
    values = law.ppf([1e-300, 1e-50, 1e-19, 1e-15, 1e-9, 0.5, 1 - 1e-9, 1 - 1e-15])
    assert np.isfinite(values).all()
    assert (np.diff(values) >= 0).all()


@pytest.mark.parametrize("angle", [0.0, 0.3, math.pi / 4, math.pi / 2 - 1e-9, math.pi / 2, -2.0])
def test_quantization_never_exceeds_its_support_and_fills_it(angle):
    law = SpatialQuantization((2.0, 0.5), angle)
    reach = 2.0 * abs(math.cos(angle)) + 0.5 * abs(math.sin(angle))  # both ends off by half a pixel, apart
    np.testing.assert_allclose(law.support(), [-reach, reach], rtol=1e-15)
    assert law.pdf(1.0001 * reach) == 0
    assert law.pdf(0.99 * reach) > 0


def test_support_is_the_whole_line_as_soon_as_there_is_displacement():
    low, high = TotalError([0.0, 1e-300], 1.0, 0.0).support()
    np.testing.assert_array_equal(low, [-1, -np.inf])
    np.testing.assert_array_equal(high, [1, np.inf])


def test_triangular_quantiles_along_a_pixel_axis():
    expected = stats.triang(0.5, loc=-1, scale=2).ppf([0.005, 0.3, 0.9])
    np.testing.assert_allclose(SpatialQuantization(1.0, math.pi / 2).ppf([0.005, 0.3, 0.9]), expected, atol=1e-14)


@settings(max_examples=150, deadline=None)
@given(probabilities(), scales(), scales(), scales(), angles())
@example(0.5, 1e-12, 1e-12, 1e-12, 2.0)  # the root is at 0, where a relative tolerance never ends
def test_ppf_inverts_cdf(q, sigma, width, height, angle):
    law = TotalError(sigma, (width, height), angle)
    x = law.ppf(q)
    assert np.isfinite(x)
    assume(law.var() > 0)  # without any error the cdf is a step
    # between neighbouring doubles the cdf moves by this much, where x itself is far from 0
    step = float(law.pdf(x)) * abs(np.spacing(x))
    assert law.cdf(x) == pytest.approx(q, abs=1e-13 + 4 * step)


def test_without_any_error_every_quantile_and_draw_is_zero():
    law = TotalError(0.0, 0.0, 0.3)
    np.testing.assert_array_equal(law.ppf([0, 1e-3, 0.5, 1]), np.zeros(4))
    np.testing.assert_array_equal(law.rvs(5, random_state=1), np.zeros(5))
    assert (law.mean(), law.var(), law.mean_absolute()) == (0, 0, 0)
    assert law.central_probability(0.0) == 1


@each_law
def test_draws_follow_the_law(law):
    # Kolmogorov-Smirnov on 20 000 draws, seed fixed; false alarm 1e-4 for each of the eight laws
    draws = law.rvs(20_000, random_state=20240611)
    assert stats.kstest(draws, law.cdf).pvalue > 1e-4


def test_draws_are_independent_between_elements_and_repeat_with_the_seed():
    law = TotalError([0.0, 0.5], [(1.0, 1.0), (2.0, 0.5)], 0.8)
    draws = law.rvs((20_000, 2), random_state=7)
    np.testing.assert_array_equal(draws, law.rvs((20_000, 2), random_state=np.random.default_rng(7)))
    # correlation of independent draws: within 4.4 / sqrt(n); false alarm 1e-5
    assert abs(np.corrcoef(draws.T)[0, 1]) < 4.4 / math.sqrt(20_000)
    # variances within 5 standard errors (kurtosis at most 3: sqrt(2 / n)); false alarm 1e-6
    np.testing.assert_allclose(draws.var(axis=0), law.var(), rtol=5 * math.sqrt(2 / 20_000))
    assert law.rvs(random_state=1).shape == (2,)


def test_more_of_either_error_spreads_the_total():
    x = 0.6
    by_sigma = TotalError([0.0, 0.1, 0.3, 1.0, 10.0], 1.0, 0.4).central_probability(x)
    by_pitch = TotalError(0.3, [(p, p) for p in (0.0, 0.1, 1.0, 3.0)], 0.4).central_probability(x)
    assert (np.diff(by_sigma) < 0).all()
    assert (np.diff(by_pitch) < 0).all()


def test_parameters_and_arguments_broadcast_element_by_element():
    sigma = np.array([[0.0], [0.1], [1.0]])
    pitch = np.array([[1.0, 1.0], [2.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
    angle = np.array([0.0, 0.5, 1.0, math.pi / 2])
    law = TotalError(sigma, pitch, angle)
    for word in ("mean", "var", "std", "median", "mean_absolute", "rvs"):
        assert getattr(law, word)().shape == (3, 4), word
    x = np.linspace(-1, 1, 5)[:, None, None]
    for word in ("pdf", "cdf", "sf", "central_probability"):
        assert getattr(law, word)(x).shape == (5, 3, 4), word
    q = np.array([0.1, 0.7])[:, None, None]
    assert law.ppf(q).shape == (2, 3, 4)
    assert law.interval(0.9)[0].shape == (3, 4)
    for i, j in itertools.product(range(3), range(4)):
        alone = TotalError(sigma[i, 0], pitch[j], angle[j])
        np.testing.assert_array_equal(law.cdf(x)[:, i, j], alone.cdf(x[:, 0, 0]))
        np.testing.assert_allclose(law.ppf(q)[:, i, j], alone.ppf(q[:, 0, 0]), rtol=1e-14, atol=1e-15)
        assert law.mean_absolute()[i, j] == alone.mean_absolute()


def test_square_pixels_can_be_given_as_one_number():
    np.testing.assert_array_equal(
        SpatialQuantization(0.5, [0.1, 0.9]).cdf(0.2), SpatialQuantization((0.5, 0.5), [0.1, 0.9]).cdf(0.2)
    )


@pytest.mark.parametrize("bad", [-1.0, -1e-300, math.nan, math.inf, -math.inf, [0.1, math.nan], "wide", None])
@pytest.mark.parametrize("law", [SpatialQuantization, lambda pitch, angle: TotalError(0.1, pitch, angle)])
def test_a_bad_pixel_pitch_is_refused(law, bad):
    with pytest.raises(vg.InputError, match="pixel_pitch_mm"):
        law(bad, 0.3)


@pytest.mark.parametrize("pitch", [[1.0], [1.0, 2.0, 3.0], np.ones((2, 3))])
def test_a_pixel_pitch_of_the_wrong_shape_is_refused(pitch):
    with pytest.raises(vg.InputError, match="width and height"):
        SpatialQuantization(pitch, 0.3)


@pytest.mark.parametrize("bad", [-0.1, math.nan, math.inf, [0.1, -0.1], "x"])
def test_a_bad_displacement_is_refused(bad):
    with pytest.raises(vg.InputError, match="sigma_displacement_mm"):
        TotalError(bad, 1.0, 0.3)


@pytest.mark.parametrize("bad", [math.nan, math.inf, [0.1, -math.inf], "x"])
@pytest.mark.parametrize("law", [SpatialQuantization, lambda pitch, angle: TotalError(0.1, pitch, angle)])
def test_a_bad_angle_is_refused(law, bad):
    with pytest.raises(vg.InputError, match="angle_rad"):
        law(1.0, bad)
