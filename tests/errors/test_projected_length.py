"""Projected lengths (eq. 21, 22) against the projection of the two ends in rational and 40-digit arithmetic."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import viewgauge as vg
from viewgauge.errors import projected_length, projected_length_on_axis


def projected_ends(length, beta, x, y, t_z, f):
    """Distance of the images of the two ends; None where one is not in front of the lens."""
    with mp.workdps(40):
        length, beta, x, y, t_z, f = map(mp.mpf, (length, beta, x, y, t_z, f))
        half = [0, length / 2 * mp.sin(beta), length / 2 * mp.cos(beta)]
        centre = [x, y, f + t_z]
        ends = [[c + sign * h for c, h in zip(centre, half, strict=True)] for sign in (-1, 1)]
        if min(end[2] for end in ends) <= 0:
            return None
        (u1, v1), (u2, v2) = ([f * end[0] / end[2], f * end[1] / end[2]] for end in ends)
        return float(mp.hypot(u2 - u1, v2 - v1))


@settings(deadline=None)
@given(
    st.one_of(st.sampled_from([0.0, 1e-9]), st.floats(0.1, 400.0)),
    st.one_of(st.sampled_from([0.0, math.pi / 2, math.pi, -0.5]), st.floats(-7.0, 7.0)),
    st.floats(-300.0, 300.0),
    st.floats(-300.0, 300.0),
    st.floats(10.0, 2000.0),
    st.floats(1.0, 50.0),
)
def test_equation_21_is_the_projection_of_the_two_ends(length, beta, x, y, t_z, f):
    expected = projected_ends(length, beta, x, y, t_z, f)
    found = float(projected_length(length, beta, x, y, t_z, f))
    if expected is None:
        assert math.isnan(found) or found > 1e12  # rounding may put an end on either side of the lens
        return
    nearest = f + t_z - abs(length / 2 * math.cos(beta))
    assume(nearest > 1e-6)
    # rounding of the depth of the nearer end, and of the two parts that may cancel across
    size = length * f * (abs(x) + abs(y) + f + t_z) / (nearest * (f + t_z))
    assert found == pytest.approx(expected, rel=1e-15 * (f + t_z) / nearest + 1e-13, abs=1e-15 * size)


@pytest.mark.parametrize("beta", [0.0, 0.3, 1.0, math.pi / 2, 2.5, -0.7])
@pytest.mark.parametrize("length", [1.0, 60.0, 300.0])
def test_equation_22_is_the_projection_of_the_two_ends_with_minus_in_the_denominator(length, beta):
    f, d = 16.0, 400.0
    expected = projected_ends(length, beta, 0.0, 0.0, d, f)
    assert projected_length_on_axis(length, beta, d, f) == pytest.approx(expected, rel=1e-13, abs=1e-15)
    # erratum: as printed, with plus, it is short wherever the segment is tilted
    printed = length * f * abs(math.sin(beta)) * (d + f) / ((d + f) ** 2 + (length * math.cos(beta)) ** 2 / 4)
    if length == 300 and 0.1 < abs(math.cos(beta)) < 1:
        assert printed < expected * 0.99


def test_a_segment_that_reaches_the_lens_has_no_image():
    np.testing.assert_array_equal(
        np.isnan(projected_length(100.0, [0.0, 0.0, math.pi / 2], 1.0, 0.0, [33.0, 35.0, -15.0], 16.0)),
        [True, False, False],
    )
    assert math.isnan(projected_length(1.0, 1.0, 0.0, 0.0, -100.0, 16.0))


def test_arguments_broadcast():
    assert projected_length(np.ones((3, 1)), np.zeros(4), 1.0, 2.0, 500.0, 16.0).shape == (3, 4)
    assert projected_length_on_axis(np.ones(3), 0.3, 500.0, 16.0).shape == (3,)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((-1.0, 0.3, 0.0, 0.0, 500.0, 16.0), "length_mm"),
        ((1.0, math.nan, 0.0, 0.0, 500.0, 16.0), "beta_rad"),
        ((1.0, 0.3, 0.0, 0.0, math.inf, 16.0), "t_z_mm"),
        ((1.0, 0.3, 0.0, 0.0, 500.0, "wide"), "focal_length_mm"),
    ],
)
def test_bad_arguments_are_refused(arguments, name):
    with pytest.raises(vg.InputError, match=name):
        projected_length(*arguments)
