"""characterize as a user meets it, and that a plan reads what it writes and counts few samples."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from box_inspection import refused, write
from scipy.stats import norm, t

import viewgauge as vg
from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("folder")


def errors(n, name="errors.csv"):
    values = np.random.default_rng(8).standard_normal((n, 6)) * [0.1, 0.1, 0.1, 0.3, 0.3, 0.3]
    header = "dx_mm,dy_mm,dz_mm,rx_mrad,ry_mrad,rz_mrad"
    np.savetxt(name, values, delimiter=",", header=header, comments="")
    return values * [1, 1, 1, 1e-3, 1e-3, 1e-3]


def test_it_says_and_writes_a_pose_error_that_the_inspection_reads(capsys):
    values = errors(15)
    assert main(["characterize", "errors.csv", "-o", "heads/mine.yaml"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "15 samples (pose errors), 14 degrees of freedom" in out
    assert "written to heads/mine.yaml" in out
    write(pose_uncertainty="{covariance: heads/mine.yaml}")
    pose_error = vg.load("inspection.yaml").pose_error
    k = t.ppf(0.975, 14) / norm.ppf(0.975)  # the requirement's probability is 0.95
    assert pose_error.covariance == pytest.approx(k**2 * np.cov(values.T))


def test_json_holds_the_figures(capsys):
    values = errors(30)
    assert main(["characterize", "errors.csv", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert np.array(document["covariance"]) == pytest.approx(np.cov(values.T))
    first = document["axes"][0]
    assert first["standard_deviation"] == pytest.approx(values[:, 0].std(ddof=1))
    low, high = first["standard_deviation_interval"]
    assert low < first["standard_deviation"] < high
    assert first["mean"] == pytest.approx(values[:, 0].mean())


def test_with_the_mean_the_second_moment_is_written(capsys):
    values = errors(30)
    assert main(["characterize", "errors.csv", "-o", "head.yaml", "--with-mean"]) == 0
    capsys.readouterr()
    from viewgauge.formats.poses.covariance_file import read_covariance

    mean = values.mean(axis=0)
    assert read_covariance(Path("head.yaml")).covariance == pytest.approx(np.cov(values.T) + np.outer(mean, mean))


def test_bad_input(capsys):
    assert "does not exist" in refused(capsys, "characterize", "none.csv")
    errors(5)
    assert "too few samples" in refused(capsys, "characterize", "errors.csv")
    errors(20)
    Path("file").touch()
    assert "file in its place" in refused(capsys, "characterize", "errors.csv", "-o", "file/head.yaml")


def test_of_errors_there_is_no_camera_to_write(capsys):
    errors(12)
    said = refused(capsys, "characterize", "errors.csv", "--camera", "camera.yaml")
    assert "not images of a board" in said
    assert not Path("camera.yaml").exists()
