"""simulate as a user meets it: images, the truth beside them, going on, bad input."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from box_inspection import refused, write

from inspections import BOX
from viewgauge.cli import main

cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed")
pytestmark = pytest.mark.usefixtures("small")

VIEWPOINTS = "id,x,y,z,qw,qx,qy,qz\nabove,40,0,350,0,1,0,0\nbeside,40,-20,330,0,1,0,0\n"
SMALL = BOX["camera"].replace("[2448, 2048]", "[480, 360]").replace("3.45 um", "17 um")


@pytest.fixture
def small(folder):
    """A camera of few pixels, and two viewpoints."""
    write(camera=SMALL)
    Path("s.csv").write_text(VIEWPOINTS)
    return folder


def simulated(capsys, *options, code=0):
    assert main(["simulate", "inspection.yaml", "--viewpoints", "s.csv", "-o", "images", *options]) == code
    out, err = capsys.readouterr()
    assert err == ""
    return out


def grey(name):
    return cv2.imread(str(Path("images", name)), cv2.IMREAD_UNCHANGED)


def test_images_and_the_truth_beside_them(capsys):
    assert "4 images written to images" in simulated(capsys, "--repeats", "2")
    with Path("images/acquisitions.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [r["image"] for r in rows] == [f"{s}_{k:04d}.png" for s in ("above", "beside") for k in (1, 2)]
    assert grey("above_0001.png").shape == (360, 480)
    assert grey("above_0001.png").dtype == np.uint8
    assert (grey("above_0001.png") != grey("above_0002.png")).any()
    position = np.array([[float(r[axis]) for axis in "xyz"] for r in rows])
    assert 0 < np.abs(position[:2] - [40, 0, 350]).max() < 1, "displaced by tenths of a millimetre"
    about = json.loads(Path("images/simulation.json").read_text())
    assert about["repeats"] == 2
    assert about["sensor"]["bits"] == 8


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(capsys):
    simulated(capsys)
    before = {p.name: p.read_bytes() for p in Path("images").iterdir()}
    Path("images").rename("first")
    simulated(capsys)
    assert {p.name: p.read_bytes() for p in Path("images").iterdir()} == before
    Path("images").rename("second")
    simulated(capsys, "--seed", "5")
    assert Path("images/above_0001.png").read_bytes() != before["above_0001.png"]


def test_what_was_stopped_goes_on_and_another_simulation_is_refused(capsys):
    simulated(capsys)
    kept, gone = Path("images/above_0001.png"), Path("images/beside_0001.png")
    reported, stamp = gone.read_bytes(), kept.stat().st_mtime_ns
    gone.unlink()
    simulated(capsys)
    assert gone.read_bytes() == reported
    assert kept.stat().st_mtime_ns == stamp
    err = refused(capsys, "simulate", "inspection.yaml", "--viewpoints", "s.csv", "-o", "images", "--noise", "0.1")
    assert "images of another simulation" in err


def test_twelve_bits_and_black_and_white(capsys):
    simulated(capsys, "--bits", "12", "--noise", "0", "--blur", "0")
    image = grey("above_0001.png")
    assert image.dtype == np.uint16
    assert 255 < image.max() <= 4095
    Path("images").rename("twelve")
    simulated(capsys, "--black-and-white")
    assert set(np.unique(grey("above_0001.png"))) == {0, 255}


@pytest.mark.parametrize(
    ("options", "telling"),
    [
        (["--repeats", "0"], "from 1 on"),
        (["--bits", "10"], "8 or 12"),
        (["--blur", "-1"], "not negative"),
        (["--noise", "nan"], "finite"),
        (["--rays", "30"], "no lattice"),
        (["--seed", "-1"], "seed"),
        (["--viewpoints", "none.csv"], "does not exist"),
    ],
)
def test_bad_numbers(capsys, options, telling):
    given = ["--viewpoints", "s.csv"] if "--viewpoints" not in options else []
    assert telling in refused(capsys, "simulate", "inspection.yaml", *given, "-o", "images", *options)
    assert not Path("images").exists()


def test_without_viewpoints_it_says_where_to_give_them(capsys):
    assert "viewpoints file" in refused(capsys, "simulate", "inspection.yaml", "-o", "images")


def test_only_what_is_looked_at(capsys):
    simulated(capsys)
    whole = grey("above_0001.png")
    Path("images").rename("whole")
    simulated(capsys, "--only", "width", "--noise", "0")
    part = grey("above_0001.png")
    assert part.shape == whole.shape
    assert 0 < (part > 0).mean() < 0.5
    assert json.loads(Path("images/simulation.json").read_text())["only"] == ["width"]
    # a measurement finds the edges there that it finds in the whole image; grey values are those but for noise
    inside = part > 0
    assert np.abs(part[inside].astype(int) - whole[inside]).mean() < 8
    assert "no such characteristic" in refused(
        capsys, "simulate", "inspection.yaml", "--viewpoints", "s.csv", "-o", "other", "--only", "depth"
    )


def test_an_uncertain_calibration_is_drawn_once_for_all_images(capsys):
    simulated(capsys)
    nominal = json.loads(Path("images/simulation.json").read_text())["true_camera"]
    Path("images").rename("nominal")
    uncertainty = "calibration_uncertainty: {focal_length: 5 px, principal_point: 3 px}, edge_detector"
    write(camera=SMALL.replace("edge_detector", uncertainty))
    simulated(capsys)
    true = json.loads(Path("images/simulation.json").read_text())["true_camera"]
    off = np.array(true["focal_length_px"]) - nominal["focal_length_px"]
    assert (np.abs(off) > 1e-3).all()
    assert (np.abs(off) < 25).all()
