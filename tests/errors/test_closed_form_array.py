"""The array code against 60-digit sums, an inverted characteristic function and the scalar code.

It claims an absolute 1e-11 and reaches 5.1e-12, where both half-widths are 0.7 sigma: there the first cumulants left
out weigh most. The tests hold it to 1e-11 wherever the truth is known to more digits than that.
"""

import csv
import itertools
import math
import threading
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from test_closed_form import characteristic_function, fourier_integral, nine_terms

from strategies import positions, scales
from viewgauge.errors.joint import closed_form_array
from viewgauge.errors.joint.closed_form import central_probability
from viewgauge.errors.joint.closed_form_array import central_probability_into
from viewgauge.errors.quantization import quantization_half_widths
from viewgauge.exceptions import InputError

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT.parent / "shared" / "reference" / "quantization.csv"

CLAIMED = 1e-11
REACHED = 6e-12  # a term of the series that is wrong in the last of its digits that count shows here
ASKED = 1e-10  # of the properties: a sum or difference of two values


def central(x, sigma, a, b):
    """P(|error| <= x) by the array code, of anything that broadcasts."""
    arguments = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (x, sigma, a, b)))
    out = np.full(arguments[0].size, np.nan)
    central_probability_into(*(np.ascontiguousarray(v).ravel() for v in arguments), out)
    return out.reshape(arguments[0].shape)


def deviation_of(sigma, a, b):
    """Standard deviation of the error, without overflow."""
    return np.hypot(sigma, np.hypot(a, b) / math.sqrt(6))


def exact(x, sigma, a, b):
    """The nine-term sum with as many digits as it cancels, and 60 more."""
    if x < 0:
        return 0.0
    if sigma == a == b == 0:
        return 1.0
    if x > deviation_of(sigma, a, b) * 40:  # the sum would lose itself in digits: 1 - 1e-300
        return 1.0
    return float(1 - 2 * nine_terms(-x, sigma, a, b, 0))


# (a) Hard points: every border between two forms from both sides, every limit, every kink, every unit.

BELOW, ABOVE = 1 - 1e-12, 1 + 1e-12
SWITCHES = [
    (1.0, 0.7 * p, 0.7 * q * ratio) for p in (BELOW, ABOVE) for q in (BELOW, ABOVE) for ratio in (1.0, 0.5, 1e-3)
]
SWITCHES += [(1.0, 5.0, 0.7 * q) for q in (BELOW, ABOVE)]
SWITCHES += [(sigma, 1.0, 1e-7 * q) for q in (BELOW, ABOVE) for sigma in (0.0, 1e-9, 1e-7, 1.3e-7, 1e-6)]
LIMITS = [
    (1.0, 1e-3, 1e-8),
    (1.0, 0.0, 0.0),
    (1.0, 0.5, 0.0),
    (1.0, 3.0, 1e-12),
    (1e-3, 1.0, 1e-9),
    (1e-300, 1.0, 0.6),
    (0.0, 1.0, 0.0),
    (0.0, 1.0, 1e-300),
    (0.0, 1.0, 1e-6),
    (0.0, 1.0, 0.6),
    (0.0, 1.0, 1.0),
    (1e-7, 1.0, 1.0),
    (1e-6, 1.0, 0.9997),
    (0.05, 1.0, 1.0),
    (0.69, 1.0, 1.0),
    (1e9, 1.0, 1.0),
]
DEGREES = (0.0, 1e-9, 1e-4, 30.0, 45.0, 90 - 1e-6)
ANGLES = [
    (sigma, math.cos(math.radians(g)), math.sin(math.radians(g))) for g in DEGREES for sigma in (0.0, 0.01, 0.5, 2.0)
]


def positions_of(sigma, a, b):
    """The centre, the bulk, the kinks of the quantization error, where the tail is cut off."""
    s = deviation_of(sigma, a, b)
    return (0.0, 1e-9 * s, 0.4 * s, 1.3 * s, abs(a - b), a + b, a + b + 7.4999 * sigma, 30 * s)


@pytest.mark.parametrize(("sigma", "a", "b"), SWITCHES + LIMITS + ANGLES)
def test_hard_points_equal_the_sum_in_high_precision(sigma, a, b):
    for x in positions_of(sigma, a, b):
        truth = exact(x, sigma, a, b)
        assert central(x, sigma, a, b) == pytest.approx(truth, abs=CLAIMED)
        assert central(x, sigma, b, a) == pytest.approx(truth, abs=CLAIMED)


@pytest.mark.parametrize("unit", [1e-300, 1e-100, 1e-9, 1e9, 1e100, 1e300])
@pytest.mark.parametrize("parameters", [(1.0, 0.3, 0.2), (1.0, 3.0, 0.2), (0.2, 1.0, 0.9), (0.0, 1.0, 0.4)])
def test_any_unit_will_do(parameters, unit):
    for x in positions_of(*parameters):
        truth = exact(x, *parameters)
        assert central(x * unit, *(p * unit for p in parameters)) == pytest.approx(truth, abs=CLAIMED)


@pytest.mark.parametrize(("sigma", "a", "b"), [(1.0, 0.3, 0.4), (0.5, 1.0, 0.6), (0.3, 1.0, 0.1), (0.05, 1.0, 1.0)])
def test_it_equals_the_inverted_characteristic_function(sigma, a, b):
    for x in (0.3, 0.9, 1.7):
        integral, _ = fourier_integral(
            lambda t, x=x: x * mp.sinc(t * x) * characteristic_function(t, sigma, a, b), sigma
        )
        assert central(x, sigma, a, b) == pytest.approx(float(2 * integral / mp.pi), abs=CLAIMED)


def test_the_error_is_within_the_reach_of_its_parts_and_never_negative():
    for sigma, a, b in SWITCHES + LIMITS + ANGLES:
        reach = a + b + 40 * sigma
        np.testing.assert_array_equal(central([-np.inf, -1e300, -1.0, -1e-300], sigma, a, b), 0.0)
        np.testing.assert_array_equal(central([reach, 1e300, np.inf], sigma, a, b), 1.0)


def test_without_any_error_the_law_is_a_step():
    np.testing.assert_array_equal(central([-1e-300, -0.0, 0.0, 1e-300, 1.0], 0.0, 0.0, 0.0), [0, 1, 1, 1, 1])


@pytest.mark.parametrize("position", range(4))
def test_what_is_undefined_stays_so_and_spoils_no_neighbour(position):
    arguments = np.tile([[1.0], [0.5], [0.3], [0.9]], 40)
    expected = central(*arguments)
    arguments[position, 17] = expected[17] = np.nan
    np.testing.assert_array_equal(central(*arguments), expected)


def test_it_equals_the_reference_table_at_every_angle():
    # Source: quantization.csv, exact piecewise polynomials in 80 digits, without displacement.
    if not REFERENCE.exists():
        pytest.skip("reference values (quantization.csv) are not beside this checkout")
    with REFERENCE.open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    pitch = np.array([[row["pixel_width"], row["pixel_height"]] for row in rows])
    a, b = quantization_half_widths(pitch, np.array([row["angle_rad"] for row in rows]))
    x = np.array([row["error"] for row in rows])
    expected = 1 - 2 * np.array([row["cdf"] if row["error"] < 0 else 1 - row["cdf"] for row in rows])
    assert len(rows) >= 500
    np.testing.assert_allclose(central(np.abs(x), 0.0, a, b), expected, rtol=0, atol=CLAIMED)


# (b) Properties, against the scalar code (1e-15).


@settings(max_examples=1000, deadline=None)
@given(positions(), scales(), scales(), scales())
@example(0.39, 1.0, 0.7, 0.7)
@example(1.0, 1e-300, 1.0, 1e-7)
def test_it_equals_the_scalar_code(position, sigma, a, b):
    x = position * deviation_of(sigma, a, b)
    assert central(x, sigma, a, b) == pytest.approx(float(central_probability(x, sigma, a, b)), abs=ASKED)


@settings(max_examples=500, deadline=None)
@given(positions(), scales(), scales(), scales(), st.sampled_from([1e-200, 1e-3, 7.0, 1e200]))
def test_it_is_a_probability_that_knows_ratios_only_and_no_order(position, sigma, a, b, unit):
    x = abs(position) * deviation_of(sigma, a, b)
    value = central(x, sigma, a, b)
    assert 0 <= value <= 1
    assert central(x, sigma, b, a) == value
    if min(v for v in (sigma, a, b, 1.0) if v > 0) > 1e-100:  # else the unit takes it out of the numbers' range
        assert central(x * unit, sigma * unit, a * unit, b * unit) == pytest.approx(float(value), abs=ASKED)


@settings(max_examples=500, deadline=None)
@given(positions(), st.floats(0.0, 4.0), scales(), scales(), scales())
def test_it_grows_with_what_is_allowed(position, more, sigma, a, b):
    x = abs(position) * deviation_of(sigma, a, b)
    assert central(x * (1 + more), sigma, a, b) >= central(x, sigma, a, b) - ASKED


SPREADS = {
    "anything": lambda rng, n: 10 ** rng.uniform(-9, 9, (3, n)),
    "of one size": lambda rng, n: 10 ** rng.uniform(-1, 1, (3, n)),
    "about the first switch": lambda rng, n: np.array([np.ones(n), *(0.7 + rng.normal(0, 0.01, (2, n)))]),
    "hardly any displacement": lambda rng, n: np.array(
        [10 ** rng.uniform(-20, -4, n), np.ones(n), 10 ** rng.uniform(-9, 0, n)]
    ),
    "no displacement": lambda rng, n: np.array([np.zeros(n), np.ones(n), 10 ** rng.uniform(-9, 0, n)]),
    "one axis": lambda rng, n: np.array([10 ** rng.uniform(-9, 3, n), np.ones(n), np.zeros(n)]),
}


@pytest.mark.parametrize("spread", SPREADS)
def test_many_random_pairs_equal_the_scalar_code(spread):
    rng, n = np.random.default_rng(5), 50_000
    sigma, a, b = SPREADS[spread](rng, n)
    bulk = rng.uniform(0, 10, n) * rng.choice([0.1, 0.3, 1.0], n) * deviation_of(sigma, a, b)
    kinks = np.abs(rng.integers(-1, 2, n) * a + rng.integers(-1, 2, n) * b + rng.choice([0, 7.5, 9, -9], n) * sigma)
    for x in (bulk, kinks, kinks * (1 + rng.normal(0, 1e-6, n))):
        np.testing.assert_allclose(central(x, sigma, a, b), central_probability(x, sigma, a, b), rtol=0, atol=REACHED)


# (c) The constants, made anew.


def interpolated(function, degree):
    """Powers' coefficients of the interpolant in the zeros of the Chebyshev polynomial, 50 digits."""
    with mp.workdps(50):
        nodes = [mp.cos(mp.pi * (2 * k + 1) / (2 * degree + 2)) for k in range(degree + 1)]
        powers = mp.matrix([[t**j for j in range(degree + 1)] for t in nodes])
        return [float(c) for c in mp.lu_solve(powers, mp.matrix([function(t) for t in nodes]))]


def mills_ratio(z):
    with mp.workdps(50):
        return mp.ncdf(-mp.mpf(z)) / mp.npdf(mp.mpf(z))


def test_the_polynomials_are_the_interpolants():
    mills = interpolated(lambda t: mills_ratio(mp.mpf(104) / 9 / (mp.mpf(17) / 9 - t) - 4), 16)
    root_exp = interpolated(lambda t: mp.exp(mp.mpf(81) / 256 * (t - 1)), 10)
    np.testing.assert_allclose(closed_form_array._MILLS, mills, rtol=0, atol=1e-15 * max(mills))
    np.testing.assert_allclose(closed_form_array._ROOT_EXP, root_exp, rtol=0, atol=1e-15 * max(root_exp))


def test_the_normal_law_is_as_accurate_as_claimed():
    for z in np.linspace(0.0, 9.0, 361):
        density, ratio = closed_form_array._normal(z)
        assert density == pytest.approx(float(mp.npdf(mp.mpf(z))), rel=4e-14, abs=0)
        assert ratio == pytest.approx(float(mills_ratio(z)), rel=4e-14, abs=0)


def triangular_cumulants(count):
    """kappa_1 … of a triangular law of half-width 1, by definition from its moments 2 / ((n+1)(n+2)), n even."""
    moments = [Fraction(2, (n + 1) * (n + 2)) if n % 2 == 0 else Fraction(0) for n in range(count + 1)]
    cumulants = [Fraction(0)]
    for n in range(1, count + 1):
        rest = sum(math.comb(n - 1, m - 1) * cumulants[m] * moments[n - m] for m in range(1, n))
        cumulants.append(moments[n] - rest)
    return cumulants


def test_the_cumulants_are_those_of_a_triangular_law():
    cumulants = triangular_cumulants(16)
    assert cumulants[2] == Fraction(1, 6)
    for k in range(2, 9):
        constant = getattr(closed_form_array, f"_K{k}")
        assert constant == pytest.approx(float(cumulants[2 * k] / math.factorial(2 * k)), rel=1e-15, abs=0)


def series_coefficients(u, v):
    """C_0 … C_8 of the exponential of the cumulants from the fourth on; u, v squares of the half-widths."""
    cumulants = triangular_cumulants(16)
    exponent = [Fraction(0)] * 2
    exponent += [cumulants[2 * k] / math.factorial(2 * k) * (u**k + v**k) for k in range(2, 9)]
    series = [Fraction(1)]  # n C_n = sum of m q_m C_(n-m)
    for n in range(1, 9):
        series.append(sum(m * exponent[m] * series[n - m] for m in range(1, n + 1)) / n)
    return series


def test_the_series_coefficients_are_those_of_the_exponential_of_the_cumulants():
    u, v = Fraction(2, 5), Fraction(1, 7)
    expected = [float(c) for c in series_coefficients(u, v)[2:]]
    assert closed_form_array._coefficients(float(u), float(v)) == pytest.approx(expected, rel=1e-13, abs=0)


# (d) Pieces, neighbours, threads.


def some_pairs(n):
    """Pairs of all three forms and of none, in no order."""
    rng = np.random.default_rng(7)
    a, b = quantization_half_widths(np.ones(2), rng.uniform(0, math.pi, n))
    sigma = 10 ** rng.uniform(-3, 1, n)
    x = rng.uniform(-0.2, 4, n) * deviation_of(sigma, a, b)
    return np.array([x, sigma, a, b])


@pytest.mark.parametrize("length", [1, 2, 3, 7, 31, 32, 33, 100, 1023, 1024, 1025, 4000])
def test_the_result_does_not_depend_on_the_cut_to_the_last_bit(length):
    pairs = some_pairs(5000)
    pieces = [central(*pairs[:, first : first + length]) for first in range(0, 5000, length)]
    np.testing.assert_array_equal(np.concatenate(pieces), central(*pairs))


def test_the_result_does_not_depend_on_the_order_to_the_last_bit():
    pairs, order = some_pairs(5000), np.random.default_rng(8).permutation(5000)
    np.testing.assert_array_equal(central(*pairs[:, order]), central(*pairs)[order])


def test_several_threads_at_once_give_the_same():
    pairs = some_pairs(100_000)
    expected, out = central(*pairs), np.full((8, 100_000), np.nan)
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda row: central_probability_into(*pairs, row), out))
    np.testing.assert_array_equal(out, np.tile(expected, (8, 1)))


def test_other_threads_run_meanwhile():
    pairs = some_pairs(1_000_000)

    def half_done_is_seen():  # only a thread that runs during the call finds the first value and not the last
        out = np.full(1_000_000, np.nan)
        worker = threading.Thread(target=central_probability_into, args=(*pairs, out))
        worker.start()
        seen = False
        while worker.is_alive():
            last, first = out[-1], out[0]
            seen = seen or (np.isnan(last) and not np.isnan(first))
        return seen

    assert any(half_done_is_seen() for _ in range(10))


@pytest.mark.parametrize("position", range(4))
def test_the_result_may_take_an_argument_s_place(position):
    pairs = some_pairs(3000)
    expected = central(*pairs)
    central_probability_into(*pairs, pairs[position])
    np.testing.assert_array_equal(pairs[position], expected)


def test_arguments_may_be_read_only():
    pairs, out = some_pairs(100), np.empty(100)
    pairs.flags.writeable = False
    central_probability_into(*pairs, out)
    np.testing.assert_array_equal(out, central(*pairs))


@pytest.mark.parametrize("short", range(5))
def test_arrays_of_different_lengths_are_refused(short):
    arrays = [np.ones(10 - (position == short)) for position in range(5)]
    with pytest.raises(InputError, match="one shape"):
        central_probability_into(*arrays)


def test_no_pairs_give_no_values():
    assert central(*np.empty((4, 0))).shape == (0,)


def test_every_form_is_among_the_hard_points():
    forms = set()
    for sigma, a, b in itertools.chain(SWITCHES, LIMITS, ANGLES):
        wide, narrow = max(a, b), min(a, b)
        forms.add((wide > 0.7 * sigma) + (wide > 0.7 * sigma and narrow > 0.7 * sigma and narrow > 1e-7 * wide))
    assert forms == {0, 1, 2}
