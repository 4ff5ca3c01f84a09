"""The benchmarks run, their ways agree with each other, and the report is made of them; nothing is timed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def run(*arguments):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    file = tmp_path_factory.mktemp("benchmarks") / "results.json"
    options = ("--tiny", "--benchmark-only", f"--benchmark-json={file}", "-p", "no:cacheprovider")
    assert "passed" in run("-m", "pytest", "benchmarks", *options)
    return file


def test_the_report_has_a_row_for_every_way(results):
    report = run("benchmarks/report.py", "--from", str(results))
    assert report.startswith("Machine: ")
    for name in ("array code, one thread", "two threads", "scalar code", "nine terms", "OpenTURNS", "quad", "Monte"):
        assert name in report
    for name in (
        "kernel, 2 threads",
        "NumPy form",
        "culling, 1 thread",
        "rays of measurands",
        "Embree alone",
        "the plan",
    ):
        assert name in report


def test_refined_plans_are_no_worse_and_the_full_camera_agrees():
    """The example with few candidates, small version of the study; it ends with 1 where either does not hold."""
    table = run("benchmarks/best_plans.py", "--directions", "40", "--precision", "1e-3")
    assert "with as many and a lower probability:\n0. Probabilities" in table
    assert "contradicts: 0." in table
    assert "rises: 1 of 1 with the same number of viewpoints" in table


def test_the_validation_s_parts_run(tmp_path):
    """Few acquisitions of each part: it makes its tables and pictures."""
    pytest.importorskip("cv2", reason="OpenCV is not installed")
    out = run("benchmarks/validation.py", str(tmp_path), "--part", "paper", "--repeats", "1")
    rows = [line for line in out.splitlines() if line.startswith("| ss")]
    assert len(rows) == 5
    assert all(row.endswith("of 10 |") for row in rows)
    assert (tmp_path / "paper_figure_7.png").stat().st_size > 10_000
    out = run("benchmarks/validation.py", str(tmp_path), "--part", "quantization")
    assert "| 0.5 px | 1.00 to 1.00 | 1.00 to 1.00 |" in out
    assert (tmp_path / "quantization.png").exists()
