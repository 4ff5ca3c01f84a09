"""Quantities with units."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.exceptions import InputError
from viewgauge.formats.files.units import ANGLE, LENGTH, PIXELS, RATIO, parse_quantities, parse_quantity

# exact by definition: SI prefixes; the inch is 25.4 mm (international yard and pound agreement, 1959)
EXACT_MM = {
    "mm": Fraction(1),
    "um": Fraction(1, 1000),
    "µm": Fraction(1, 1000),
    "micron": Fraction(1, 1000),
    "nm": Fraction(1, 10**6),
    "cm": Fraction(10),
    "m": Fraction(1000),
    "in": Fraction(254, 10),
    "inch": Fraction(254, 10),
    "inches": Fraction(254, 10),
    "ft": Fraction(3048, 10),
    "thou": Fraction(254, 10000),
}


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("16 mm", LENGTH, 16.0),
        ("3.45 um", LENGTH, 0.00345),
        ("3.45um", LENGTH, 0.00345),
        ("3.45 μm", LENGTH, 0.00345),
        ("1.5 inch", LENGTH, 38.1),
        ("-2e-1 cm", LENGTH, -2.0),
        (".5 millimetre", LENGTH, 0.5),
        ("20 px", PIXELS, 20.0),
        ("0.1 pixel", PIXELS, 0.1),
        ("10 %", RATIO, 0.1),
        ("0.1", RATIO, 0.1),
        (0.1, RATIO, 0.1),
        (1, RATIO, 1.0),
        ("500 ppm", RATIO, 0.0005),
        ("2 mrad", ANGLE, 0.002),
        ("-3 rad", ANGLE, -3.0),
    ],
)
def test_exact_values(text, kind, expected):
    assert parse_quantity(text, kind) == expected


@pytest.mark.parametrize(
    ("text", "degrees"), [("0.02 deg", 0.02), ("2 °", 2.0), ("180 degrees", 180), ("6 arcmin", 0.1)]
)
def test_angles_are_within_one_rounding_of_the_true_value(text, degrees):
    assert parse_quantity(text, ANGLE) == pytest.approx(math.radians(degrees), rel=4 * np.finfo(float).eps)


@pytest.mark.parametrize(
    ("value", "kind", "problem", "expected"),
    [
        (16, LENGTH, "the unit is missing", "a length with its unit, such as 16 mm"),
        ("16", LENGTH, "the unit is missing", "a length with its unit"),
        (0, LENGTH, "the unit is missing", "a length with its unit"),
        ("16 s", LENGTH, "'s' is not a unit of length", "a length with its unit"),
        ("3 deg", LENGTH, "'deg' is not a unit of length", "a length with its unit"),
        ("3 px", LENGTH, "'px' is not a unit of length", "a length with its unit"),
        ("5 min", LENGTH, "'min' is not a unit of length", "a length with its unit"),
        ("16 ms", LENGTH, "'ms' is not a unit of length", "a length with its unit"),
        ("3 mm", ANGLE, "'mm' is not a unit of angle", "an angle with its unit, such as 0.02 deg"),
        ("10 %", ANGLE, "'%' is not a unit of angle", "an angle"),
        ("3 mm", PIXELS, "'mm' is not a unit of number of pixels", "1 px"),
        ("0.1 mm", RATIO, "'mm' makes no ratio", "a ratio, such as 10 % or 0.1"),
        ("1 deg", RATIO, "'deg' makes no ratio", "a ratio"),
        ("3 mm*mm", LENGTH, "'mm*mm' is not a unit of length", "a length"),
        ("3 mm**9**9**9", LENGTH, "is not a unit of length", "a length"),
        ("1/2 inch", LENGTH, "'/2 inch' is not a unit", "a length"),
        ("mm", LENGTH, "does not begin with a number", "a length"),
        ("", LENGTH, "does not begin with a number", "a length"),
        ("1.2.3 mm", LENGTH, "does not begin with a number", "a length"),
        ("nan mm", LENGTH, "not finite", "a length"),
        ("inf mm", LENGTH, "not finite", "a length"),
        ("-.inf mm", LENGTH, "not finite", "a length"),
        ("1e999 mm", LENGTH, "too large", "a length"),
        ("1e10 mm", LENGTH, "too large", "a length"),
        ("1e-320 mm", LENGTH, "too small", "a length"),
        ("9" * 400 + " mm", LENGTH, "too large", "a length"),
        ("1e308 m", LENGTH, "too large", "a length"),
        (math.nan, RATIO, "not finite", "a ratio"),
        (None, LENGTH, "no value", "a length"),
        (True, RATIO, "not a quantity", "a ratio"),
        ({"a": 1}, LENGTH, "not a quantity", "a length"),
        (["1 mm"], LENGTH, "not a quantity", "a length"),
    ],
)
def test_what_cannot_be_read_says_what_was_expected(value, kind, problem, expected):
    with pytest.raises(InputError) as caught:
        parse_quantity(value, kind)
    assert problem in caught.value.problem
    assert expected in caught.value.expected


@pytest.mark.parametrize(("value", "hint"), [("16 MM", "did you mean 'mm'?"), ("1,5 mm", "decimal point")])
def test_common_slips_get_a_hint(value, hint):
    with pytest.raises(InputError) as caught:
        parse_quantity(value, LENGTH)
    assert hint in caught.value.hint


@pytest.mark.parametrize(
    ("value", "sign", "problem"),
    [
        ("0 mm", "positive", "must be positive"),
        ("-1 mm", "positive", "must be positive"),
        ("1e-999999999999999999999 mm", "positive", "must be positive"),
        ("-1 um", "not negative", "must not be negative"),
    ],
)
def test_wrong_sign(value, sign, problem):
    with pytest.raises(InputError, match=problem):
        parse_quantity(value, LENGTH, sign)


@pytest.mark.parametrize(
    "value",
    ["[0, 0, 40] mm", "[0 mm, 0 mm, 40 mm]", ["0 mm", "0 mm", "40 mm"], ["0 um", "0 inch", "4 cm"], "[0,0,4]cm"],
)
def test_forms_of_a_vector(value):
    assert parse_quantities(value, LENGTH, (3,)) == (0.0, 0.0, 40.0)


def test_one_or_three():
    assert parse_quantities("2 mm", LENGTH, (1, 3)) == (2.0,)
    assert parse_quantities("[1, 2, 3] mm", LENGTH, (1, 3)) == (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ("[1, 2] mm", "3 values are expected here, not 2"),
        ("[] mm", "not 0"),
        ("16 mm", "3 values are expected here"),
        ([0, 0, 40], "the unit is missing"),
        (["0 mm", 0, "1 mm"], "the unit is missing"),
        ("[1, x, 2] mm", "does not begin with a number"),
        ("[1, , 2] mm", "does not begin with a number"),
        ("[1, nan, 2] mm", "not finite"),
        ("[1, 2, 3] deg", "'deg' is not a unit of length"),
        ("[1 mm, 2 mm, 3 mm] mm", "'mm mm' is not a unit of length"),
    ],
)
def test_vectors_that_cannot_be_read(value, problem):
    with pytest.raises(InputError) as caught:
        parse_quantities(value, LENGTH, (3,))
    assert problem in caught.value.problem
    assert "[0, 0, 40] mm" in caught.value.expected


MAGNITUDES = st.just(0.0) | st.floats(1e-5, 1e6) | st.floats(-1e6, -1e-5)
"""Numbers that no unit takes out of the range of its kind."""


@given(number=MAGNITUDES, unit=st.sampled_from(sorted(EXACT_MM)))
def test_every_length_is_the_double_nearest_to_its_exact_value(number, unit):
    exact = Fraction(repr(number)) * EXACT_MM[unit]  # repr: the decimal number as it is written
    # Decimal carries 28 digits, a double 16: rounded twice, which may differ in the last place in 1 of 10^12 cases
    assert parse_quantity(f"{number!r} {unit}", LENGTH) == pytest.approx(float(exact), rel=2.3e-16, abs=0)


@given(number=MAGNITUDES.filter(lambda number: abs(number) < 100))
def test_internal_units_change_nothing(number):
    for kind in (LENGTH, ANGLE, PIXELS):
        assert parse_quantity(f"{number!r} {kind.unit}", kind) == number
    assert parse_quantity(number, RATIO) == number
