"""The closed form against 60-digit evaluation of the plain nine-term sum, quadrature and known limits."""

import csv
import math
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy import stats

from strategies import positions, scales
from viewgauge.errors import SpatialQuantization
from viewgauge.errors.joint.closed_form import central_probability, mean_absolute, total_cdf, total_pdf

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT.parent / "shared" / "reference" / "quantization.csv"

# The code rounds some tens of sums of order one: measured 3.5e-15 (cdf) and 1.2e-14 of the peak (pdf) at most.
ROUNDING = 1e-13


def integrated_normal(z, order):
    """The standard normal law integrated ``order`` times (theory section 6 has order 4), -1: its density."""
    if abs(z) > 1000:  # the density is below 10 to the -217000
        P, p = mp.mpf(z > 0), mp.mpf(0)
    else:
        P, p = mp.ncdf(z), mp.npdf(z)
    return {
        -1: p,
        0: P,
        1: z * P + p,
        2: ((z**2 + 1) * P + z * p) / 2,
        3: ((z**3 + 3 * z) * P + (z**2 + 2) * p) / 6,
        4: ((z**4 + 6 * z**2 + 3) * P + (z**3 + 5 * z) * p) / 24,
    }[order]


def integrated_step(y, order):
    """The law without spread, integrated ``order`` times."""
    return y**order / mp.factorial(order) if y > 0 or order == 0 == y else mp.mpf(0)


def nine_terms(x, sigma, a, b, order):
    """pdf (order -1) or cdf (order 0) as printed in theory section 6, with the digits that cancel added to 60."""
    widths = [h for h in (a, b) if h > 0]
    sizes = [math.log10(h) for h in (sigma, a, b) if h > 0]
    widest = max(*sizes, math.log10(abs(x))) if x != 0 and len(sizes) > 0 else max(sizes)
    cancelled = int(5 * (widest - min(sizes)))
    with mp.workdps(60 + cancelled):
        x, sigma = mp.mpf(x), mp.mpf(sigma)
        terms = [(mp.mpf(0), mp.mpf(1))]
        for h in map(mp.mpf, widths):
            terms = [(t + i * h, c * w / h**2) for t, c in terms for i, w in ((-1, 1), (0, -2), (1, 1))]
        m = order + 2 * len(widths)
        if sigma > 0:
            return sum(c * sigma**m * integrated_normal((x + t) / sigma, m) for t, c in terms)
        return sum(c * integrated_step(x + t, m) for t, c in terms)


def characteristic_function(t, sigma, a, b):
    """Of a normal variable plus four uniform ones of widths a, a, b, b."""
    return mp.exp(-((sigma * t) ** 2) / 2) * (mp.sinc(a * t / 2) * mp.sinc(b * t / 2)) ** 2


def fourier_integral(integrand, sigma):
    """From 0 to where the characteristic function is below 1e-17 (widths of order one, or sigma > 0)."""
    end = 10 / sigma if sigma > 0 else 2000
    with mp.workdps(20):
        return mp.quad(integrand, mp.linspace(0, end, 2 + int(end / 10))), end


@settings(max_examples=300, deadline=None)
@given(positions(), scales(), scales(), scales())
@example(-1.0, 1.0, 1e-300, 1e12)
@example(-0.5, 1e-300, 1.0, 1.0)
@example(0.0, 1.0, 1e-50, 1e30)
@example(-3.0, 1.0, 1.0, 0.0)
def test_cdf_and_pdf_equal_the_nine_terms_in_high_precision(position, sigma, a, b):
    assume(sigma > 0 or (a > 0 and b > 0))  # else the density has a kink or none: tested below
    x = position * math.sqrt(sigma**2 + (a**2 + b**2) / 6)
    peak = float(nine_terms(0.0, sigma, a, b, -1))
    assert total_cdf(x, sigma, a, b) == pytest.approx(float(nine_terms(x, sigma, a, b, 0)), abs=ROUNDING)
    assert total_pdf(x, sigma, a, b) == pytest.approx(float(nine_terms(x, sigma, a, b, -1)), abs=ROUNDING * peak)


@pytest.mark.parametrize("sigma", [0.0, 1e-6, 0.01, 0.3])
@pytest.mark.parametrize(("a", "b"), [(1.0, 0.4), (1.0, 1.0), (0.2, 1.0), (1.0, 1e-7)])
def test_the_kinks_are_right(sigma, a, b):
    for x in (-a - b, -a, -b, -abs(a - b), 0.0, abs(a - b), b, a, a + b):
        for at in (np.nextafter(x, -9), x, np.nextafter(x, 9)):
            assert total_cdf(at, sigma, a, b) == pytest.approx(float(nine_terms(at, sigma, a, b, 0)), abs=ROUNDING)


SMOOTH = [(1.0, 0.3, 0.4), (0.5, 1.0, 0.6), (0.3, 1.0, 0.1), (2.0, 1.0, 3.0), (0.05, 1.0, 1.0)]


@pytest.mark.parametrize(("sigma", "a", "b"), SMOOTH)
def test_cdf_equals_the_inverted_characteristic_function(sigma, a, b):
    for x in (-1.7, -0.4, 0.0, 0.9):
        integral, _ = fourier_integral(
            lambda t, x=x: x * mp.sinc(t * x) * characteristic_function(t, sigma, a, b), sigma
        )
        assert total_cdf(x, sigma, a, b) == pytest.approx(0.5 + float(integral / mp.pi), abs=ROUNDING)


@pytest.mark.parametrize(("sigma", "a", "b"), [*SMOOTH, (0.0, 1.0, 0.7)])
def test_mean_absolute_error_equals_quadrature(sigma, a, b):
    def integrand(t):  # E|X| = 2/pi times the integral of (1 - cf(t)) / t²; at 0 that is half the variance
        if t == 0:
            return (sigma**2 + (a**2 + b**2) / 6) / 2
        return (1 - characteristic_function(t, sigma, a, b)) / t**2

    integral, end = fourier_integral(integrand, sigma)
    by_quadrature = 2 / mp.pi * (integral + mp.mpf(1) / end)
    assert mean_absolute(sigma, a, b) == pytest.approx(float(by_quadrature), rel=ROUNDING)


@pytest.mark.parametrize(
    ("sigma", "a", "b", "expected"),
    [
        (0.7, 0.0, 0.0, 0.7 * math.sqrt(2 / math.pi)),  # normal law
        (0.0, 0.6, 0.0, 0.2),  # triangular law: h / 3
        (0.0, 0.0, 0.6, 0.2),
        (0.0, 1.0, 1.0, 7 / 15),  # |sum of four uniforms - 2| (Irwin-Hall): 7/15
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_mean_absolute_error_of_known_laws(sigma, a, b, expected):
    assert mean_absolute(sigma, a, b) == pytest.approx(expected, rel=1e-14)


@pytest.fixture(scope="module")
def reference():
    if not REFERENCE.exists():
        pytest.skip("reference values (quantization.csv) are not beside this checkout")
    with REFERENCE.open() as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_quantization_equals_the_reference_table_at_every_angle(reference):
    # Source: quantization.csv, exact piecewise polynomials in 80 digits. Tolerance: what issue 2 asks for.
    pitch = np.stack([reference["pixel_width"], reference["pixel_height"]], axis=-1)
    law = SpatialQuantization(pitch, reference["angle_rad"])
    assert len(reference["cdf"]) >= 500
    np.testing.assert_allclose(law.cdf(reference["error"]), reference["cdf"], rtol=0, atol=1e-12)
    deviation = (law.pdf(reference["error"]) - reference["pdf"]) / law.pdf(0.0)
    assert np.abs(deviation).max() <= 1e-12


X = np.linspace(-3, 3, 61)


def test_without_pixels_the_law_is_normal():
    for sigma in (1e-300, 0.2, 1.0, 1e300):
        np.testing.assert_allclose(total_cdf(X * sigma, sigma, 0, 0), stats.norm.cdf(X), atol=1e-15)
        np.testing.assert_allclose(total_pdf(X * sigma, sigma, 0, 0) * sigma, stats.norm.pdf(X), atol=1e-15)


@pytest.mark.parametrize(("a", "b"), [(0.8, 0.0), (0.0, 0.8), (0.8, 1e-300), (1e-200, 0.8)])
@pytest.mark.parametrize("sigma", [0.0, 1e-300, 1e-20])
def test_along_a_pixel_axis_without_displacement_the_law_is_one_triangle(a, b, sigma):
    triangle = stats.triang(0.5, loc=-0.8, scale=1.6)
    np.testing.assert_allclose(total_cdf(X, sigma, a, b), triangle.cdf(X), atol=1e-15)
    np.testing.assert_allclose(total_pdf(X, sigma, a, b), triangle.pdf(X), atol=1e-15)


def test_without_any_error_the_law_is_a_step():
    np.testing.assert_array_equal(total_cdf([-1e-300, 0.0, 1e-300], 0, 0, 0), [0, 1, 1])
    np.testing.assert_array_equal(total_pdf([-1e-300, 0.0, 1e-300], 0, 0, 0), [0, np.inf, 0])
    np.testing.assert_array_equal(central_probability([-1.0, 0.0, 1.0], 0, 0, 0), [0, 1, 1])


@pytest.mark.parametrize("small", [1e-3, 1e-5, 1e-8, 1e-40, 1e-300])
@pytest.mark.parametrize("others", [(1.0, 0.5), (0.5, 1.0), (1.0, 1.0)])
def test_a_vanishing_part_leaves_the_law_of_the_others(small, others):
    # a part of variance v moves a cdf by at most v/2 times the largest slope of its density (here below 5)
    p, q = others
    for with_part, without in (
        ((small, p, q), (0.0, p, q)),
        ((p, small, q), (p, 0.0, q)),
        ((p, q, small), (p, q, 0.0)),
    ):
        moved = np.abs(total_cdf(X, *with_part) - total_cdf(X, *without)).max()
        assert moved <= 2.5 * small**2 + ROUNDING


@pytest.mark.parametrize("b", [0.0, 1e-8, 0.3, 0.49999, 0.5])
def test_nothing_jumps_where_the_series_takes_over_from_the_differences(b):
    below, above = np.nextafter(0.5, 0), np.nextafter(0.5, 1)
    for law in (total_cdf, total_pdf):
        for at, then in (((below, b), (above, b)), ((b, below), (b, above)), ((2.0, below), (2.0, above))):
            np.testing.assert_allclose(law(X, 1.0, *then), law(X, 1.0, *at), rtol=0, atol=ROUNDING)


@pytest.mark.parametrize(("a", "b"), [(0.0, 0.0), (0.3, 0.2), (0.7, 0.0), (2.0, 1.0), (50.0, 0.1), (50.0, 20.0)])
def test_nothing_jumps_where_the_normal_tail_ends(a, b):
    kinks = np.array([i * a + j * b for i in (-1, 0, 1) for j in (-1, 0, 1)])
    ends = np.concatenate([kinks - 9.0, kinks + 9.0])
    for law in (total_cdf, total_pdf, central_probability):
        before, after = law(ends - 1e-12, 1.0, a, b), law(ends + 1e-12, 1.0, a, b)
        np.testing.assert_allclose(after, before, rtol=0, atol=2e-12 + ROUNDING)  # the densities are below 1


@settings(max_examples=200, deadline=None)
@given(positions(), scales(), scales(), scales(), st.sampled_from([1e-200, 1e-3, 1e200]))
def test_only_ratios_matter_and_widths_can_be_swapped(position, sigma, a, b, unit):
    assume(all(value == 0 or 1e-20 < value < 1e20 for value in (sigma, a, b)))
    x = position * math.sqrt(sigma**2 + (a**2 + b**2) / 6)
    value = total_cdf(x, sigma, a, b)
    assert total_cdf(x, sigma, b, a) == value
    assert total_cdf(x * unit, sigma * unit, a * unit, b * unit) == pytest.approx(float(value), abs=ROUNDING)


@settings(max_examples=300, deadline=None)
@given(positions(), scales(), scales(), scales())
@example(0.0, 1e-3, 5.0, 0.0)
@example(0.0, 1.0, 1.3, 0.4)
def test_the_law_is_a_symmetric_probability_whatever_the_ratios(position, sigma, a, b):
    x = abs(position) * math.sqrt(sigma**2 + (a**2 + b**2) / 6)
    low, high, central = total_cdf(-x, sigma, a, b), total_cdf(x, sigma, a, b), central_probability(x, sigma, a, b)
    assert 0 <= low <= high + ROUNDING
    assert high <= 1
    assert 0 <= central <= 1
    assert total_pdf(x, sigma, a, b) >= 0
    assert total_pdf(x, sigma, a, b) == total_pdf(-x, sigma, a, b)
    no_error = sigma == a == b == 0
    assert central == (1 if no_error else pytest.approx(float(high - low), abs=ROUNDING))
    if not (no_error and x == 0):
        assert low + high == pytest.approx(1, abs=ROUNDING)
    assert central_probability(2 * x, sigma, a, b) >= central - ROUNDING
    assert np.isfinite(mean_absolute(sigma, a, b))


def test_infinite_and_undefined_arguments():
    for parameters in ((0, 0, 0), (1, 0, 0), (1, 0.1, 0.2), (0.1, 1, 1), (0, 1, 1)):
        np.testing.assert_array_equal(total_cdf([-np.inf, np.inf], *parameters), [0, 1])
        np.testing.assert_array_equal(total_pdf([-np.inf, np.inf], *parameters), [0, 0])
        assert central_probability(np.inf, *parameters) == 1
        assert np.isnan(total_cdf(np.nan, *parameters))
