"""The mean absolute error of arrays against the scalar code (1e-15), known laws and quadrature.

It claims 3e-12 of the standard deviation and reaches 1.3e-12, where both half-widths are 0.7 sigma.
"""

import hashlib
import math
import threading
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from test_closed_form import characteristic_function, fourier_integral, integrated_normal
from test_closed_form_array import ANGLES, LIMITS, SPREADS, SWITCHES, deviation_of, series_coefficients

from strategies import scales
from viewgauge.errors.joint import mean_absolute_array
from viewgauge.errors.joint.closed_form import mean_absolute
from viewgauge.errors.joint.mean_absolute_array import mean_absolute_into
from viewgauge.exceptions import InputError

CLAIMED = 3e-12


def mean(sigma, a, b):
    """E|error| by the array code, of anything that broadcasts."""
    arguments = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (sigma, a, b)))
    out = np.full(arguments[0].size, np.nan)
    mean_absolute_into(*(np.ascontiguousarray(v).ravel() for v in arguments), out)
    return out.reshape(arguments[0].shape)


@pytest.mark.parametrize(("sigma", "a", "b"), [(1.0, 0.69, 0.4), (0.5, 1.0, 0.6), (0.3, 1.0, 0.1), (0.05, 1.0, 1.0)])
def test_it_equals_quadrature_of_the_characteristic_function(sigma, a, b):
    def integrand(t):  # E|X| = 2/pi times the integral of (1 - cf(t)) / t²; at 0 that is half the variance
        if t == 0:
            return (sigma**2 + (a**2 + b**2) / 6) / 2
        return (1 - characteristic_function(t, sigma, a, b)) / t**2

    integral, end = fourier_integral(integrand, sigma)
    by_quadrature = 2 / mp.pi * (integral + mp.mpf(1) / end)
    assert mean(sigma, a, b) == pytest.approx(float(by_quadrature), abs=CLAIMED * deviation_of(sigma, a, b))


@pytest.mark.parametrize(
    ("sigma", "a", "b", "expected"),
    [
        (0.7, 0.0, 0.0, 0.7 * math.sqrt(2 / math.pi)),  # normal law
        (0.0, 0.6, 0.0, 0.2),  # triangular law: h / 3
        (0.0, 0.0, 0.6, 0.2),
        (0.0, 1.0, 1.0, 7 / 15),  # |sum of four uniforms - 2|
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_known_laws(sigma, a, b, expected):
    for unit in (1e-300, 1e-100, 1.0, 1e100, 1e300):
        assert mean(sigma * unit, a * unit, b * unit) / unit == pytest.approx(expected, abs=CLAIMED)


@pytest.mark.parametrize(("sigma", "a", "b"), SWITCHES + LIMITS + ANGLES)
def test_hard_points_equal_the_scalar_code(sigma, a, b):
    expected = pytest.approx(float(mean_absolute(sigma, a, b)), rel=0, abs=CLAIMED * deviation_of(sigma, a, b))
    assert mean(sigma, a, b) == expected
    assert mean(sigma, b, a) == expected


@settings(max_examples=1000, deadline=None)
@given(scales(), scales(), scales())
@example(1.0, 0.7, 0.7)
@example(1e-300, 1.0, 1e-7)
def test_it_equals_the_scalar_code(sigma, a, b):
    tolerance = CLAIMED * deviation_of(sigma, a, b)
    assert mean(sigma, a, b) == pytest.approx(float(mean_absolute(sigma, a, b)), rel=0, abs=tolerance)


def integrated_series(y, coefficients, order):
    """The series of a folded law at y, integrated ``order`` times; in units of its variance."""

    def derivative(n):  # of the standard normal law
        if n <= 0:
            return integrated_normal(mp.mpf(y), -n)
        hermite = mp.hermite(n - 1, y / mp.sqrt(2)) / mp.sqrt(2) ** (n - 1)
        return (-1) ** (n - 1) * hermite * mp.npdf(y)

    return sum(mp.mpf(c.numerator) / c.denominator * derivative(2 * k - order) for k, c in enumerate(coefficients))


def test_every_term_of_the_folded_series_counts():
    # half-widths so large that the series is no law any more, and that its last terms are no rounding
    a, b, wide = 1.5, 1.25, 1.75
    expected = 2 * integrated_series(0, series_coefficients(Fraction(a) ** 2, Fraction(b) ** 2), 1)
    by_both = mean_absolute_array._both_small(math.sqrt(1 - (a**2 + b**2) / 6), a, b)
    assert by_both == pytest.approx(float(expected), rel=1e-13)
    at = [integrated_series(y, series_coefficients(Fraction(a) ** 2, Fraction(0))[:8], 3) for y in (wide, 0, -wide)]
    by_narrow = mean_absolute_array._narrow_small(math.sqrt(1 - a**2 / 6), wide, a)
    assert by_narrow == pytest.approx(float(2 * (at[0] - 2 * at[1] + at[2]) / wide**2), rel=1e-13)


@pytest.mark.parametrize("spread", SPREADS)
def test_many_random_pairs_equal_the_scalar_code(spread):
    sigma, a, b = SPREADS[spread](np.random.default_rng(6), 50_000)
    unit = deviation_of(sigma, a, b)
    np.testing.assert_allclose(mean(sigma, a, b) / unit, mean_absolute(sigma, a, b) / unit, rtol=0, atol=CLAIMED)


def some_errors(n):
    """Errors of all three forms, in no order."""
    return 10 ** np.random.default_rng(7).uniform(-2, 1, (3, n))


@pytest.mark.parametrize("length", [1, 3, 8, 100, 1025])
def test_the_result_does_not_depend_on_the_cut_to_the_last_bit(length):
    errors = some_errors(3000)
    pieces = [mean(*errors[:, first : first + length]) for first in range(0, 3000, length)]
    np.testing.assert_array_equal(np.concatenate(pieces), mean(*errors))


def test_several_threads_at_once_give_the_same():
    errors = some_errors(50_000)
    out = np.full((8, 50_000), np.nan)
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda row: mean_absolute_into(*errors, row), out))
    np.testing.assert_array_equal(out, np.tile(mean(*errors), (8, 1)))


def test_other_threads_run_meanwhile():
    errors = some_errors(1_000_000)

    def half_done_is_seen():  # only a thread that runs during the call finds the first value and not the last
        out = np.full(1_000_000, np.nan)
        worker = threading.Thread(target=mean_absolute_into, args=(*errors, out))
        worker.start()
        seen = False
        while worker.is_alive():
            last, first = out[-1], out[0]
            seen = seen or (np.isnan(last) and not np.isnan(first))
        return seen

    assert any(half_done_is_seen() for _ in range(10))


@pytest.mark.parametrize("position", range(3))
def test_what_is_undefined_stays_so_and_spoils_no_neighbour(position):
    errors = some_errors(40)
    expected = mean(*errors)
    errors[position, 17] = expected[17] = np.nan
    np.testing.assert_array_equal(mean(*errors), expected)


@pytest.mark.parametrize("position", range(3))
def test_the_result_may_take_an_argument_s_place(position):
    errors = some_errors(300)
    expected = mean(*errors)
    mean_absolute_into(*errors, errors[position])
    np.testing.assert_array_equal(errors[position], expected)


def test_arguments_may_be_read_only():
    errors, out = some_errors(100), np.empty(100)
    errors.flags.writeable = False
    mean_absolute_into(*errors, out)
    np.testing.assert_array_equal(out, mean(*errors))


@pytest.mark.parametrize("short", range(4))
def test_arrays_of_different_lengths_are_refused(short):
    arrays = [np.ones(10 - (position == short)) for position in range(4)]
    with pytest.raises(InputError, match="one shape"):
        mean_absolute_into(*arrays)


def test_the_compiled_cache_knows_the_file_it_inlines():
    # numba recompiles mean_absolute_array.py when that file changes; this line of it must change with what it inlines
    text = (Path(mean_absolute_array.__file__).parent / "closed_form_array.py").read_text(encoding="utf-8")
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == mean_absolute_array._INLINED
