"""The section requirement of the inspection file: its kinds, and what is said about one that cannot be used."""

import pytest

import inspections
from inspections import CAMERA_KEYS
from viewgauge.evaluation import CapabilityRequirement, ConformanceRequirement, Process, Requirement
from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.inspection.inspection_file import read_inspection_file

POSE_ERROR = (
    "part: {file: part.step}\ncamera:\n"
    + CAMERA_KEYS
    + f"pose_uncertainty: {inspections.POSE_UNCERTAINTY}\nrequirement:\n"
)
# the requirement begins in line 8

CAPABILITY = "  capability:\n    cg: 1.33\n"
CONFORMANCE = """\
  conformance:
    rule: guarded
    guard: 1
    process:
      standard_deviation: 20 um
      offset: -0.005 mm
    consumer_risk: 1 %
    producer_risk: 5 %
"""


def read(tmp_path, section):
    path = tmp_path / "inspection.yaml"
    path.write_text(POSE_ERROR + section)
    return read_inspection_file(path)


def changed(old, new, base=CONFORMANCE):
    return inspections.changed(old, new, base)


@pytest.mark.parametrize(
    ("section", "requirement"),
    [
        ("  {accuracy: 0.99, probability: 95 %}", Requirement("accuracy", 0.99, 0.95)),
        ("  {error: 50 um, probability: 0.95}", Requirement("error", 0.05, 0.95)),
        ("  {fraction_of_tolerance: 10 %, probability: 0.95}", Requirement("fraction_of_tolerance", 0.1, 0.95)),
        ("  capability: {percent_p_to_t: 10 %}", CapabilityRequirement("percent_p_to_t", 0.1)),
        (
            "  capability: {percent_p_to_t: 0.3, sigmas: 5.15}",
            CapabilityRequirement("percent_p_to_t", 0.3, sigmas=5.15),
        ),
        (CAPABILITY, CapabilityRequirement("cg", 1.33)),
        ("  capability: {cg: 1, share: 15 %, sigmas: 4}", CapabilityRequirement("cg", 1.0, sigmas=4.0, share=0.15)),
        ("  capability: {cgk: 1.33, bias: -2 um}", CapabilityRequirement("cgk", 1.33, bias_mm=-0.002)),
        (
            CONFORMANCE,
            ConformanceRequirement(
                "guarded", Process(0.02, offset_mm=-0.005), 1.0, consumer_risk=0.01, producer_risk=0.05
            ),
        ),
        (
            "  conformance: {rule: simple, process: {capability: 1.33}, producer_risk: 2 %}",
            ConformanceRequirement("simple", Process(capability=1.33), producer_risk=0.02),
        ),
        (
            "  conformance: {rule: guarded_rejection, guard: 0.5, process: {capability: 1}, consumer_risk: 0.01}",
            ConformanceRequirement("guarded_rejection", Process(capability=1.0), 0.5, consumer_risk=0.01),
        ),
    ],
)
def test_each_kind_is_read(tmp_path, section, requirement):
    assert read(tmp_path, section).setup.requirement == requirement


# section, line, key below requirement, part of the message
BAD = [
    ("  probability: 0.95\n", 7, "", "the requirement itself is missing"),
    ("  {error: 0.05 mm}", 7, ".probability", "required key missing"),
    (CAPABILITY + "  error: 0.05 mm\n", 8, ".capability", "more than one requirement"),
    (CAPABILITY + CONFORMANCE, 10, ".conformance", "more than one requirement"),
    (CAPABILITY + "  probability: 0.95\n", 10, ".probability", "the probability follows from the capability"),
    (CONFORMANCE + "  probability: 0.95\n", 16, ".probability", "remove probability: 0.9545 is implied"),
    ("  capability:\n", 8, ".capability", "the section is empty"),
    ("  capability: 1.33\n", 8, ".capability", "not a section of keys"),
    ("  capability: {sigmas: 6}\n", 8, ".capability", "the index itself is missing"),
    (CAPABILITY + "    cgk: 1.33\n", 10, ".capability.cgk", "exactly one of percent_p_to_t, cg, cgk"),
    (CAPABILITY + "    cpk: 1.33\n", 10, ".capability.cpk", "unknown key"),
    (CAPABILITY + "    share: 120 %\n", 10, ".capability.share", "such as 20 %"),
    (CAPABILITY + "    share: -20 %\n", 10, ".capability.share", "must be positive"),
    (CAPABILITY + "    bias: 0.002 mm\n", 10, ".capability.bias", "only Cgk takes a bias"),
    (CAPABILITY + "    bias: 0.002\n", 10, ".capability.bias", "the unit is missing"),
    (CAPABILITY + "    sigmas: 0.5\n", 10, ".capability.sigmas", "such as 6 or 5.15"),
    (changed("1.33", "0", CAPABILITY), 9, ".capability.cg", "must be positive"),
    (changed("1.33", "133 mm", CAPABILITY), 9, ".capability.cg", "'mm' makes no ratio"),
    ("  conformance:\n", 8, ".conformance", "the section is empty"),
    (changed("guarded", "shared"), 9, ".conformance.rule", "'simple', 'guarded' or 'guarded_rejection'"),
    (changed("    rule: guarded\n", ""), 8, ".conformance.rule", "simple, guarded or guarded_rejection"),
    (changed("guard: 1", "guard: 0"), 10, ".conformance.guard", "must be positive"),
    (changed("guard: 1", "guard: 100"), 10, ".conformance.guard", "a multiple of U"),
    (changed("rule: guarded", "rule: simple"), 10, ".conformance.guard", "simple acceptance has no guard band"),
    (changed("1 %", "-1 %"), 14, ".conformance.consumer_risk", "must be positive"),
    (changed("5 %", "100 %"), 15, ".conformance.producer_risk", "between 0 and 1"),
    (changed("    consumer_risk: 1 %\n    producer_risk: 5 %\n", ""), 8, ".conformance", "no risk is limited"),
    (
        changed("      standard_deviation: 20 um\n", ""),
        11,
        ".conformance.process",
        "the spread of the process is missing",
    ),
    (changed("offset: -0.005 mm", "capability: 1.33"), 13, ".conformance.process.capability", "stated twice"),
    (changed("20 um", "0 um"), 12, ".conformance.process.standard_deviation", "must be positive"),
    (changed("20 um", "20"), 12, ".conformance.process.standard_deviation", "the unit is missing"),
    (changed("-0.005 mm", "5 %"), 13, ".conformance.process.offset", "'%' is not a unit of length"),
    (
        "  conformance: {rule: simple, producer_risk: 1 %}\n",
        8,
        ".conformance.process",
        "standard_deviation or capability",
    ),
    ("  conformance: {rule: simple, process: 1.33, producer_risk: 1 %}\n", 8, ".conformance.process", "not a section"),
]


@pytest.mark.parametrize(("section", "line", "key", "message"), BAD)
def test_what_cannot_be_used_is_reported_where_it_stands(tmp_path, section, line, key, message):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, section)
    assert (caught.value.line, caught.value.key) == (line, f"requirement{key}")
    assert message in str(caught.value)


def test_all_problems_are_reported_at_once(tmp_path):
    section = changed("20 um", "20").replace("1 %", "-1 %").replace("rule: guarded", "rule: none") + "  zzz: 1\n"
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, section)
    for key in ("conformance.rule", "conformance.process.standard_deviation", "conformance.consumer_risk", "zzz"):
        assert f"requirement.{key}: " in str(caught.value)
