"""Length errors of both models: against reference probabilities, convolution by quadrature, draws, and each other."""

import csv
import hashlib
import itertools
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.integrate import quad

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from ratio_strategies import pixels, steady_ratios

import viewgauge as vg
from strategies import angles, pose_covariances
from viewgauge.errors import IndependentTotalError, NormalRatio, SegmentDisplacement, TotalError
from viewgauge.errors.independent import ratio_sum

REFERENCE = Path(__file__).resolve().parents[3] / "shared" / "reference" / "segment_probability.csv"
F = 16.0
START, END = np.array([-30.0, 10.0, 480.0]), np.array([25.0, 35.0, 510.0])
COVARIANCE = vg.PoseError.from_standard_deviations(0.3, 5e-4, pivot_mm=(0.0, 0.0, -F)).camera_covariance
WIDE_PIXEL, NARROW_PIXEL = (30.0, 10.0), (0.3, 0.4)
SKEW = (NormalRatio(1.0, 0.12, 0.9, 1.0), NormalRatio(0.5, 0.1, -1.0, 1.0))
LAWS = {
    "displacement only": IndependentTotalError(SKEW, (1, -1), 0.0, 0.6),
    "narrow pixels": IndependentTotalError(SKEW, (1, -1), NARROW_PIXEL, 0.6),
    "wide pixels": IndependentTotalError(SKEW, (1, -1), WIDE_PIXEL, 0.6),
    "wide pixels along u": IndependentTotalError(SKEW, (1, -1), WIDE_PIXEL, 0.0),
    "pixels only": IndependentTotalError([NormalRatio(0.0, 0.1, 0.0, 1.0)], [1], NARROW_PIXEL, 0.6),
    "one ratio, fully correlated": IndependentTotalError([NormalRatio(1.0, 0.1, 1.0, 1.0)], [2.0], 0.0, 0.0),
    "segment": SegmentDisplacement.independent(START, END, F, COVARIANCE),
    "segment and pixels": SegmentDisplacement.independent(START, END, F, COVARIANCE).plus_quantization(0.00345),
}
each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def integral(function, low, high, law):
    """Between the kinks that the density may have, and in 24 pieces."""
    a, b = float(law.quantization.half_width_u), float(law.quantization.half_width_v)
    kinks = {i * a + j * b for i, j in itertools.product((-1, 0, 1), repeat=2)}
    cuts = sorted({c for c in kinks | set(np.linspace(low, high, 25)) if low <= c <= high})
    return sum(quad(function, c, d, epsabs=1e-13, epsrel=1e-12, limit=200)[0] for c, d in itertools.pairwise(cuts))


# --- the independent model: reference values ----------------------------------------------------------------


def test_independent_probabilities_equal_the_reference():
    # Source: p_independent, Fourier inversion, about 1e-7, 9 digits printed. Measured here: 5e-10 at most.
    if not REFERENCE.exists():
        pytest.skip("reference values (segment_probability.csv) are not beside this checkout")
    with REFERENCE.open() as file:
        rows = [{k: v if k == "kind" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == 40
    for row in rows:
        error = vg.PoseError.from_standard_deviations(
            [row["sd_tx"], row["sd_ty"], row["sd_tz"]],
            [row["sd_rx"], row["sd_ry"], row["sd_rz"]],
            pivot_mm=(0.0, 0.0, row["pivot_z"]),
        )
        start, end = ([row[f"{axis}{k}"] for axis in "xyz"] for k in (1, 2))
        displacement = SegmentDisplacement.independent(start, end, row["focal_length_mm"], error.camera_covariance)
        assert float(displacement.length_mm) == pytest.approx(row["image_length_mm"], rel=1e-13)
        law = TotalError.of(displacement, (row["pixel_width_mm"], row["pixel_height_mm"]))
        p = law.central_probability(row["relative_tolerance"] * displacement.length_mm)
        assert p == pytest.approx(row["p_independent"], abs=1e-8)


# --- the independent model: against convolution by quadrature ------------------------------------------------


@settings(max_examples=15, deadline=None)
@given(steady_ratios(), steady_ratios(), st.sampled_from([-1.0, 0.3, 1.0]), st.floats(-3.0, 3.0))
@example((1.0, 0.125, 0.999, 1.0), (1.0, 0.125, -0.999, 1.0), 1.0, -2.0)
@example((1.0, 0.0, 0.0, 1.0), (1e-3, 0.125, 0.9, 1.0), 1.0, 1.0)
def test_two_ratios_equal_their_convolution(first, second, weight, position):
    # the oracle: one law's density against the other's cdf, neither by Fourier series
    assume(first[0] > 0)
    one, other = NormalRatio(*first), NormalRatio(*second)
    law = IndependentTotalError([one, other], [1.0, weight], 0.0, 0.0)
    x = position * float(law.std())

    def kernel(y):
        rest = (x - y) / weight
        return float(one.pdf(y)) * float(other.cdf(rest) if weight > 0 else other.sf(rest))

    low, high = float(one.ppf(1e-13)), float(one.ppf(1 - 1e-12))
    steps = second[0] * abs(weight) * np.array([-9.0, -3.0, -1.0, 0.0, 1.0, 3.0, 9.0]) + x  # where the cdf rises
    edges = np.unique(
        np.concatenate([np.linspace(low, high, 41), one.ppf([0.02, 0.5, 0.98]), np.clip(steps, low, high)])
    )
    expected = sum(quad(kernel, a, b, epsabs=1e-13, epsrel=1e-11, limit=100)[0] for a, b in itertools.pairwise(edges))
    assert law.cdf(x) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(steady_ratios(), pixels(), angles(), st.floats(-2.0, 2.0))
@example((1.0, 0.125, 0.999, 1.0), np.array([7.9, 1.0]), 0.3, 0.5)
@example((1.0, 0.125, 0.999, 1.0), np.array([8.6, 1.0]), 0.3, 0.5)
@example((1.0, 0.125, 0.999, 1.0), np.array([1e3, 1e-9]), 0.3, 0.001)
def test_a_ratio_and_pixels_equal_their_convolution(parameters, pitch, angle, position):
    assume(parameters[0] > 0)
    ratio = NormalRatio(*parameters)
    law = IndependentTotalError([ratio], [1.0], pitch, angle)
    quantization = law.quantization
    x = position * float(law.std())
    a, b = float(quantization.half_width_u), float(quantization.half_width_v)
    low, high = float(ratio.ppf(1e-13)), float(ratio.ppf(1 - 1e-12))
    kinks = [x - i * a - j * b for i, j in itertools.product((-1, 0, 1), repeat=2)]
    edges = np.unique(
        np.concatenate([np.linspace(low, high, 31), np.clip(kinks, low, high), ratio.ppf([0.01, 0.5, 0.99])])
    )
    expected = sum(
        quad(lambda y: float(ratio.pdf(y)) * float(quantization.cdf(x - y)), c, d, epsabs=1e-12, epsrel=1e-10)[0]
        for c, d in itertools.pairwise(edges)
    )
    assert law.cdf(x) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(steady_ratios(), pixels(), angles(), st.floats(0.0, 4.0))
def test_with_a_steady_denominator_it_is_the_closed_form(parameters, pitch, angle, position):
    # two models, one law: normal displacement in closed form (TotalError) and four ratios that are normal
    sigma = parameters[0]
    law = IndependentTotalError([NormalRatio(sigma / 2, 0.0, 0.0, 1.0)] * 4, [1, -1, 1, -1], pitch, angle)
    normal = TotalError(sigma, pitch, angle)
    x = position * float(normal.std())
    assert law.cdf(x) == pytest.approx(float(normal.cdf(x)), abs=1e-10)
    assert law.central_probability(x) == pytest.approx(float(normal.central_probability(x)), abs=1e-10)
    assert law.mean_absolute() == pytest.approx(float(normal.mean_absolute()), rel=1e-9)
    assert law.std() == pytest.approx(float(normal.std()))
    scale = float(normal.std())
    if scale > 0 and abs(x) > 0:
        assert scale * law.pdf(x) == pytest.approx(scale * float(normal.pdf(x)), abs=1e-8)


# --- the words of scipy.stats -------------------------------------------------------------------------------


@each_law
def test_density_has_mass_one_and_the_cdf_is_its_integral(law):
    reach = float(law.ppf(1 - 1e-10) - law.ppf(1e-10))
    assert integral(law.pdf, -reach, reach, law) == pytest.approx(1, abs=1e-9)
    for q in (0.03, 0.5, 0.9):
        x = float(law.ppf(q))
        assert integral(law.pdf, -reach, x, law) == pytest.approx(q, abs=1e-9)
    assert integral(lambda x: abs(x) * law.pdf(x), -reach, reach, law) == pytest.approx(
        float(law.mean_absolute()), rel=1e-7
    )
    assert integral(lambda x: x * law.pdf(x), -reach, reach, law) == pytest.approx(
        float(law.mean()), abs=1e-6 * float(law.std())
    )
    assert integral(lambda x: x * x * law.pdf(x), -reach, reach, law) == pytest.approx(
        float(law.var() + law.mean() ** 2), rel=1e-5
    )


@each_law
def test_quantile_inverts_the_cdf(law):
    q = np.array([1e-8, 1e-3, 0.1, 0.5, 0.9, 1 - 1e-6])
    np.testing.assert_allclose(law.cdf(law.ppf(q)), q, atol=1e-11)
    low, high = law.interval(0.9)
    assert law.cdf(high) - law.cdf(low) == pytest.approx(0.9, abs=1e-10)
    np.testing.assert_array_equal(law.ppf([0, 1]), np.array(law.support()))


@each_law
def test_central_probability_is_the_cdfs(law):
    x = np.array([0.1, 0.7, 1.3, 3.0, 100.0]) * law.std()
    np.testing.assert_allclose(law.central_probability(x), law.cdf(x) - law.cdf(-x), atol=1e-10)
    np.testing.assert_array_equal(law.central_probability([-1.0, math.nan, 1e9]), [0, math.nan, 1])
    np.testing.assert_allclose(law.sf(x), 1 - law.cdf(x))
    np.testing.assert_array_equal(law.cdf([-1e9, 1e9]), [0, 1])


@each_law
def test_draws_follow_the_law(law):
    # Kolmogorov-Smirnov on 5000 draws, seed fixed; false alarm 1e-4 for each of the laws
    draws = law.rvs(5_000, random_state=20240613)
    assert stats.kstest(draws, law.cdf).pvalue > 1e-4


def test_laws_and_arguments_broadcast_element_by_element():
    ends = np.stack([END, END + 20.0, END - [3.0, 9.0, 50.0]])
    pitch = np.array([[0.00345, 0.00345], [0.0, 0.0]])[:, None]
    law = SegmentDisplacement.independent(START, ends, F, COVARIANCE).plus_quantization(pitch)
    for word in ("mean", "var", "std", "median", "mean_absolute", "rvs"):
        assert getattr(law, word)().shape == (2, 3), word
    assert law.reason.tolist() == [[""] * 3] * 2
    x = np.linspace(-0.05, 0.05, 5)[:, None, None]
    for word in ("pdf", "cdf", "sf", "central_probability"):
        assert getattr(law, word)(x).shape == (5, 2, 3), word
    assert law.ppf(np.array([0.1, 0.7])[:, None, None]).shape == (2, 2, 3)
    alone = SegmentDisplacement.independent(START, ends[1], F, COVARIANCE).plus_quantization(pitch[0, 0])
    np.testing.assert_array_equal(law.cdf(x)[:, 0, 1], alone.cdf(x[:, 0, 0]))
    assert law.mean_absolute()[0, 1] == alone.mean_absolute()


def test_no_error_at_all_is_a_step():
    law = SegmentDisplacement.independent(START, END, F, np.zeros((6, 6)))
    np.testing.assert_array_equal(law.cdf([-1e-12, 0.0, 1e-12]), [0, 1, 1])
    np.testing.assert_array_equal(law.central_probability([0.0, 1.0]), [1, 1])
    assert (law.mean(), law.var(), law.mean_absolute(), law.ppf(0.3)) == (0, 0, 0, 0)


# --- where the series has no answer -------------------------------------------------------------------------


def test_a_denominator_near_zero_is_reported_and_not_guessed():
    laws = IndependentTotalError(
        [NormalRatio(1.0, [0.0, 0.14, 0.142, 1.0, 1.0], 0.5, [1.0, 1, 1, 1, 0])], [1.0], 1.0, 0.3
    )
    assert laws.reason.tolist() == ["", "", *["denominator_near_zero"] * 3]
    for value in (laws.cdf(0.3), laws.pdf(0.3), laws.central_probability(0.3), laws.mean_absolute()):
        np.testing.assert_array_equal(np.isnan(value), [False, False, True, True, True])
    # a ratio that does not count does not matter
    assert IndependentTotalError([NormalRatio(1.0, 1.0, 0.5, 1.0)], [0.0], 1.0, 0.3).cdf(2.0) == 1
    assert IndependentTotalError([NormalRatio(0.0, 1.0, 0.5, 0.0)], [1.0], 1.0, 0.3).cdf(2.0) == 1


@pytest.mark.parametrize("eps", [0.125, 0.13, 0.14])
def test_a_series_that_does_not_converge_is_reported(eps):
    # fully correlated, one ratio, no pixels: the worst case; either right or told
    ratio = NormalRatio(1.0, eps, 1.0, 1.0)
    law = IndependentTotalError([ratio], [1.0], 0.0, 0.0)
    if law.reason == "":
        np.testing.assert_allclose(law.cdf([-3.0, 0.2, 2.0]), ratio.cdf([-3.0, 0.2, 2.0]), atol=1e-9)
    else:
        assert law.reason == "series_not_converged"
        assert np.isnan(law.cdf(0.3))


def test_the_compiled_cache_knows_the_files_it_inlines():
    # numba recompiles ratio_sum.py when that file changes; this line of it must change with the files it inlines
    folder = Path(ratio_sum.__file__).parents[1]
    inlined = ("joint/closed_form.py", "independent/ratio_series.py")
    text = "".join((folder / name).read_text(encoding="utf-8") for name in inlined)
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == ratio_sum._INLINED


# --- the joint model ----------------------------------------------------------------------------------------


@settings(max_examples=50, deadline=None)
@given(pose_covariances())
def test_joint_sigma_is_the_spread_of_the_drawn_length(covariance):
    # central differences of the length along the nominal direction over the six errors (steps 1e-3 mm, 1e-6 rad)
    law = SegmentDisplacement.joint(START, END, F, covariance)
    direction = np.array([math.cos(law.angle_rad), math.sin(law.angle_rad)])

    def length(twist):
        moved = [p + np.cross(twist[3:], p) + twist[:3] for p in (START, END)]
        images = [F * p[:2] / p[2] for p in moved]
        return direction @ (images[1] - images[0])

    steps = np.diag([1e-3] * 3 + [1e-6] * 3)
    slope = np.array([(length(s) - length(-s)) / (2 * s.max()) for s in steps])
    assert law.sigma_mm == pytest.approx(math.sqrt(max(slope @ covariance @ slope, 0)), rel=1e-6, abs=1e-9)


def test_joint_law_is_normal_and_far_narrower_than_the_independent_one():
    joint = SegmentDisplacement.joint(START, END, F, COVARIANCE)
    independent = SegmentDisplacement.independent(START, END, F, COVARIANCE)
    expected = stats.norm(scale=float(joint.sigma_mm))
    x = np.linspace(-3, 3, 7) * joint.sigma_mm
    np.testing.assert_allclose(joint.cdf(x), expected.cdf(x), atol=1e-15)
    np.testing.assert_allclose(joint.pdf(x), expected.pdf(x), rtol=1e-13)
    np.testing.assert_allclose(joint.ppf([0.01, 0.6]), expected.ppf([0.01, 0.6]), rtol=1e-12)
    assert (joint.mean(), joint.std(), joint.support()) == (0, joint.sigma_mm, (-math.inf, math.inf))
    assert stats.kstest(joint.rvs(20_000, random_state=3), expected.cdf).pvalue > 1e-4
    assert 13 < independent.std() / joint.std() < 25  # theory section 5
    total = TotalError.of(joint, 0.00345)
    assert isinstance(total, TotalError)
    assert total.std() == pytest.approx(math.hypot(joint.std(), TotalError(0.0, 0.00345, joint.angle_rad).std()))


@pytest.mark.parametrize("model", [SegmentDisplacement.joint, SegmentDisplacement.independent])
def test_segments_that_have_no_image_are_refused(model):
    with pytest.raises(vg.InputError, match="behind"):
        model(START, -END, F, COVARIANCE)
    with pytest.raises(vg.InputError, match="lens"):
        model(START, [1.0, 1.0, 0.0], F, COVARIANCE)


@pytest.mark.parametrize(("ratios", "weights"), [([], []), ([NormalRatio(1, 0.1, 0, 1)] * 5, [1] * 5), (SKEW, [1])])
def test_a_wrong_number_of_ratios_is_refused(ratios, weights):
    with pytest.raises(vg.InputError, match="one to four ratios"):
        IndependentTotalError(ratios, weights, 1.0, 0.3)
