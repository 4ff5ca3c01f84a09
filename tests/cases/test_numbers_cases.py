"""Numbers and texts that no inspection holds end with one message; texts that spreadsheets compute do no harm."""

from __future__ import annotations

import csv
import io
import json
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from version_2 import CASES, copy_case, version_2

import viewgauge as vg
from viewgauge.cli import main
from viewgauge.formats.files.physical_bounds import BOUNDS, bounds_of
from viewgauge.formats.files.spreadsheet_text import from_cell, to_cell
from viewgauge.formats.poses.viewpoints_file import read_viewpoints, write_viewpoints

INSPECTION = """part:
  file: box.stl
  characteristics:
    - {id: width, points: [[0, 0, 30], [70, 0, 30]], unit: mm, tolerance: 0.1 mm}
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um
  resolution: [2448, 2048]
  principal_point: "[1224, 1024] px"
  f_number: 8
  focus_distance: 300 mm
  blur_limit: 2 px
  distortion: [0.1, 0, 0, 0, 0]
  edge_detector: {signal_to_noise: 50, blur: 0.7 px, offset: 0.01 px}
pose_uncertainty:
  translation: 0.1 mm
  rotation: 0.02 deg
  frame: {position: "[0, 0, -16] mm"}
requirement:
  error: 0.09 mm
  probability: 0.95
observation: {margin: 8 px, minimum_length: 16 px, grazing_angle: 10 deg}
candidates:
  directions: 20
  standoff: 50 mm
  box: {lowest: "[-999, -999, -999] mm", highest: "[999, 999, 999] mm"}
"""

QUANTITIES = [
    *("focal_length: 16 mm", "pixel_pitch: 3.45 um", "f_number: 8", "focus_distance: 300 mm", "blur_limit: 2 px"),
    *("distortion: [0.1", "signal_to_noise: 50", "blur: 0.7 px", "offset: 0.01 px", "translation: 0.1 mm"),
    *("rotation: 0.02 deg", 'position: "[0, 0, -16', "error: 0.09 mm", "probability: 0.95", "margin: 8 px"),
    *("minimum_length: 16 px", "grazing_angle: 10 deg", "standoff: 50 mm", "points: [[0", "tolerance: 0.1 mm"),
    *('highest: "[999', 'principal_point: "[1224'),
]
HUGE = ["1e308", "9" * 400, "1e100"]


@pytest.fixture
def folder(tmp_path):
    box = trimesh.creation.box(extents=(70, 45, 30))
    box.apply_translation([35, 22.5, 15])
    box.export(tmp_path / "box.stl")
    return tmp_path


def load(folder: Path, text: str) -> vg.Inspection:
    (folder / "inspection.yaml").write_text(text)
    return vg.load(folder / "inspection.yaml")


def test_the_inspection_that_the_others_change_is_right(folder):
    load(folder, INSPECTION)


@pytest.mark.parametrize("number", HUGE, ids=["1e308", "400 digits", "1e100"])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_huge_number_is_an_error_without_a_warning_before_it(folder, quantity, number):
    assert INSPECTION.count(quantity) == 1
    place = next(k for k in range(len(quantity) - 1, -1, -1) if quantity[k] in ": [,") if "[" in quantity else None
    start = quantity.index(": ") + 2 if place is None else max(quantity.rfind(mark) for mark in "[ ") + 1
    end = start
    while end < len(quantity) and quantity[end] in "0123456789.-":
        end += 1
    changed = quantity[:start] + number + quantity[end:]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(vg.InputError):
            load(folder, INSPECTION.replace(quantity, changed))


@pytest.mark.parametrize("quantity", ["focal_length: 16", "pixel_pitch: 3.45", "focus_distance: 300"])
def test_a_vanishing_number_is_an_error(folder, quantity):
    with pytest.raises(vg.InputError, match="too small"):
        load(folder, INSPECTION.replace(quantity, quantity.split(":")[0] + ": 1e-320"))


@pytest.mark.parametrize("path", ["camera.focal_length", "requirement.error", "candidates.standoff"])
def test_every_section_has_bounds(path):
    assert bounds_of(tuple(path.split("."))) is not None


def test_bounds_are_in_order():
    assert all(0 <= bounds.least < bounds.most < np.inf and bounds.reason for bounds in BOUNDS.values())


@pytest.mark.parametrize("text", [r'"\ud800"', r'"a\0b"', r'"x\udfffy"'])
@pytest.mark.parametrize("place", ["id: width", "focal_length: 16 mm", "file: box.stl"])
def test_texts_that_no_file_can_hold_are_errors(folder, text, place):
    with pytest.raises(vg.InputError, match="text holds"):
        load(folder, INSPECTION.replace(place, f"{place.split(':')[0]}: {text}"))


def test_a_name_of_300_letters_is_an_error(folder):
    text = INSPECTION.replace("translation: 0.1 mm\n  rotation: 0.02 deg", f"covariance: {'a' * 300}.yaml")
    with pytest.raises(vg.InputError, match="cannot be read"):
        load(folder, text)


def test_escape_codes_are_printed_as_text(folder, capsys):
    (folder / "inspection.yaml").write_text(INSPECTION.replace("id: width", r'id: "\e[31mred\e]0;title\a\x9b31m"'))
    assert main(["check", str(folder / "inspection.yaml")]) == 0
    out, err = capsys.readouterr()
    assert r"\x1b[31mred" in out
    assert not {"\x1b", "\x07", "\x9b"} & {*(out + err)}


# --- spreadsheets ---------------------------------------------------------------------------------------------------

FORMULAS = ['=HYPERLINK("http://localhost/","x")', "+1", "-1", "@SUM(1,2)", "\tx", "'=1", "''=1", "'quoted'", "E1", ""]


@pytest.mark.parametrize("text", FORMULAS)
def test_a_cell_is_no_formula_and_reads_back(text):
    assert not to_cell(text).startswith(("=", "+", "-", "@", "\t", "\r"))
    assert from_cell(to_cell(text)) == text


def test_viewpoints_named_as_formulas_read_back(tmp_path):
    ids = [name for name in FORMULAS if name.strip() == name and name]
    write_viewpoints(tmp_path / "v.csv", ids, np.broadcast_to(np.eye(4), (len(ids), 4, 4)))
    assert read_viewpoints(tmp_path / "v.csv")[0] == tuple(ids)


def plan_csv(inspection: Path, out: Path) -> list[list[str]]:
    assert main(["plan", str(inspection), "-o", str(out), "--no-prove", "--no-refine"]) == 0
    return list(csv.reader(io.StringIO((out / "assignments.csv").read_text())))


def test_assignments_hold_no_formula(folder):
    text = INSPECTION[: INSPECTION.index("  principal_point")] + "  edge_detector: {quantization: 0.1 px}\n"
    text += INSPECTION[INSPECTION.index("pose_uncertainty") : INSPECTION.index("  standoff")]
    (folder / "inspection.yaml").write_text(text.replace("id: width", 'id: "=1+1"'))
    rows = plan_csv(folder / "inspection.yaml", folder / "out")
    assert rows[1][0] == "'=1+1"
    assert json.loads((folder / "out" / "plan.json").read_text())["characteristics"][0]["id"] == "=1+1"


@pytest.mark.parametrize("cell", ["1e200", "-1e308", "inf"])
def test_a_huge_number_among_viewpoints_is_named_with_its_line(tmp_path, cell):
    (tmp_path / "v.csv").write_text(f"id,x,y,z,qw,qx,qy,qz\nA,0,0,500,1,0,0,0\nB,{cell},0,500,1,0,0,0\n")
    with pytest.raises(vg.InputError, match=r"v\.csv:3"):
        read_viewpoints(tmp_path / "v.csv")


# --- shared cases ---------------------------------------------------------------------------------------------------

ERRORS = [
    *("huge_pixel_pitch", "huge_focal_length", "tiny_focal_length", "huge_standoff", "huge_focus_distance"),
    *("huge_error", "huge_signal_to_noise", "huge_pivot", "f_number_400_digits", "covariance"),
    *("surrogate_in_quantity", "surrogate_in_id", "name_of_300_letters"),
]
needs_cases = pytest.mark.skipif(not CASES.is_dir(), reason="the shared cases are not beside the checkout")


@needs_cases
@pytest.mark.parametrize("name", ERRORS)
@pytest.mark.parametrize("command", ["check", "plan"])
def test_shared_cases_end_with_a_message(name, command, tmp_path, capsys):
    file = str(copy_case(CASES / "numbers_and_text" / f"{name}.yaml", tmp_path))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert main([command, file, *(["-o", str(tmp_path / "out")] if command == "plan" else [])]) == 2
    assert capsys.readouterr().err.startswith("viewgauge: ")


@needs_cases
@pytest.mark.parametrize("name", ["camera_400_digits.yaml"])
def test_a_camera_of_400_digits(name, capsys):
    assert main(["camera", str(CASES / "numbers_and_text" / name)]) == 2
    assert capsys.readouterr().err.startswith("viewgauge: ")


@needs_cases
def test_a_sample_with_a_huge_number_is_named_with_its_row(capsys):
    assert main(["characterize", str(CASES / "numbers_and_text" / "samples_with_a_huge_number.csv")]) == 2
    text = (CASES / "numbers_and_text" / "samples_with_a_huge_number.csv").read_text().splitlines()
    line = next(k for k, row in enumerate(text, start=1) if "e200" in row)
    assert f".csv:{line}:" in capsys.readouterr().err


@needs_cases
def test_shared_texts(tmp_path, capsys):
    assert main(["check", str(copy_case(CASES / "numbers_and_text" / "control.yaml", tmp_path))]) == 0
    capsys.readouterr()
    assert main(["check", str(copy_case(CASES / "numbers_and_text" / "escape_in_id.yaml", tmp_path))]) == 0
    assert "\x1b" not in capsys.readouterr().out
    formulas = tmp_path / "formulas.yaml"
    formulas.write_text(version_2((CASES / "numbers_and_text" / "formulas_as_ids.yaml").read_text()))
    rows = plan_csv(formulas, tmp_path / "out")
    assert not [cell for row in rows for cell in row if cell.startswith(("=", "+", "-", "@"))]
