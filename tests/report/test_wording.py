from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from viewgauge.evaluation import CapabilityRequirement, ConformanceRequirement, Process, Requirement
from viewgauge.report.wording import length, probability, rounded, tolerance


@pytest.mark.parametrize(
    ("value", "printed"),
    [
        (0.0, "0"),
        (1e-9, "< 0.0001"),
        (0.9321, "0.9321"),
        (0.94999, "0.9499"),
        (0.9999, "0.9999"),
        (0.99996, "> 0.9999"),
        (1.0, "> 0.9999"),
        (math.nan, "–"),
    ],
)
def test_probability(value: float, printed: str) -> None:
    assert probability(value) == printed


@given(st.floats(0, 1))
def test_probability_never_promises_more_than_is_reached(value: float) -> None:
    printed = probability(value)
    if printed.startswith("<"):
        assert 0 < value < 0.0001
    else:
        # a value within 1e-10 of a step of the fourth digit is taken to be on it
        assert float(printed.removeprefix("> ")) <= value + 1e-10


@pytest.mark.parametrize(
    ("value", "down", "up"),
    [
        (0.94836, "0.9483", "0.9484"),
        (0.9483, "0.9483", "0.9483"),
        (0.012345, "0.01234", "0.01235"),
        (123.456, "123.4", "123.5"),
        (0.0, "0", "0"),
    ],
)
def test_a_limit_is_rounded_to_the_side_on_which_it_holds(value: float, down: str, up: str) -> None:
    assert (rounded(value), rounded(value, up=True)) == (down, up)


@given(st.floats(1e-6, 1e6))
@example(0.94836)
@example(9999.9)
def test_a_limit_that_is_printed_is_kept(value: float) -> None:
    """A billionth of the last digit apart, which a value on a digit may be off by."""
    off = 1e-12 * value
    assert value * (1 - 1e-3) - off <= float(rounded(value)) <= value + off
    assert value - off <= float(rounded(value, up=True)) <= value * (1 + 1e-3) + off


@pytest.mark.parametrize(
    ("value", "printed"),
    [(60.0, "60"), (25.4, "25.4"), (-0.05, "−0.05"), (100.0, "100"), (-1e-9, "0"), (math.nan, "–")],
)
def test_length(value: float, printed: str) -> None:
    assert length(value) == printed


@pytest.mark.parametrize(
    ("deviations", "printed"),
    [
        ((-0.1, 0.1), "±0.1"),
        ((-0.05, 0.1), "+0.1 / −0.05"),
        ((0.0, 0.08), "+0.08 / 0"),
        ((0.02, 0.08), "+0.08 / +0.02"),
        ((0.0, 0.0), "0 / 0"),
        (None, "–"),
    ],
)
def test_tolerance(deviations: tuple[float, float] | None, printed: str) -> None:
    assert tolerance(deviations) == printed


@pytest.mark.parametrize(
    ("requirement", "words"),
    [
        (Requirement("accuracy", 0.99, 0.95), "accuracy of at least 0.99"),
        (Requirement("error", 0.05, 0.95), "error of at most 0.05 mm"),
        (Requirement("fraction_of_tolerance", 0.1, 0.95), "error of at most 0.1 of the tolerance"),
    ],
)
def test_requirement(requirement: Requirement, words: str) -> None:
    assert requirement.text == f"{words}, with a probability of at least 0.95"


@pytest.mark.parametrize(
    ("requirement", "words"),
    [
        (
            CapabilityRequirement("percent_p_to_t", 0.1, sigmas=5.15),
            "P/T of at most 10 % (5.15 standard deviations over the tolerance zone)",
        ),
        (
            CapabilityRequirement("cg", 1.33),
            "Cg of at least 1.33 (20 % of the tolerance zone over 6 standard deviations)",
        ),
        (
            CapabilityRequirement("cgk", 1.33, bias_mm=-0.002),
            "Cgk of at least 1.33 (20 % of the tolerance zone over 6 standard deviations; bias: 0.002 mm)",
        ),
        (
            ConformanceRequirement("simple", Process(capability=1.33), producer_risk=0.02),
            "producer's risk of at most 2 %, by simple acceptance (shared risk); process capability Cp 1.33 (JCGM 106)",
        ),
        (
            ConformanceRequirement("guarded", Process(0.02, offset_mm=-0.005), consumer_risk=0.001, producer_risk=0.05),
            "consumer's risk of at most 0.1 % and producer's risk of at most 5 %, by guarded acceptance, w = 1 U; "
            "process standard deviation 0.02 mm, offset −0.005 mm (JCGM 106)",
        ),
    ],
)
def test_requirements_of_other_kinds(requirement: Requirement, words: str) -> None:
    assert requirement.text == words
