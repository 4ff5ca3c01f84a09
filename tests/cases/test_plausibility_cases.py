"""Quantities that hardly any camera, robot or part has are questioned, by name, and accepted by that name."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import trimesh
from version_2 import CASES, copy_case

import viewgauge as vg
from viewgauge.cli import main
from viewgauge.findings import NAMES, Finding, admit, require_known

INSPECTION = """part:
  file: box.stl
  characteristics:
    - {id: width, points: [[0, 0, 30], [70, 0, 30]], unit: mm, tolerance: 0.1 mm}
    - {id: depth, points: [[0, 0, 30], [0, 45, 30]], unit: mm, tolerance: 0.1 mm}
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um
  resolution: [2448, 2048]
  edge_detector: {quantization: 0.1 px}
pose_uncertainty:
  translation: 0.1 mm
  rotation: 0.02 deg
requirement:
  fraction_of_tolerance: 60 %
  probability: 0.95
candidates:
  directions: 20
"""

IMPLAUSIBLE = [
    ("translation: 0.1 mm", "translation: 0.0001 mm", "pose_translation"),
    ("translation: 0.1 mm", "translation: 50 mm", "pose_translation"),
    ("translation: 0.1 mm", "translation: 0 mm", "pose_translation"),
    ("rotation: 0.02 deg", "rotation: 0.0002 deg", "pose_rotation"),
    ("rotation: 0.02 deg", "rotation: 20 deg", "pose_rotation"),
    ("rotation: 0.02 deg", "rotation: 0 deg", "pose_rotation"),
    ("rotation: 0.02 deg", "rotation: 0.02 deg\n  frame: {position: '[0, 0, 9] m'}", "frame_position"),
    ("pixel_pitch: 3.45 um", "pixel_pitch: 3.45 nm", None),
    ("pixel_pitch: 3.45 um", "pixel_pitch: 345 um", "pixel_pitch"),
    ("pixel_pitch: 3.45 um", "pixel_pitch: '[3.45, 34.5] um'", "pixel_shape"),
    ("focal_length: 16 mm", "focal_length: 0.16 mm", "focal_length"),
    ("focal_length: 16 mm", "focal_length: 1.6 m", "field_of_view"),
    ("resolution: [2448, 2048]", "resolution: [100, 90]", "sensor_size"),
    ("resolution: [2448, 2048]", "resolution: [4096, 100]", "image_shape"),
    ("focal_length: 16 mm", "focal_length: 16 mm\n  principal_point: '[300, 1024] px'", "principal_point"),
    ("focal_length: 16 mm", "focal_length: 16 mm\n  f_number: 0.1\n  focus_distance: 300 mm", "f_number"),
    ("focal_length: 16 mm", "focal_length: 16 mm\n  f_number: 8\n  focus_distance: 20 mm", "focus_distance"),
    ("focal_length: 16 mm", "focal_length: 16 mm\n  blur_limit: 100 px", "blur_limit"),
    ("quantization: 0.1 px", "quantization: 0 px", "edge_detector"),
    ("quantization: 0.1 px", "quantization: 50 px", "edge_detector"),
    ("probability: 0.95", "probability: 0.05", "probability"),
    ("fraction_of_tolerance: 60 %", "error: 0.3 mm", "allowed_error_above_tolerance"),
    ("fraction_of_tolerance: 60 %", "error: 1 nm", "allowed_error_small"),
    ("tolerance: 0.1 mm", "tolerance: 100 mm", "tolerance_size"),
    ("directions: 20", "directions: 20\n  distance: 5 mm", "candidate_distance"),
    ("directions: 20", "directions: 20\n  distance: 100 m", "candidate_distance"),
    ("directions: 20", "directions: 20\n  distance: '[3, 6] m'\nobservation: {minimum_length: 200 px}", "nothing_fits"),
    ("candidates:", "observation: {margin: 1100 px}\ncandidates:", "margin"),
    ("candidates:", "observation: {minimum_length: 5000 px}\ncandidates:", "minimum_length"),
    ("candidates:", "observation: {grazing_angle: 80 deg}\ncandidates:", "grazing_angle"),
    (
        "focal_length: 16 mm",
        "focal_length: 16 mm\n  f_number: 2\n  focus_distance: 300 mm\ncandidates: {distance: 3 m}",
        "out_of_focus",
    ),
]


@pytest.fixture
def folder(tmp_path):
    box = trimesh.creation.box(extents=(70, 45, 30))
    box.apply_translation([35, 22.5, 15])
    box.export(tmp_path / "box.stl")
    return tmp_path


def load(folder: Path, text: str = INSPECTION) -> vg.Inspection:
    (folder / "inspection.yaml").write_text(text)
    return vg.load(folder / "inspection.yaml")


def names(inspection: vg.Inspection) -> list[str]:
    return [finding.name for finding in inspection.findings]


def test_what_is_usual_has_no_finding(folder):
    assert load(folder).findings == ()


@pytest.mark.parametrize(("old", "new", "name"), [case for case in IMPLAUSIBLE if case[2]])
def test_each_implausible_quantity_has_its_finding_and_is_accepted_by_name(folder, old, new, name):
    assert old in INSPECTION
    text = INSPECTION.replace(old, new)
    if text.count("candidates:") > 1:
        text = text.replace("candidates:\n  directions: 20\n", "").replace("\ncandidates: {distance: 3 m}", "")
        text += "candidates: {distance: 3 m}\n"
    found = load(folder, text)
    assert name in names(found)
    assert name in NAMES
    assert name not in names(load(folder, text + f"accept: [{', '.join(sorted(set(names(found))))}]\n"))


def test_a_line_is_no_picture_unless_it_is_accepted(folder):
    text = INSPECTION.replace("[2448, 2048]", "[4096, 1]")
    with pytest.raises(vg.InputError, match=r"one line.*line_scan"):
        load(folder, text)
    load(folder, text + "accept: [line_scan]\n")


def test_an_unknown_name_is_an_error_that_lists_the_known_ones(folder):
    with pytest.raises(vg.InputError, match=r"(?s)linescan.*line_scan"):
        load(folder, INSPECTION + "accept: [linescan]\n")


def test_a_finding_that_others_make_can_be_accepted():
    strange = Finding("strange", "it is strange")
    require_known(["strange"], [strange])
    assert admit([strange], ["strange"]) == ()


@pytest.mark.parametrize("angle", ["91 deg", "180 deg", "3 rad"])
def test_a_grazing_angle_beyond_90_deg_is_an_error(folder, angle):
    with pytest.raises(vg.InputError, match="0 to 90 deg"):
        load(folder, INSPECTION + f"observation: {{grazing_angle: {angle}}}\n")


def test_commands_show_findings(folder, capsys):
    (folder / "inspection.yaml").write_text(INSPECTION.replace("translation: 0.1 mm", "translation: 0.0001 mm"))
    assert main(["check", str(folder / "inspection.yaml"), "--json"]) == 0
    out, err = capsys.readouterr()
    assert err.startswith("viewgauge: warning: pose_uncertainty.translation: ")
    assert [finding["name"] for finding in json.loads(out)["findings"]] == ["pose_translation"]
    arguments = ["plan", str(folder / "inspection.yaml"), "-o", str(folder / "out"), "--no-prove", "--no-refine"]
    assert main(arguments) in (0, 1)
    assert "[pose_translation]" in capsys.readouterr().err
    document = json.loads((folder / "out" / "plan.json").read_text())
    assert [finding["name"] for finding in document["findings"]] == ["pose_translation"]
    assert "[pose_translation]" in (folder / "out" / "report.html").read_text()


# --- viewpoints -----------------------------------------------------------------------------------------------------

DOWN = (35.0, 22.5, 400.0, 0.0, 1.0, 0.0, 0.0)  # above the box, looking down: a half turn about x


def viewpoints(folder: Path, *rows: tuple[float, ...]) -> Path:
    lines = [",".join([f"V{k}", *map(repr, row)]) for k, row in enumerate(rows)]
    (folder / "v.csv").write_text("id,x,y,z,qw,qx,qy,qz\n" + "\n".join(lines) + "\n")
    return folder / "v.csv"


def test_a_viewpoint_in_metres_is_inside_the_part(folder):
    metres = (0.035, 0.0225, 0.4, *DOWN[3:])
    text = INSPECTION.replace("directions: 20", f"viewpoints: {viewpoints(folder, DOWN, metres).name}")
    with pytest.raises(vg.InputError, match=r"inside the part at V1.*in m"):
        load(folder, text)
    load(folder, text + "accept: [viewpoint_inside_part]\n")


def test_a_viewpoint_that_looks_away_has_its_cause(folder):
    backwards = (*DOWN[:3], 1.0, 0.0, 0.0, 0.0)
    text = INSPECTION.replace("directions: 20", f"viewpoints: {viewpoints(folder, backwards).name}")
    (finding,) = load(folder, text).findings
    assert finding.name == "viewpoint_looks_away"
    assert finding.cause


def test_viewpoints_given_by_an_option_are_looked_at_too(folder, capsys):
    metres = (0.035, 0.0225, 0.4, *DOWN[3:])
    (folder / "inspection.yaml").write_text(INSPECTION)
    given = ["evaluate", str(folder / "inspection.yaml"), "--viewpoints", str(viewpoints(folder, metres))]
    assert main(given) == 2
    assert "[viewpoint_inside_part]" in capsys.readouterr().err


# --- shared cases ---------------------------------------------------------------------------------------------------

SHARED = {
    "grazing_180deg": (2, "90 deg"),
    "grazing_270deg": (2, "90 deg"),
    "grazing_5rad": (2, "90 deg"),
    "line_scan": (2, "[line_scan]"),
    "head_in_metres": (0, "[pose_translation]"),
    "met_but_not_capable": (0, "[allowed_error_above_tolerance]"),
}


@pytest.mark.skipif(not CASES.is_dir(), reason="the shared cases are not beside the checkout")
@pytest.mark.parametrize("name", sorted(SHARED))
def test_shared_cases(name, tmp_path, capsys):
    code, telling = SHARED[name]
    assert main(["check", str(copy_case(CASES / "plausibility" / f"{name}.yaml", tmp_path))]) == code
    err = capsys.readouterr().err
    assert err.startswith("viewgauge: ")
    assert telling in err


def test_every_finding_is_named_on_the_page_and_in_the_table():
    root = Path(__file__).resolve().parents[2]
    page = (root / "docs" / "howto" / "findings.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(\w+)` \|", page, flags=re.M)) == NAMES.keys()
    made = set()
    for file in (root / "src").rglob("*.py"):
        made |= set(re.findall(r"\b(?:Finding|UsualRange)\(\s*\"(\w+)\"", file.read_text(encoding="utf-8")))
    assert made <= NAMES.keys()
