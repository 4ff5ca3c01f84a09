"""Conformance probability and risks, against published values, a published tool, and integrals done in another way."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.stats import norm

from viewgauge.evaluation.requirement.decision_risks import (
    acceptance_limits,
    conformance_probability,
    global_risks,
    guard_multiplier,
    true_value_given,
)


def integrated_risks(u, lower, upper, accept_lower, accept_upper, mean, s):
    """The double integrals of clause 9.5, the inner one by the normal cdf, the outer one by adaptive quadrature."""

    def accepted(y):
        return norm.pdf(y, mean, s) * (norm.cdf((accept_upper - y) / u) - norm.cdf((accept_lower - y) / u))

    def rejected(y):
        return norm.pdf(y, mean, s) * (norm.sf((accept_upper - y) / u) + norm.cdf((accept_lower - y) / u))

    def integral(function, start, end):
        bends = (lower, upper, accept_lower, accept_upper, mean)
        steps = [b + k * w for b in bends for w in (u, s) for k in (-8, -3, -1, 0, 1, 3, 8)]
        places = sorted({start, end, *(p for p in steps if start < p < end)})
        parts = itertools.pairwise(places)
        return sum(quad(function, a, b, epsabs=1e-13, epsrel=1e-11)[0] for a, b in parts)

    low, high = min(lower, mean - 12 * s), max(upper, mean + 12 * s)
    return integral(accepted, low, lower) + integral(accepted, upper, high), integral(rejected, lower, upper)


# -- conformance of one item


def test_specific_risk_is_that_of_suncal():
    # Suncal (Sandia), API manual, "Guardbanding and False Accept Risk", "Specific Risk": N(9.8, 0.1), limits 9 and 10:
    # total 0.022750131948180274
    assert 1 - conformance_probability(9.8, 0.1, 9, 10) == pytest.approx(0.022750131948180274, rel=1e-12)


@pytest.mark.parametrize(("mean", "nonconforming"), [(10.0, 0.01242), (10.5, 0.10574), (12.0, 0.99379)])
def test_shares_of_processes_are_those_of_suncal(mean, nonconforming):
    # Suncal's test_cpk (test/test_risk.py), limits 9 and 11, standard deviation 0.4; printed to five decimals
    assert 1 - conformance_probability(mean, 0.4, 9, 11) == pytest.approx(nonconforming, abs=6e-6)


def test_a_guard_band_of_u_leaves_a_specific_risk_of_2_3_percent():
    # the classical figure of ISO 14253-1's rule with U = 2 u: 1 - Phi(2)
    limit = acceptance_limits(-1.0, 1.0, 2 * 0.05, guard_multiplier("guarded"))[1]
    assert 1 - conformance_probability(limit, 0.05, -1, 1) == pytest.approx(0.5 * math.erfc(math.sqrt(2)), rel=1e-12)
    # and the guard band that leaves 5 %, for the one-sided z of 1.645 of normal tables
    limit = acceptance_limits(-1.0, 1.0, 2 * 0.05, guard_multiplier("guarded", 1.645 / 2))[1]
    assert conformance_probability(limit, 0.05, -1, 1) == pytest.approx(0.95, abs=5e-5)


def test_far_out_nothing_cancels():
    assert conformance_probability(11.0, 0.1, 9, 10) == pytest.approx(norm.sf(10), rel=1e-12)
    assert conformance_probability(8.0, 0.1, 9, 10) == pytest.approx(norm.sf(10), rel=1e-12)
    assert conformance_probability(0.0, 1.0, -np.inf, 0.0) == 0.5


def test_a_perfect_measurement_knows():
    np.testing.assert_array_equal(conformance_probability([-2, -1, 0, 1, 2], 0.0, -1, 1), [0, 1, 1, 1, 0])


def test_acceptance_limits():
    assert acceptance_limits(-0.1, 0.2, 0.03, guard_multiplier("simple")) == (-0.1, 0.2)
    np.testing.assert_allclose(acceptance_limits(-0.1, 0.2, 0.03, guard_multiplier("guarded")), (-0.07, 0.17))
    np.testing.assert_allclose(
        acceptance_limits(-0.1, 0.2, 0.02, guard_multiplier("guarded_rejection", 1.5)), (-0.13, 0.23)
    )


def test_what_is_known_of_an_item_is_the_product_of_two_laws():
    # oracle: prior times likelihood on a grid; 1e-9 is the grid's error
    y = np.linspace(-3, 3, 200_001)
    weight = norm.pdf(y, 0.2, 0.3) * norm.pdf(0.9, y, 0.15)
    best = (weight * y).sum() / weight.sum()
    spread = math.sqrt((weight * (y - best) ** 2).sum() / weight.sum())
    assert true_value_given(0.9, 0.15, 0.2, 0.3) == pytest.approx((best, spread), abs=1e-9)


# -- global risks

# D. Deaver, "How to maintain confidence in a world of declining test uncertainty ratios", as quoted in Suncal's tests
# (test/test_risk.py, test_riskdeaver, test_riskmontecarlo, test_gb): limits in standard deviations of the process,
# standard deviation of the process over that of the measurement, acceptance over tolerance limit; as many digits
DEAVER = [
    (2.0, 4.0, 1.0, 0.008, 0.015, 5e-4),
    (2.0, 2.0, 0.91, 0.008, 0.066, 5e-4),
]


@pytest.mark.parametrize(("limit", "ratio", "guard", "consumer", "producer", "digits"), DEAVER)
def test_global_risks_are_those_of_deaver(limit, ratio, guard, consumer, producer, digits):
    risks = global_risks(1 / ratio, -limit, limit, -guard * limit, guard * limit, 0, 1)
    assert risks == pytest.approx((consumer, producer), abs=digits)


# Suncal 1.7.1, suncal.risk.risk.PFA and PFR (Simpson's rule, 5001 places): process mean and standard deviation,
# uncertainty, guard bands below and above; tolerance limits -1 and 1. Where no guard band is given its own dblquad
# (deaver.PFA_deaver, PFR_deaver) agrees to 1e-12.
SUNCAL = [
    (0.0, 0.5, 0.125, 0.0, 0.0, 0.00800608483444333, 0.014850884211251907),
    (0.0, 0.5, 0.125, 0.25, 0.25, 0.00019461477471385878, 0.10030444627521243),
    (0.2, 0.4, 0.1, 0.15, 0.3, 2.9394171135170244e-05, 0.09399434439225593),
]


@pytest.mark.parametrize(("mean", "s", "u", "below", "above", "consumer", "producer"), SUNCAL)
def test_global_risks_are_those_of_suncal(mean, s, u, below, above, consumer, producer):
    risks = global_risks(u, -1, 1, -1 + below, 1 - above, mean, s)
    assert risks == pytest.approx((consumer, producer), abs=1e-11)  # of Simpson's rule


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-3, 1),
    st.floats(-2, 1),
    st.sampled_from([0.0, 1.0, -1.0, 0.37, -2.5]),
    st.sampled_from([0.0, 0.3, -0.4, 0.999]),
    st.sampled_from([0.0, 0.3, -0.4, 0.999]),
)
def test_global_risks_are_the_integrals(log_u, log_s, mean, below, above):
    zone = -1.0, 1.0, -1 + below, 1 - above
    u, s = 10**log_u, 10**log_s
    if zone[2] < zone[3]:
        expected = integrated_risks(u, *zone, mean, s)
        assert global_risks(u, *zone, mean, s) == pytest.approx(expected, abs=1e-10)  # of the quadrature


def test_global_risks_are_frequencies():
    # 4e6 draws, fixed seed; 5 standard errors: a false alarm in 1e6 runs
    rng = np.random.default_rng(20)
    true = rng.normal(0.02, 0.05, 4_000_000)
    measured = true + rng.normal(0, 0.02, true.size)
    conforms, accepted = np.abs(true) <= 0.1, np.abs(measured) <= 0.07
    risks = global_risks(0.02, -0.1, 0.1, -0.07, 0.07, 0.02, 0.05)
    for risk, event in zip(risks, (accepted & ~conforms, conforms & ~accepted), strict=True):
        assert abs(event.mean() - risk) < 5 * math.sqrt(risk / true.size)


def test_risks_of_a_perfect_measurement():
    assert global_risks(0, -1, 1, -1, 1, 0.3, 0.5) == pytest.approx((0, 0), abs=0)
    guarded = global_risks(0, -1, 1, -0.5, 0.5, 0, 0.5)  # rejects what lies between 0.5 and 1: Phi(2) - Phi(1), twice
    assert guarded == pytest.approx((0, 2 * (norm.cdf(2) - norm.cdf(1))), rel=1e-12)
    wide = global_risks(0, -1, 1, -1.5, 1.5, 0, 0.5)
    assert wide == pytest.approx((2 * (norm.cdf(3) - norm.cdf(2)), 0), rel=1e-10)


def test_risks_where_the_process_sits_on_a_limit():
    # a quarter plane of two correlated normals: half of what conforms, or does not, is judged rightly, and more the
    # more the two go together; closed form 1/4 - arcsin(rho)/(2 pi), the far limit being out of reach
    u, s = 0.01, 0.02
    expected = 0.25 - math.asin(s / math.hypot(s, u)) / (2 * math.pi)
    assert global_risks(u, -1, 1, -1, 1, 1.0, s) == pytest.approx((expected, expected), abs=1e-14)


def test_nothing_is_accepted_where_the_guard_bands_meet():
    risks = global_risks(0.3, -1, 1, *acceptance_limits(-1, 1, 2 * 0.6, 1.0), 0, 0.5)
    assert risks == pytest.approx((0, norm.cdf(2) - norm.cdf(-2)))


@given(st.floats(0, 1e6), st.floats(1e-6, 1e6), st.floats(-1e3, 1e3))
def test_risks_are_probabilities(u, s, mean):
    conforming = conformance_probability(mean, s, -1, 1)
    consumer, producer = global_risks(u, -1, 1, -1, 1, mean, s)
    assert 0 <= consumer <= 1 - conforming + 1e-12
    assert 0 <= producer <= conforming + 1e-12


def test_risks_broadcast():
    u, s = np.array([0.0, 0.01, 0.1]), np.array([[0.3], [0.5]])
    risks = global_risks(u, -1, 1, -1, 1, 0, s)
    assert risks.consumer.shape == risks.producer.shape == (2, 3)
    assert risks.producer[1, 2] == global_risks(0.1, -1, 1, -1, 1, 0, 0.5).producer
