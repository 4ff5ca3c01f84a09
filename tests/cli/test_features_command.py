"""From a part without PMI to a plan: check, features, edit, plan."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
import yaml

from inspections import CAMERA, POSE_UNCERTAINTY, sections
from viewgauge.cli.app import main
from viewgauge.exceptions import InspectionFileError

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "formats"))
from step_texts import plate_with_leaning_hole, write_shape

pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")
pytestmark = pytest.mark.usefixtures("folder")

REST = {
    "camera": CAMERA,
    "pose_uncertainty": POSE_UNCERTAINTY,
    "requirement": "{fraction_of_tolerance: 60 %, probability: 0.95}",
    "candidates": "{directions: 40, rolls: 2}",
}
HOLE = '{id: D1, diameter: H1, nominal: 8 mm, tolerance: "[0, 0.2] mm"}'
LENGTH = "{id: L1, distance: [F1, F6], nominal: 60 mm, tolerance: 0.3 mm}"


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    return write_shape(plate_with_leaning_hole(0.0), tmp_path_factory.mktemp("part") / "plate.step")


@pytest.fixture
def folder(plate, tmp_path, monkeypatch):
    (tmp_path / "plate.step").write_bytes(plate.read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(*entries: str, datums: str = "{}") -> None:
    lines = "".join(f"\n    - {entry}" for entry in entries)
    part = f"\n  file: plate.step\n  datums: {datums}\n  characteristics:{lines or ' []'}"
    Path("inspection.yaml").write_text(sections(part=part, **REST))


def test_from_geometry_to_a_plan(capsys):
    write()
    assert main(["check", "inspection.yaml"]) == 0
    checked = capsys.readouterr().out
    assert "60 x 40 x 10 mm (file in mm)" in checked
    assert "solids: 1" in checked
    assert "viewgauge features" in checked
    assert main(["plan", "inspection.yaml", "-o", "out"]) == 2
    assert "viewgauge features" in capsys.readouterr().err
    assert main(["features", "plate.step", "-o", "part.yaml"]) == 0
    printed = capsys.readouterr().out
    assert "1 hole:\n  H1: diameter 8, depth 10 mm; at [30, 20, 5] mm, axis [0, 0, 1]" in printed
    text = Path("part.yaml").read_text(encoding="utf-8")
    part = yaml.safe_load(text)["part"]
    assert part["file"] == "plate.step"
    sizes = [entry["nominal"] for entry in part["characteristics"]]
    assert sorted(sizes) == ["10 mm", "40 mm", "60 mm", "8 mm"]
    assert "# - {id: P1, position: H1, datums: [A, B, C]" in text
    Path("inspection.yaml").write_text(text.replace("tolerance: 0.3 mm", "tolerance: 0.4 mm") + sections(**REST))
    assert main(["plan", "inspection.yaml", "-o", "out", "--no-prove", "--no-refine"]) == 0
    document = json.loads(Path("out/plan.json").read_text(encoding="utf-8"))
    assert {entry["status"] for entry in document["characteristics"]} == {"met"}


def test_features_as_json(capsys):
    assert main(["features", "plate.step", "--propose", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["part"]["solids"] == 1
    kinds = {feature["id"][0]: feature["kind"] for feature in document["features"]}
    assert kinds == {"F": "plane", "E": "edge", "H": "hole"}
    assert {proposal["kind"] for proposal in document["proposals"]} == {"distance", "diameter", "position"}


def test_proposals_are_printed(capsys):
    assert main(["features", "plate.step", "--propose"]) == 0
    assert yaml.safe_load(capsys.readouterr().out)["part"]["datums"].keys() == {"A", "B", "C"}


def test_a_mesh_has_no_features(capsys):
    import trimesh

    trimesh.creation.box((60, 40, 20)).export("box.stl")
    assert main(["features", "box.stl"]) == 2
    message = capsys.readouterr().err
    assert "viewgauge: box.stl: a mesh has triangles and no features with ids" in message
    assert "points:" in message


def test_a_position_is_listed_and_not_an_error(capsys):
    position = '{id: P1, position: H1, datums: [A, B], basic: "[30, 20] mm", zone: 0.2 mm}'
    write(HOLE, position, datums="{A: F3, B: F1}")
    assert main(["check", "inspection.yaml", "--json"]) == 1
    hole, listed = json.loads(capsys.readouterr().out)["characteristics"]
    assert (hole["id"], hole["status"], hole["tolerance_mm"]) == ("D1", "measurable", [0.0, 0.2])
    assert (listed["id"], listed["kind"], listed["status"]) == ("P1", "position", "not_measurable")
    assert "not measured yet" in listed["reason"]


@pytest.mark.parametrize(
    ("entry", "datums", "telling"),
    [
        (HOLE.replace("8 mm", "8.2 mm"), "{}", ["nominal 8.2 mm", "H1 in the part's file 8 mm"]),
        (LENGTH.replace("60 mm", "6 cm").replace("F6", "H7"), "{}", ["H7", "F1 to F6"]),
        (HOLE, "{A: F77}", ["datum A", "F77"]),
        ("{id: P1, position: H1, datums: [A, C], zone: 0.2 mm}", "{A: F1}", ["datum C is not stated"]),
        ("{id: D1, diameter: H1, points: [[0, 0, 0], [1, 0, 0]], unit: mm}", "{}", ["points and diameter"]),
        ("{id: D1, diameter: H1, zone: 0.1 mm}", "{}", ["belongs to a position"]),
        ("{id: D1, nominal: 8 mm, tolerance: 0.1 mm}", "{}", ["belongs to a distance or a diameter"]),
        ("{id: P1, position: H1, tolerance: 0.1 mm}", "{}", ["a position has a zone"]),
    ],
)
def test_entries_that_cannot_be_used(capsys, entry, datums, telling):
    write(entry, datums=datums)
    assert main(["check", "inspection.yaml"]) == 2
    message = capsys.readouterr().err
    assert all(words in message for words in ["viewgauge: inspection.yaml", *telling]), message


def test_features_of_a_mesh_are_refused():
    import trimesh

    import viewgauge as vg

    trimesh.creation.box((60, 40, 20)).export("box.stl")
    write(LENGTH)
    with pytest.raises(InspectionFileError, match="features by ids need a STEP part"):
        vg.load("inspection.yaml", part="box.stl")
