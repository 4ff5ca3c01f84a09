"""What a requirement allows, and which requirements make no sense."""

import math

import pytest

import viewgauge as vg


def test_an_accuracy_allows_a_share_of_the_nominal_length():
    requirement = vg.Requirement("accuracy", 0.99, 0.95)
    assert requirement.allowed_error_mm(60.0, (-0.1, 0.1)) == pytest.approx(0.6)
    assert requirement.allowed_error_mm(60.0, None) == pytest.approx(0.6)


def test_an_error_is_allowed_as_it_stands():
    requirement = vg.Requirement("error", 0.05, 0.95)
    assert requirement.allowed_error_mm(60.0, None) == requirement.allowed_error_mm(1.0, (-1.0, 1.0)) == 0.05


@pytest.mark.parametrize(
    ("tolerance", "allowed"), [((-0.1, 0.1), 0.01), ((-0.05, 0.1), 0.0075), ((0.0, 0.3), 0.015), ((0.1, 0.3), 0.01)]
)
def test_a_fraction_of_the_tolerance_counts_half_the_width_of_its_zone(tolerance, allowed):
    assert vg.Requirement("fraction_of_tolerance", 0.1, 0.95).allowed_error_mm(60.0, tolerance) == pytest.approx(
        allowed
    )


def test_a_fraction_of_no_tolerance_is_none():
    assert vg.Requirement("fraction_of_tolerance", 0.1, 0.95).allowed_error_mm(60.0, None) is None


@pytest.mark.parametrize("kind", ["accuracy", "error", "fraction_of_tolerance"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.nan, math.inf])
def test_a_value_that_is_not_positive_is_refused(kind, value):
    with pytest.raises(vg.InputError, match=kind):
        vg.Requirement(kind, value, 0.95)


@pytest.mark.parametrize("value", [1.0, 99.0])
def test_an_accuracy_of_one_or_in_percent_is_refused(value):
    with pytest.raises(vg.InputError, match="between 0 and 1"):
        vg.Requirement("accuracy", value, 0.95)


@pytest.mark.parametrize("probability", [0.0, 1.0, 95.0, -0.5, math.nan])
def test_a_probability_that_is_none_or_certainty_is_refused(probability):
    with pytest.raises(vg.InputError, match="probability"):
        vg.Requirement("error", 0.05, probability)


def test_an_unknown_kind_is_refused():
    with pytest.raises(vg.InputError, match="kind"):
        vg.Requirement("tolerance", 0.05, 0.95)
