"""Camera files of the shared cases: the pixels of each, what is asked, what is refused, what is a warning."""

from __future__ import annotations

import csv
import json
from collections import defaultdict

import cv2
import numpy as np
import pytest
from version_2 import CASES, copy_case

from viewgauge.cli import main
from viewgauge.formats.cameras.camera_file import Stated
from viewgauge.formats.cameras.camera_formats import read_camera_file
from viewgauge.sensors import Camera

FILES = CASES / "camera_files"
pytestmark = pytest.mark.skipif(not FILES.is_dir(), reason="the shared cases are not beside the checkout")

STATED = {"fisheye_k_d_dim.yaml": "fisheye"}
WITHIN = {"ros_binning_roi.yaml": 0.3, "division.cal": 0.01}
REFUSED = {"matlab_k.yaml", "depth_camera.json"}


def points():
    found = defaultdict(list)
    if FILES.is_dir():
        for row in csv.DictReader((FILES / "points.csv").read_text().splitlines()):
            found[row["file"], row["camera"]].append([float(row[key]) for key in ("x", "y", "z", "u_px", "v_px")])
    return found


POINTS = points()
READ = [key for key in POINTS if key[0] not in REFUSED]


def read(file, name):
    return read_camera_file(FILES / file, Stated(name or None, STATED.get(file)))


def pixels(camera, directions):
    """Through the camera that the library computes with, of its pitch 3 um."""
    focal = [0.003 * f for f in camera.focal_length_px]
    tangents = directions[:, :2] / directions[:, 2:]
    seen = tangents if camera.lens is None else camera.lens.distort(tangents)
    return seen * np.array(focal) / 0.003 + camera.principal_point_px


@pytest.mark.parametrize(("file", "name"), READ)
def test_the_pixels_of_a_camera_file(file, name):
    rows = np.array([row for row in POINTS[file, name] if row[2] > 0])  # beyond 90 deg a tangent says nothing
    found = pixels(read(file, name), rows[:, :3])
    np.testing.assert_allclose(found, rows[:, 3:], rtol=0, atol=WITHIN.get(file, 1e-6))


@pytest.mark.parametrize(("file", "name"), READ)
def test_opencv_puts_points_in_the_same_pixels(file, name):
    camera = read(file, name)
    rows = np.array([row for row in POINTS[file, name] if row[2] > 0])
    directions = np.ascontiguousarray(rows[:, :3]).reshape(-1, 1, 3)
    (fx, fy), (cx, cy) = camera.focal_length_px, camera.principal_point_px
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    coefficients = np.zeros(5) if camera.lens is None else np.array(camera.lens.coefficients)
    if camera.lens is not None and camera.lens.model == "equidistant":
        theirs = cv2.fisheye.projectPoints(directions, np.zeros(3), np.zeros(3), K, coefficients)[0][:, 0]
    else:
        theirs = cv2.projectPoints(directions, np.zeros(3), np.zeros(3), K, coefficients)[0][:, 0]
    assert np.abs(pixels(camera, rows[:, :3]) - theirs).max() < 1e-9


def test_every_file_is_tried():
    tried = {file for file, _ in POINTS} | {file for file, *_ in [*ERRORS, *WARNINGS]}
    there = {path.name for path in FILES.iterdir()} - {"points.csv", "inspection.yaml", "block.stl"}
    assert there <= tried


def run(capsys, *arguments):
    code = main(["camera", *arguments])
    return code, *capsys.readouterr()


ERRORS = [
    ("matlab_k.yaml", (), "row 3"),
    ("matlab_k.yaml", ("--model", "radial-tangential"), "row 3"),
    ("fisheye_k_d_dim.yaml", (), "--model fisheye"),
    ("fisheye_k_d_dim.yaml", (), "radial-tangential"),
    ("depth_camera.json", (), "inverse Brown-Conrady"),
    ("k_normalised.yaml", (), "0.911079 is no focal length in px"),
    ("k_in_mm.yaml", (), "178.3 deg"),
    ("skew.yaml", (), "skew"),
    ("stereo.conf", (), "LEFT_CAM_2K or LEFT_CAM_FHD or LEFT_CAM_HD or LEFT_CAM_VGA or RIGHT_CAM_2K"),
    ("colmap_cameras.txt", (), "1 or 2 or 3 or 4 or 5 or 6 or 7"),
    ("kalibr_radtan.yaml", (), "cam0 or cam1"),
    ("cameras_by_name.yaml", (), "wrist or table"),
]


@pytest.mark.parametrize(("file", "options", "telling"), ERRORS)
def test_what_cannot_be_used_is_refused_or_asked(capsys, file, options, telling):
    code, _, error = run(capsys, str(FILES / file), *options)
    assert code == 2
    assert error.startswith("viewgauge: ")
    assert file in error
    assert telling in error
    assert "Traceback" not in error


WARNINGS = [
    ("k_of_another_size.yaml", "principal_point", "1920 x 1200"),
    ("width_height_swapped.yaml", "principal_point", "width and height are exchanged"),
    ("folds_in_the_corner.yaml", "lens_turns_back", "99.5%"),
]


@pytest.mark.parametrize(("file", "name", "telling"), WARNINGS)
def test_what_is_implausible_is_a_warning(capsys, file, name, telling):
    code, out, error = run(capsys, str(FILES / file), "--json")
    assert code == 0
    assert error.startswith("viewgauge: warning: ")
    assert telling in error
    assert [finding["name"] for finding in json.loads(out)["findings"]] == [name]
    assert run(capsys, str(FILES / file), "--accept", name)[2] == ""


def test_a_camera_of_an_ini_has_its_name(capsys):
    assert run(capsys, str(FILES / "ros.ini"), "--name", "bench_left")[0] == 0


@pytest.mark.parametrize("file", ["opencv.xml", "division.cal", "ros_topic_echo.yaml", "opencv8.cameramodel"])
def test_an_inspection_reads_it(tmp_path, file):
    from viewgauge.formats.inspection.inspection_file import read_inspection_file

    inspection = copy_case(FILES / "inspection.yaml", tmp_path)
    inspection.write_text(inspection.read_text().replace("opencv.yaml", file))
    camera = read_inspection_file(inspection).setup.camera
    assert isinstance(camera, Camera)
    rows = np.array(POINTS[file, ""])
    seen = camera.to_pixels(camera.project(rows[:, :3] * 300))
    np.testing.assert_allclose(seen, rows[:, 3:], rtol=0, atol=WITHIN.get(file, 1e-6))


def test_an_inspection_says_the_model(tmp_path):
    from viewgauge.exceptions import InspectionFileError
    from viewgauge.formats.inspection.inspection_file import read_inspection_file

    inspection = copy_case(FILES / "inspection.yaml", tmp_path)
    text = inspection.read_text().replace("opencv.yaml", "fisheye_k_d_dim.yaml")
    inspection.write_text(text)
    with pytest.raises(InspectionFileError, match=r"camera\.model: fisheye"):
        read_inspection_file(inspection)
    inspection.write_text(text.replace("  pixel_pitch", "  model: fisheye\n  pixel_pitch"))
    assert read_inspection_file(inspection).setup.camera.lens.model == "equidistant"
