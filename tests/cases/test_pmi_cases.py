"""What the PMI of real files holds: every toleranced record ends as a characteristic or with the reason why not."""

from __future__ import annotations

import json
from collections import Counter
from functools import cache

import pytest

import viewgauge as vg
from cases.version_2 import CASES, version_2
from viewgauge.cli.app import main
from viewgauge.exceptions import InspectionFileError

pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")
FOLDER = CASES / "pmi"
NIST = CASES.parent / "data" / "nist"
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason=f"the cases are not in {CASES}")

PLAIN = {"E1": 84.0, "E2": 28.0, "E3": 7.0, "E4": 16.0}
FOUR = {"flatness": 1, "position": 1, "surface_profile": 1, "perpendicularity": 1}


@pytest.fixture(scope="module")
def inspection_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("pmi") / "inspection.yaml"
    path.write_text(version_2((FOLDER / "inspection.yaml").read_text()))
    return path


@pytest.fixture(scope="module")
def loaded(inspection_file):
    return cache(lambda name: vg.load(inspection_file, part=FOLDER / f"{name}.step"))


@pytest.fixture(scope="module")
def checked(loaded):
    return cache(lambda name: vg.check(loaded(name)))


def entries(document, status=None):
    return {e["id"]: e for e in document["characteristics"] if status is None or e["status"] == status}


def assert_counted(document):
    """The distinct records of each kind are as many as the text has."""
    records = {(e["kind"], e["record"]) for e in document["characteristics"] if e["toleranced"]}
    assert Counter(kind for kind, _ in records) == document["counts"]
    features = Counter(e["record"] for e in document["characteristics"])
    assert all(e["features"] == features[e["record"]] for e in document["characteristics"])
    assert all(bool(e["reason"]) == (e["status"] != "measurable") for e in document["characteristics"])


def test_a_plain_file_is_measurable_whole(checked):
    document = checked("plain")
    assert_counted(document)
    found = entries(document, "measurable")
    assert {name: e["nominal"] for name, e in found.items()} == {**PLAIN, "E5/1": 9.0, "E5/2": 9.0}
    assert not document["not_measurable"]
    assert (found["E2"]["lower"], found["E2"]["upper"]) == pytest.approx((27.92, 28.12))
    assert found["E1"]["text"] == "distance 84 ±0.08"


def test_geometric_tolerances_are_listed_and_forbid_success(checked, inspection_file, capsys):
    document = checked("geometric_tolerances")
    assert_counted(document)
    assert {kind: document["counts"][kind] for kind in FOUR} == FOUR
    texts = {e["text"] for e in document["not_measurable"]}
    assert texts == {
        "flatness 0.03",
        "position diameter 0.15 | A | B | C",
        "surface profile 0.2 | A",
        "perpendicularity 0.05 | A",
    }
    positions = [e for e in document["not_measurable"] if e["kind"] == "position"]
    assert [e["datums"] for e in positions] == [["A", "B", "C"]] * 2
    assert [e["zone"] for e in positions] == pytest.approx([0.15] * 2)
    assert main(["check", str(inspection_file), "--part", str(FOLDER / "geometric_tolerances.step")]) == 1
    assert "position diameter 0.15 | A | B | C; a position tolerance is not yet measured" in capsys.readouterr().out


def test_geometric_tolerances_alone_are_named_and_planned_as_open(loaded, checked):
    document = checked("only_geometric_tolerances")
    assert_counted(document)
    assert document["counts"] == FOUR
    assert {e["kind"] for e in document["characteristics"]} == set(FOUR)
    plan = vg.plan(loaded("only_geometric_tolerances"))
    assert not plan.all_met
    assert Counter(d.status for d in plan.characteristics) == {"not_measurable": 3, "out_of_scope": 2}
    assert all(d.limit and d.indication.text for d in plan.characteristics)


def test_graphical_pmi_alone_is_said(loaded):
    with pytest.raises(InspectionFileError, match="graphical PMI") as caught:
        loaded("graphical_only")
    assert "no semantic PMI" in str(caught.value)


def test_a_depth_on_a_pattern_is_measured_on_each_slot(loaded, checked):
    assert_counted(checked("pattern_depth"))
    found = {d.id: d for d in loaded("pattern_depth").part.characteristics}
    assert {"E6/1", "E6/2"} <= set(found)
    floors = [{round(min(m.start[2], m.end[2]), 6) for m in found[f"E6/{k}"].measurands} for k in (1, 2)]
    assert floors == [{23.0}, {23.0}]
    places = [{tuple(m.points.mean(axis=0).round(3)) for m in found[f"E6/{k}"].measurands} for k in (1, 2)]
    assert not places[0] & places[1]


def test_every_instance_has_its_own_characteristics(loaded, checked):
    assert_counted(checked("two_instances"))
    found = {d.id: d for d in loaded("two_instances").part.characteristics}
    assert len(found) == 12
    assert set(found) == {f"{name}/{k}" for name in PLAIN for k in (1, 2)} | {f"E5/{k}" for k in range(1, 5)}
    for name in PLAIN:
        ends = [{tuple(m.points.ravel().round(3)) for m in found[f"{name}/{k}"].measurands} for k in (1, 2)]
        assert not ends[0] & ends[1]
    for characteristic in found.values():
        for measurand in characteristic.measurands:
            assert measurand.length_mm == pytest.approx(characteristic.nominal_mm, abs=1e-6)


def test_a_distance_from_an_axis_to_a_face_is_listed_with_its_reason(checked):
    document = checked("hole_to_edge")
    assert_counted(document)
    entry = entries(document)["E7"]
    assert (entry["nominal"], entry["lower"], entry["upper"]) == pytest.approx((14.0, 13.9, 14.1))
    assert entry["status"] == "measurable" or "an axis has no visible edge" in entry["reason"]


def test_a_distance_between_two_axes_is_measurable(checked):
    assert entries(checked("hole_to_hole"), "measurable")["E8"]["nominal"] == 24.0


def test_radii_and_angles_are_listed_for_each_feature(checked):
    document = checked("radius")
    assert_counted(document)
    radii = [e for e in document["characteristics"] if e["kind"] == "radius"]
    assert [(e["id"], e["nominal"], e["text"]) for e in radii] == [(f"E9/{k}", 6.0, "radius 6 ±0.2") for k in (1, 2)]
    assert all(e["reason"] for e in radii)
    document = checked("angle")
    assert_counted(document)
    angle = entries(document)["E10"]
    assert (angle["unit"], bool(angle["reason"])) == ("deg", True)


def test_an_angle_whose_unit_is_wrong_is_questioned(loaded):
    (finding,) = loaded("angle").part.findings
    assert finding.name == "angle_of_the_part"
    assert "1.2 deg" in finding.found
    assert "radian" in finding.cause


def test_an_average_is_no_two_point_diameter(checked):
    document = checked("average_diameter")
    assert_counted(document)
    found = [e for e in document["characteristics"] if e["kind"] == "diameter"]
    assert [e["status"] for e in found] == ["not_measurable"] * 2
    assert all("average" in e["reason"] and e["modifiers"] == ["average"] for e in found)


def test_a_maximum_is_a_one_sided_limit(checked):
    document = checked("maximum_diameter")
    assert_counted(document)
    found = [e for e in document["characteristics"] if e["kind"] == "diameter"]
    assert [(e["lower"], e["upper"], e["text"]) for e in found] == [(None, 9.0, "diameter at most 9")] * 2
    assert all("one-sided" in e["reason"] and "no tolerance" not in e["reason"] for e in found)


def test_a_tolerance_class_has_its_limits(checked):
    document = checked("limits_and_fits")
    assert_counted(document)
    found = [e for e in entries(document, "measurable").values() if e["kind"] == "diameter"]
    assert [(e["lower"], e["upper"]) for e in found] == [pytest.approx((9.0, 9.015))] * 2
    assert found[0]["text"] == "diameter 9 H7 (+0.015 / 0)"


def test_a_size_that_is_a_datum_feature_too_is_read_on_its_face(checked):
    document = checked("size_with_datum_feature")
    assert_counted(document)
    entry = entries(document, "measurable")["E5"]
    assert (entry["kind"], entry["nominal"]) == ("diameter", 9.0)


@pytest.mark.parametrize("name", ["zero_width", "one_value_twice"])
def test_a_zone_without_width_is_a_finding(loaded, checked, name):
    (finding,) = loaded(name).part.findings
    assert finding.name == "tolerance_without_width"
    assert "E1" in finding.found
    assert "no width" in finding.found
    assert entries(checked(name))["E1"]["status"] == "not_measurable"
    assert_counted(checked(name))


def test_the_plan_lists_what_it_does_not_measure(inspection_file, tmp_path, capsys):
    arguments = [str(inspection_file), "--part", str(FOLDER / "geometric_tolerances.step")]
    assert main(["plan", *arguments, "-o", str(tmp_path / "out"), "--no-refine", "--no-prove"]) == 1
    out = capsys.readouterr().out
    assert "not measurable  perpendicularity_9: perpendicularity 0.05 | A" in out
    assert "out of scope    flatness_6: flatness 0.03" in out
    document = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert Counter(e["status"] for e in document["characteristics"]) == {
        "met": 6,
        "not_measurable": 3,
        "out_of_scope": 2,
    }
    assert {e["record"] for e in document["characteristics"]} == {1270, 1305, 1331, 1357, 1386, 1408, 1421, 1432, 1438}
    page = (tmp_path / "out" / "report.html").read_text()
    assert "position diameter 0.15 | A | B | C" in page
    assert "out of scope" in page


# --- the NIST parts ---------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not list(NIST.glob("nist_ctc_*.stp")), reason=f"the NIST files are not in {NIST}")
def test_all_records_of_the_nist_parts_are_accounted_for(inspection_file):
    dimensions = geometric = 0
    for path in sorted(NIST.glob("nist_ctc_*.stp")):
        document = vg.check(vg.load(inspection_file, part=path))
        assert_counted(document)
        own = sum(n for kind, n in document["counts"].items() if kind in ("angle", "diameter", "distance", "length"))
        dimensions += own
        geometric += sum(document["counts"].values()) - own
    assert (dimensions, geometric) == (32, 58)
