"""Implausible samples and boards of the shared cases: refused with their cause, and right ones as they are."""

from __future__ import annotations

import json

import numpy as np
import pytest

from cases.version_2 import CASES
from viewgauge.cli import main

FOLDER = CASES / "plausibility"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="../shared/cases is absent")


@pytest.mark.parametrize(
    ("name", "telling"),
    [
        ("metres_as_mm.csv", ("pose_positions", "metres")),
        ("metres_and_mm.csv", ("pose_pairs", "factor of 1000")),
        ("xyzw_and_wxyz.csv", ("pose_pairs", "order of the quaternion", "x y z w")),
        ("one_inverted.csv", ("pose_pairs", "inverse")),
        ("radians_as_degrees.csv", ("pose_rotation", "rad under the names of deg")),
        ("shifted_by_one.csv", ("rows_do_not_match", "after row 10")),
        ("../numbers_and_text/samples_with_a_huge_number.csv", (":2:dx_mm", "1e200")),
    ],
)
def test_refused(capsys, tmp_path, name, telling):
    out = tmp_path / "head.yaml"
    assert main(["characterize", str(FOLDER / name), "-o", str(out)]) == 2
    err = capsys.readouterr().err
    assert err.startswith("viewgauge: ")
    for words in telling:
        assert words in err
    assert not out.exists()


def test_right_keeps_its_values(capsys):
    assert main(["characterize", str(FOLDER / "right.csv"), "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    deviation = [axis["standard_deviation"] for axis in json.loads(printed.out)["axes"]]
    assert deviation[:3] == pytest.approx([0.0789, 0.0610, 0.0846], rel=5e-3)
    assert np.degrees(deviation[3:]) == pytest.approx([0.0126, 0.0145, 0.0168], rel=5e-3)


@pytest.mark.parametrize("name", ["inverted.csv", "xyzw_twice.csv"])
def test_what_the_numbers_cannot_show_is_read(capsys, name):
    assert main(["characterize", str(FOLDER / name)]) == 0
    capsys.readouterr()


def test_a_finding_is_accepted_by_name(capsys):
    given = ["characterize", str(FOLDER / "radians_as_degrees.csv"), "--accept", "pose_rotation"]
    assert main(given) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "telling"),
    [
        ("wrong_flag.yaml", ("hand_eye", "the camera is in the robot's hand")),
        ("wrong_square.yaml", ("board_scale", "the robot's travel says 2")),
    ],
)
def test_boards_refused(capsys, tmp_path, name, telling):
    pytest.importorskip("cv2", reason="OpenCV is not installed")
    out = tmp_path / "head.yaml"
    assert main(["characterize", str(FOLDER / "board" / name), "-o", str(out)]) == 2
    err = capsys.readouterr().err
    for words in telling:
        assert words in err
    assert not out.exists()


def test_the_right_board(capsys):
    pytest.importorskip("cv2", reason="OpenCV is not installed")
    assert main(["characterize", str(FOLDER / "board" / "right.yaml"), "--json"]) == 0
    printed = capsys.readouterr()
    document = json.loads(printed.out)
    assert printed.err == ""
    assert document["board"]["camera_matrix_px"][0][0] == pytest.approx(690, abs=1)
    deviation = np.array([axis["standard_deviation"] for axis in document["axes"]])
    assert ((deviation[:3] > 0.07) & (deviation[:3] < 0.26)).all()
    assert ((np.degrees(deviation[3:]) > 0.012) & (np.degrees(deviation[3:]) < 0.045)).all()
