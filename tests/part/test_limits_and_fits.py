"""Tolerance classes against deviations printed in ISO 286-2, and the grades against the formulas of ISO 286-1."""

import math

import pytest

from viewgauge.part.limits_and_fits import _GRADES_UM, _RANGES, class_deviations_mm

# Limit deviations in micrometres (lower, upper) as tables of ISO 286-2 print them.
PRINTED = [
    (9, "H7", 0, 15), (9, "H8", 0, 22), (25, "g6", -20, -7), (25, "H7", 0, 21),
    (25, "h6", -13, 0), (40, "f7", -50, -25), (40, "e8", -89, -50), (40, "d9", -142, -80),
    (60, "H8", 0, 46), (60, "js7", -15, 15), (20, "k6", 2, 15), (20, "m6", 8, 21),
    (20, "n6", 15, 28), (20, "p6", 22, 35), (20, "r6", 28, 41), (20, "s6", 35, 48),
    (20, "u6", 41, 54), (50, "k7", 2, 27), (20, "K7", -15, 6), (20, "M7", -21, 0),
    (20, "N7", -28, -7), (20, "P7", -35, -14), (20, "K8", -23, 10), (20, "N9", -52, 0),
    (20, "G7", 7, 28), (20, "F8", 20, 53), (20, "D10", 65, 149), (3, "H6", 0, 6),
    (3, "P7", -16, -6), (3.001, "H7", 0, 12), (10, "H7", 0, 15), (10.001, "H7", 0, 18),
    (100, "s6", 71, 93), (130, "r6", 63, 88), (200, "H11", 0, 290), (260, "M6", -41, -9),
    (500, "H7", 0, 63), (120, "c11", -400, -180), (8, "H13", 0, 220), (8, "h14", -360, 0),
    (45, "JS9", -31, 31), (20, "k9", 0, 52), (35, "U7", -76, -51),
]  # fmt: skip


@pytest.mark.parametrize(("size", "name", "lower", "upper"), PRINTED)
def test_deviations_are_those_of_the_printed_tables(size, name, lower, upper):
    letter = name.rstrip("0123456789")
    assert class_deviations_mm(size, letter, name[len(letter) :]) == pytest.approx((lower / 1000, upper / 1000))


def test_what_the_tables_do_not_have_has_no_deviations():
    assert class_deviations_mm(501, "H", "7") is None
    assert class_deviations_mm(0, "H", "7") is None
    assert class_deviations_mm(20, "q", "7") is None
    assert class_deviations_mm(20, "H", "19") is None
    assert class_deviations_mm(20, "", "7") is None
    assert class_deviations_mm(0.8, "a", "11") is None


def test_grades_follow_the_formulas_but_for_their_rounding():
    """i = 0.45 D^(1/3) + 0.001 D; IT6 = 10 i, then five grades a factor of ten (1.6 from one to the next)."""
    factors = {"5": 7, "6": 10, "7": 16, "8": 25, "9": 40, "10": 64, "11": 100, "12": 160, "16": 1000, "18": 2500}
    for place in range(1, len(_RANGES)):  # in the first range, up to 3 mm, the standard rounds further
        upper = _RANGES[place]
        mean = math.sqrt(_RANGES[place - 1] * upper)
        unit = 0.45 * mean ** (1 / 3) + 0.001 * mean
        for grade, factor in factors.items():
            value = _GRADES_UM[grade][place]
            assert value == pytest.approx(factor * unit, rel=0.05, abs=0.75), (grade, upper)
