"""%P/T, Cg and Cgk, against outputs of published tools."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.evaluation.requirement.capability_indices import (
    cg,
    cgk,
    coverage,
    percent_p_to_t,
    spread_for_cg,
    spread_for_cgk,
    spread_for_percent_p_to_t,
)

# Measurand R&R of tablet thickness by ss.rr of the R package SixSigma, lsl 1775, usl 1825 um, as printed in
# J. Ramalho, "industRial data science", chapter Measurement System Analysis, "Negative variance": StdDev, %Tolerance.
# Four digits are printed.
SIXSIGMA = [(1.27773, 15.33), (1.25137, 15.02), (0.25823, 3.10), (3.07390, 36.89), (3.32888, 39.95)]


@pytest.mark.parametrize(("sigma", "printed"), SIXSIGMA)
def test_percent_p_to_t_is_that_of_sixsigma(sigma, printed):
    assert percent_p_to_t(sigma, 1775, 1825) == pytest.approx(printed, abs=0.005)


def test_percent_p_to_t_is_that_of_daspi():
    # DaSPi, guide "Gage R&R", table "Repeatability and reproducibility": s = 0.000821, 6s/Tolerance = 0.164148 for a
    # tolerance of 0.03; s is printed to three digits (6e-4)
    assert percent_p_to_t(0.000821, 0.0, 0.03) == pytest.approx(16.4148, rel=6e-4)


def test_cg_and_cgk_are_those_of_daspi():
    # the same guide, "References Analysis" and "Gage capability": bias -0.000340, s 0.000688, tolerance 0.03, spread of
    # four standard deviations (U = 2 u): Cg 2.179005, Cgk 1.932051; s is printed to three digits (7e-4)
    zone = 0.086, 0.116
    assert cg(0.000688, *zone, sigmas=4) == pytest.approx(2.179005, rel=8e-4)
    assert cgk(0.000688, *zone, bias=-0.000340, sigmas=4) == pytest.approx(1.932051, rel=8e-4)
    # "T_min": the tolerance at which they are 1.33
    assert cg(0.000688, 0.0, 0.018311, sigmas=4) == pytest.approx(1.33, rel=8e-4)
    assert cgk(0.000688, 0.0, 0.021711, bias=-0.000340, sigmas=4) == pytest.approx(1.33, rel=8e-4)


def test_cg_of_two_covers_the_spread_twice():
    # Minitab's help on type 1 gage studies: with K = 20 and L = 6, a Cg of 2 says that 20 % of the tolerance range
    # covers the spread of the measurements twice over
    sigma = 0.2 * 3.0 / (2 * 6)
    assert cg(sigma, -1.5, 1.5) == pytest.approx(2.0)


def test_coverage():
    # the help of cg() in the R package qualityTools: 99.73002 % and, of 5.15, 98.9976 %
    assert coverage() == pytest.approx(0.9973002, abs=5e-8)
    assert coverage(5.15) == pytest.approx(0.989976, abs=5e-7)
    assert coverage(4) == pytest.approx(math.erf(math.sqrt(2)))


@given(st.floats(1e-6, 1e3), st.floats(-10, 10), st.floats(1e-3, 1e3), st.sampled_from([4.0, 5.15, 6.0]))
def test_inverses_lead_back(value, lower, width, sigmas):
    zone = lower, lower + width
    sigma = 2 / sigmas
    assert percent_p_to_t(sigma * spread_for_percent_p_to_t(value, *zone), *zone, sigmas) == pytest.approx(value)
    assert cg(sigma * spread_for_cg(value, *zone), *zone, sigmas=sigmas) == pytest.approx(value)
    bias = 0.03 * width
    spread = spread_for_cgk(value, *zone, bias=bias)
    assert cgk(sigma * spread, *zone, bias=bias, sigmas=sigmas) == pytest.approx(value)
    assert spread < spread_for_cg(value, *zone)


def test_a_bias_that_uses_up_the_share_leaves_no_spread():
    assert spread_for_cgk(1.33, 0.0, 0.25, bias=0.025) == 0
    assert spread_for_cgk(1.33, -0.1, 0.1, bias=-0.03) < 0


def test_a_perfect_measurement():
    assert percent_p_to_t(0, -1, 1) == 0
    assert cg(0, -1, 1) == math.inf
    assert cgk(0, -1, 1, bias=0.3) == -math.inf


def test_all_broadcast():
    sigma, upper = np.array([[0.01], [0.02]]), np.array([0.1, 0.2, 0.3])
    assert percent_p_to_t(sigma, 0, upper).shape == (2, 3)
    assert cgk(sigma, 0, upper, bias=[0.0, 0.001, 0.002]).shape == (2, 3)
    np.testing.assert_allclose(cg(sigma, 0, upper)[1], [cg(0.02, 0, value) for value in upper])
