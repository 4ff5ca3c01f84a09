"""convert as a user meets it: camera files in the formats of other programs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from box_inspection import refused, write

from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("folder")

FISHEYE = "K: [[770, 0, 969], [0, 770, 533], [0, 0, 1]]\nD: [[0.01], [-0.005], [-0.003], [-0.0004]]\n"


def test_a_camera_file_goes_to_another_program_and_back(capsys):
    Path("k_d.yaml").write_text(FISHEYE)
    stated = ["--model", "fisheye", "--size", "1920x1080"]
    assert main(["convert", "k_d.yaml", "-o", "cameras.txt", "--as", "colmap", *stated]) == 0
    assert capsys.readouterr().out == "OpenCV, written as COLMAP to cameras.txt\n"
    assert "1 OPENCV_FISHEYE 1920 1080 770.0 770.0 969.5 533.5" in Path("cameras.txt").read_text()
    assert main(["convert", "cameras.txt", "-o", "chain.yaml", "--as", "kalibr", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["source"], document["target"], document["findings"]) == ("COLMAP", "Kalibr", [])
    assert document["principal_point_px"] == [969.0, 533.0]
    assert main(["convert", "chain.yaml", "-o", "opencv.yaml"]) == 0
    assert "fisheye_model: 1" in Path("opencv.yaml").read_text()


def test_the_camera_of_an_inspection_and_what_is_not_written(capsys):
    write()
    assert main(["convert", "inspection.yaml", "-o", "camera_info.yaml", "--as", "ros"]) == 0
    assert "distortion_model: plumb_bob" in Path("camera_info.yaml").read_text()
    Path("uncertain.yaml").write_text(
        "width: 1600\nheight: 1200\nK: [1400, 0, 800, 0, 1400, 600, 0, 0, 1]\nD: [-0.1, 0.1, 0, 0, 0]\n"
        "intrinsics_standard_deviations: [1, 1, 1, 1, 0.1, 0.1, 0, 0, 0]\n"
    )
    capsys.readouterr()
    assert main(["convert", "uncertain.yaml", "-o", "ros.yaml", "--as", "ros"]) == 0
    assert "[uncertainty_not_written]" in capsys.readouterr().err


def test_what_cannot_be_converted_is_refused(capsys):
    Path("k_d.yaml").write_text(FISHEYE)
    Path("text.txt").write_text("hello\n")
    assert "--model fisheye" in refused(capsys, "convert", "k_d.yaml", "-o", "x.yaml")
    assert "an unknown format to write" in refused(capsys, "convert", "k_d.yaml", "-o", "x.yaml", "--as", "dxf")
    assert "needs the size" in refused(
        capsys, "convert", "k_d.yaml", "-o", "x.yaml", "--as", "ros", "--model", "fisheye"
    )
    assert "not the size of an image" in refused(capsys, "convert", "k_d.yaml", "-o", "x.yaml", "--size", "big")
    assert "format of the file is not known" in refused(capsys, "convert", "text.txt", "-o", "x.yaml")
    assert "not a calibration" in refused(capsys, "convert", "text.txt", "-o", "x.yaml", "--as", "opencv")
    assert "does not exist" in refused(capsys, "convert", "none.yaml", "-o", "x.yaml")
    assert not Path("x.yaml").exists()
