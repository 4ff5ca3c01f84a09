"""Required capabilities and limits on wrong decisions: what error they allow, and where they say nothing."""

import dataclasses
import json
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.stats import norm

import viewgauge as vg
from viewgauge.errors import TotalError
from viewgauge.evaluation import CapabilityRequirement, ConformanceRequirement, Process
from viewgauge.evaluation.requirement.capability_indices import cg, cgk, percent_p_to_t
from viewgauge.evaluation.requirement.target_uncertainty import largest_uncertainty

CAPABLE = Process(capability=1.0)


# -- capability


@pytest.mark.parametrize(
    ("kind", "value", "options", "index"),
    [
        ("percent_p_to_t", 0.1, {}, lambda s, zone: percent_p_to_t(s, *zone) / 100),
        ("percent_p_to_t", 0.3, {"sigmas": 5.15}, lambda s, zone: percent_p_to_t(s, *zone, 5.15) / 100),
        ("cg", 1.33, {}, lambda s, zone: cg(s, *zone)),
        ("cg", 1.67, {"share": 0.15, "sigmas": 4}, lambda s, zone: cg(s, *zone, share=0.15, sigmas=4)),
        ("cgk", 1.33, {"bias_mm": -0.002}, lambda s, zone: cgk(s, *zone, bias=0.002)),
    ],
)
def test_a_normal_law_that_just_meets_the_capability_just_meets_the_requirement(kind, value, options, index):
    requirement, zone = CapabilityRequirement(kind, value, **options), (-0.05, 0.15)
    sigma = brentq(lambda s: index(s, zone) - value, 1e-5, 1.0, xtol=1e-15)
    allowed = requirement.allowed_error_mm(60.0, zone)
    assert norm.cdf(allowed, scale=sigma) - norm.cdf(-allowed, scale=sigma) == pytest.approx(requirement.probability)


def test_figures_of_a_capability_by_hand():
    # zone 0.2 mm: P/T 10 % is a spread of 0.02 mm in all; Cg 1.33 one of 0.04/1.33; of Cgk the bias is taken off first
    assert CapabilityRequirement("percent_p_to_t", 0.1).allowed_error_mm(1, (-0.1, 0.1)) == pytest.approx(0.01)
    assert CapabilityRequirement("cg", 1.33).allowed_error_mm(1, (-0.1, 0.1)) == pytest.approx(0.02 / 1.33)
    bias = CapabilityRequirement("cgk", 1.33, bias_mm=0.005)
    assert bias.allowed_error_mm(1, (0.0, 0.2)) == pytest.approx(0.015 / 1.33)


@pytest.mark.parametrize("kind", ["percent_p_to_t", "cg", "cgk"])
def test_a_capability_says_nothing_without_a_tolerance(kind):
    requirement = CapabilityRequirement(kind, 1.0)
    assert requirement.allowed_error_mm(60.0, None) is None
    assert "no tolerance" in requirement.cannot_judge(None)
    assert requirement.cannot_judge((-0.1, 0.1)) is None
    assert requirement.allowed_error_mm(60.0, (0.0, 0.0)) is None
    assert "no width" in requirement.cannot_judge((0.0, 0.0))


def test_a_bias_that_is_too_large_for_a_tolerance_is_reported():
    requirement = CapabilityRequirement("cgk", 1.33, bias_mm=0.02)
    assert requirement.allowed_error_mm(60.0, (-0.05, 0.05)) is None
    reason = requirement.cannot_judge((-0.05, 0.05))
    assert "bias of 0.02 mm" in reason
    assert "10 % of the tolerance zone of 0.1 mm" in reason
    assert requirement.cannot_judge((-0.5, 0.5)) is None
    assert requirement.allowed_error_mm(60.0, (-0.1, 0.1)) is None  # exactly: rounding leaves 3e-18 mm
    assert "is no less than" in requirement.cannot_judge((-0.1, 0.1))


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ({"kind": "cp", "value": 1.33}, "kind"),
        ({"kind": "cg", "value": 0.0}, "cg"),
        ({"kind": "cgk", "value": math.nan}, "cgk"),
        ({"kind": "cg", "value": 1.33, "sigmas": 0.0}, "sigmas"),
        ({"kind": "cg", "value": 1.33, "sigmas": 100.0}, "sigmas"),
        ({"kind": "cg", "value": 1.33, "share": 20.0}, "share"),
        ({"kind": "cg", "value": 1.33, "bias_mm": 0.001}, "bias"),
        ({"kind": "cgk", "value": 1.33, "bias_mm": math.inf}, "bias"),
        ({"kind": "percent_p_to_t", "value": 0.1, "share": 0.1}, "share"),
    ],
)
def test_a_capability_that_makes_no_sense_is_refused(arguments, key):
    with pytest.raises(vg.InputError) as caught:
        CapabilityRequirement(**arguments)
    assert caught.value.key == key


# -- conformance


def crossing(risk_of, limit):
    """Where a risk that rises from 0 first reaches a limit, by steps of 1 % and bisection."""
    u = 1e-6
    while risk_of(1.01 * u) <= limit:
        u *= 1.01
    return brentq(lambda x: risk_of(x) - limit, u, 1.01 * u, xtol=1e-15, rtol=1e-12)


def sampled_risks(u, guard, process, tolerance):
    """Global risks by summing over a fine grid of true values; no closed form."""
    mean, s = process
    y = np.linspace(mean - 9 * s, mean + 9 * s, 10_001)
    weight = norm.pdf(y, mean, s) * (y[1] - y[0])
    w = guard * 2 * u
    accepted = norm.cdf((tolerance[1] - w - y) / u) - norm.cdf((tolerance[0] + w - y) / u)
    inside = np.clip((np.minimum(tolerance[1] - y, y - tolerance[0])) / (y[1] - y[0]) + 0.5, 0, 1)
    return (weight * (1 - inside) * accepted).sum(), (weight * inside * (1 - accepted)).sum()


@pytest.mark.parametrize(
    ("rule", "guard", "limits", "which"),
    [
        ("simple", 0.0, {"consumer_risk": 0.001}, 0),
        ("simple", 0.0, {"producer_risk": 0.002}, 1),
        ("guarded", 1.0, {"producer_risk": 0.05}, 1),
        ("guarded_rejection", -1.0, {"consumer_risk": 0.0015}, 0),
    ],
)
@pytest.mark.parametrize("offset", [0.0, 0.015])
def test_the_allowed_error_is_twice_the_uncertainty_at_which_a_risk_reaches_its_limit(
    rule, guard, limits, which, offset
):
    process, tolerance = Process(standard_deviation_mm=0.035, offset_mm=offset), (-0.05, 0.15)
    requirement = ConformanceRequirement(rule, process, **limits)
    assert requirement.value == guard
    law = 0.05 + offset, 0.035
    u = crossing(lambda x: sampled_risks(x, guard, law, tolerance)[which], *limits.values())
    assert requirement.allowed_error_mm(60.0, tolerance) == pytest.approx(2 * u, rel=1e-4)  # of the grid
    assert requirement.risks(u, tolerance)[which] == pytest.approx(*limits.values(), rel=1e-3)


def test_of_two_limits_the_tighter_one_counts():
    process, zone = Process(standard_deviation_mm=0.05), (-0.1, 0.1)
    consumer = ConformanceRequirement("simple", process, consumer_risk=0.005).allowed_error_mm(1, zone)
    producer = ConformanceRequirement("simple", process, producer_risk=0.005).allowed_error_mm(1, zone)
    both = ConformanceRequirement("simple", process, consumer_risk=0.005, producer_risk=0.005)
    assert both.allowed_error_mm(1, zone) == min(consumer, producer)


def test_the_first_crossing_counts_where_the_risk_falls_again():
    # half of what the process makes does not conform; a very uncertain measurement accepts nothing, so that the
    # consumer's risk is small again
    u = largest_uncertainty(1.0, 0.0, 1.5, 0.0, 0.03, None)
    risks = [
        ConformanceRequirement("simple", Process(1.5), consumer_risk=0.03).risks(x, (-1, 1)) for x in (u, 2 * u, 60)
    ]
    assert risks[0].consumer == pytest.approx(0.03)
    assert risks[1].consumer > 0.03
    assert risks[2].consumer < 0.03


def test_the_rule_of_iso_14253_asks_for_more_where_parts_must_not_be_lost():
    zone, limit = (-0.1, 0.1), {"producer_risk": 0.02}
    simple = ConformanceRequirement("simple", CAPABLE, **limit).allowed_error_mm(1, zone)
    half = ConformanceRequirement("guarded", CAPABLE, guard=0.5, **limit).allowed_error_mm(1, zone)
    full = ConformanceRequirement("guarded", CAPABLE, **limit).allowed_error_mm(1, zone)
    assert full < half < simple


def test_a_capability_of_the_process_scales_with_the_tolerance():
    requirement = ConformanceRequirement("guarded", Process(capability=1.33), producer_risk=0.01)
    one, ten = (requirement.allowed_error_mm(1, zone) for zone in ((-0.1, 0.1), (0.0, 2.0)))
    assert ten == pytest.approx(10 * one, rel=1e-9)
    same = ConformanceRequirement("guarded", Process(standard_deviation_mm=0.2 / (6 * 1.33)), producer_risk=0.01)
    assert same.allowed_error_mm(1, (-0.1, 0.1)) == pytest.approx(one, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.2, 3),
    st.floats(-0.5, 0.5),
    st.sampled_from([0.0, 0.5, 1.0, -1.0]),
    st.one_of(st.none(), st.floats(1e-6, 0.2)),
    st.floats(1e-6, 0.2),
)
def test_no_smaller_uncertainty_has_a_risk_over_its_limit(s, offset, multiplier, consumer, producer):
    u = largest_uncertainty(1.0, offset, s, multiplier, consumer, producer)
    rule = {0.0: "simple", -1.0: "guarded_rejection"}.get(multiplier, "guarded")
    limits = {"consumer_risk": consumer, "producer_risk": producer}
    requirement = ConformanceRequirement(rule, Process(s, offset_mm=offset), abs(multiplier) or 1.0, **limits)
    for part in np.linspace(0.0, min(u, 1e3), 37):
        risks = requirement.risks(part, (-1.0, 1.0))
        assert consumer is None or risks.consumer <= consumer * (1 + 1e-9)
        assert risks.producer <= producer * (1 + 1e-9)


def test_risks_that_any_measurement_keeps_are_reported():
    requirement = ConformanceRequirement("simple", Process(capability=1.67), consumer_risk=0.01)
    assert requirement.allowed_error_mm(60.0, (-0.1, 0.1)) is None
    assert "limit the producer's risk too" in requirement.cannot_judge((-0.1, 0.1))
    assert "no tolerance" in requirement.cannot_judge(None)
    assert "no width" in requirement.cannot_judge((0.1, 0.1))
    assert requirement.allowed_error_mm(60.0, None) is requirement.allowed_error_mm(60.0, (0.1, 0.1)) is None


def test_the_coverage_definition_errs_by_at_most_4_percent_where_quantization_rules():
    # the law of the allowed error just met, P(|e| <= 2 u) = 0.9545, against its standard deviation
    for angle in (0.0, 0.3, math.pi / 4):
        for sigma in (0.0, 0.2, 0.5, 1.0, 5.0):
            law = TotalError(sigma, 1.0, angle)
            u = float(law.ppf((1 + math.erf(math.sqrt(2))) / 2)) / 2
            assert 1 - 1e-9 <= math.sqrt(float(law.var())) / u < 1.04


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"rule": "shared"}, "rule"),
        ({"guard": 0.0}, "guard"),
        ({"guard": math.nan}, "guard"),
        ({"producer_risk": None}, None),
        ({"producer_risk": -0.01}, "producer_risk"),
        ({"consumer_risk": 1.0}, "consumer_risk"),
    ],
)
def test_a_conformance_that_makes_no_sense_is_refused(change, key):
    with pytest.raises(vg.InputError) as caught:
        ConformanceRequirement(**{"rule": "guarded", "process": CAPABLE, "producer_risk": 0.05} | change)
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        ({}, None),
        ({"standard_deviation_mm": 0.1, "capability": 1.0}, "capability"),
        ({"standard_deviation_mm": 0.0}, "standard_deviation"),
        ({"capability": -1.0}, "capability"),
        ({"capability": 1.0, "offset_mm": math.inf}, "offset"),
    ],
)
def test_a_process_that_makes_no_sense_is_refused(arguments, key):
    with pytest.raises(vg.InputError) as caught:
        Process(**arguments)
    assert caught.value.key == key


@pytest.mark.parametrize(
    "requirement",
    [
        CapabilityRequirement("cgk", 1.33, bias_mm=0.002),
        ConformanceRequirement("guarded", Process(0.02, offset_mm=0.001), consumer_risk=0.01, producer_risk=0.05),
    ],
)
def test_all_kinds_travel_and_are_written(requirement):
    again = pickle.loads(pickle.dumps(requirement))
    assert again == requirement
    assert repr(again) == repr(requirement)
    assert isinstance(requirement, vg.Requirement)
    document = json.loads(json.dumps(dataclasses.asdict(requirement), allow_nan=False))
    assert {"kind", "value", "probability"} <= set(document)
