"""camera as a user meets it: told, written for OpenCV, refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from box_inspection import refused, write

from inspections import BOX
from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("folder")

KALIBR = """\
cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.21, 0.105, 0.0003, -0.0002]
  distortion_model: radtan
  intrinsics: [2801.25, 2799.75, 1012.5, 770.125]
  resolution: [2048, 1536]
  intrinsics_standard_deviations: [0.5, 0.6, 0.7, 0.8, 0.001, 0.002, 0.0003, 0.0004]
cam1:
  camera_model: pinhole
  intrinsics: [801.5, 802.5, 640.25, 480.75]
  resolution: [1280, 960]
"""


def test_a_calibration_is_reported_and_written(capsys):
    Path("chain.yaml").write_text(KALIBR)
    assert main(["camera", "chain.yaml", "--name", "cam0", "-o", "opencv.yaml"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "Kalibr: 2048 x 1536 px" in out
    assert "fx  2801.250 ± 0.500 px" in out
    assert "k2  0.105 ± 0.002" in out
    assert main(["camera", "opencv.yaml", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["format"] == "OpenCV"
    assert document["focal_length_px"] == [2801.25, 2799.75]
    assert list(document["distortion"].values()) == [-0.21, 0.105, 0.0003, -0.0002]
    assert document["standard_uncertainty"]["cy"] == pytest.approx(0.8)
    # k1 alone moves the farthest corner, 0.45 off the axis, by 0.21 * 0.45^3 * 2800 px; k2 takes a tenth back
    assert document["distortion_at_corner_px"] == pytest.approx(55, rel=0.15)


def test_the_camera_of_an_inspection(capsys):
    write(camera=BOX["camera"].replace("edge_detector", "distortion: [-0.1, 0, 0, 0], edge_detector"))
    assert main(["camera", "inspection.yaml", "-o", "deep.yaml"]) == 0
    assert "inspection file: 2448 x 2048 px" in capsys.readouterr().out
    write(camera="{calibration: deep.yaml, pixel_pitch: 3.45 um}")
    assert main(["camera", "inspection.yaml", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["focal_length_px"] == pytest.approx([16 / 0.00345] * 2, rel=1e-15)
    assert document["distortion"]["k1"] == -0.1


def test_what_cannot_be_used_is_reported(capsys):
    Path("chain.yaml").write_text(KALIBR)
    assert "the file has several cameras" in refused(capsys, "camera", "chain.yaml")
    assert "no such camera" in refused(capsys, "camera", "chain.yaml", "--name", "cam2")
    assert "does not exist" in refused(capsys, "camera", "none.yaml")
    write()
    assert "an inspection has one camera" in refused(capsys, "camera", "inspection.yaml", "--name", "cam0")
    Path("bad.yaml").write_text("camera: [1\n")
    assert "not valid YAML" in refused(capsys, "camera", "bad.yaml")
    assert "none" in refused(capsys, "camera", "chain.yaml", "--name", "cam1", "-o", "none/x.yaml")
