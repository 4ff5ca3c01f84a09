"""Files of poses of the shared cases: read to the matrices that SciPy gives, or asked what they mean."""

from __future__ import annotations

import csv
import json
from collections import defaultdict

import numpy as np
import pytest

from cases.version_2 import CASES
from viewgauge.cli import main

FOLDER = CASES / "pose_files"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="../shared/cases is absent")

READ = {
    "kuka_xyzabc.csv": (),
    "fanuc_xyzwpr.csv": (),
    "fanuc.ls": (),
    "ur_rotation_vector.csv": ("--from", "ur"),
    "abb_q1_q4.csv": (),
    "rows_4x4.txt": ("--unit", "m"),
    "trajectory_tum.txt": (),
    "pose_stamped.yaml": (),
    "pose_with_covariance.yaml": (),
    "tf_echo.txt": (),
    "matrix_opencv.yaml": ("--unit", "mm"),
}


def right(name):
    """``(n, 4, 4)`` of a file, or by the names of its rows."""
    found = defaultdict(dict)
    with (FOLDER / "right_4x4.csv").open() as file:
        for row in csv.DictReader(file):
            numbers = [float(row[f"m{i}{j}"]) for i in range(4) for j in range(4)]
            found[row["file"]][row["row"]] = np.reshape(numbers, (4, 4))
    return found[name]


@pytest.mark.parametrize("name", READ)
def test_poses_are_read(capsys, name):
    assert main(["characterize", str(FOLDER / name), *READ[name], "--json"]) == 0
    poses = np.array(json.loads(capsys.readouterr().out)["poses"])
    expected = np.array(list(right(name).values()))
    assert poses.shape == expected.shape
    np.testing.assert_allclose(poses, expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", READ)
def test_poses_become_viewpoints(capsys, tmp_path, name):
    from viewgauge.formats.poses.viewpoints_file import read_viewpoints

    out = tmp_path / "viewpoints.csv"
    assert main(["convert", str(FOLDER / name), "-o", str(out), *READ[name]]) == 0
    capsys.readouterr()
    np.testing.assert_allclose(read_viewpoints(out)[1], list(right(name).values()), rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", [name for name, said in READ.items() if said])
def test_what_a_file_does_not_say_is_asked_for(capsys, name):
    assert main(["characterize", str(FOLDER / name)]) == 2
    err = capsys.readouterr().err
    assert err.startswith("viewgauge: ")
    assert name in err
    assert "--unit mm, cm, m or inch" in err
    assert "proposal: --unit m" in err


def test_a_stated_covariance(capsys, tmp_path):
    from viewgauge.formats.poses.covariance_file import read_covariance

    out = tmp_path / "covariance.yaml"
    assert main(["characterize", str(FOLDER / "pose_with_covariance.yaml"), "-o", str(out)]) == 0
    printed = capsys.readouterr()
    assert "0.12, 0.15, 0.2 mm; 0.3, 0.25, 0.4 mrad" in printed.out
    assert "correlation of x and ry: 0.4" in printed.out
    assert "along the axes of a fixed frame" in printed.err
    covariance = read_covariance(out).covariance
    assert np.sqrt(covariance.diagonal()) == pytest.approx([0.12, 0.15, 0.2, 3e-4, 2.5e-4, 4e-4])


@pytest.mark.parametrize("name", ["hand_eye_samples.yaml", "hand_eye_matrices.yaml"])
def test_hand_eye(capsys, name):
    assert main(["characterize", str(FOLDER / name), "--json"]) == 0
    hand_eye = json.loads(capsys.readouterr().out)["hand_eye"]
    found, true = np.array(hand_eye["camera_on_flange"]["matrix"]), right("hand_eye_samples.yaml")["hand-eye (truth)"]
    assert hand_eye["in_hand"] == "camera"
    assert np.linalg.norm(found[:3, 3] - true[:3, 3]) < 0.2
    chord = np.linalg.norm(found[:3, :3] - true[:3, :3]) / np.sqrt(2)
    assert np.degrees(chord) < 0.05
