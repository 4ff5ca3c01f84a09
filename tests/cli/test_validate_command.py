"""validate as a user meets it: what is told, the exit code, bad input."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from box_inspection import refused, write

from inspections import BOX
from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("small")

SMALL = BOX["camera"].replace("[2448, 2048]", "[800, 600]").replace("3.45 um", "8 um")


@pytest.fixture
def small(folder):
    """A camera of few pixels, and a viewpoint that sees the box's top and front."""
    import numpy as np

    from viewgauge.geometry import look_at, quaternion_from_pose

    write(camera=SMALL)
    T = look_at(np.array([[70.0, -190, 330]]), np.array([[40.0, 20, 25]]), np.array([0.5]))[0]
    numbers = ",".join(map(str, [*T[:3, 3], *quaternion_from_pose(T)]))
    Path("s.csv").write_text(f"id,x,y,z,qw,qx,qy,qz\ntilted,{numbers}\n")
    return folder


def test_shares_and_limits_are_reported(capsys):
    code = main(["validate", "inspection.yaml", "--viewpoints", "s.csv", "--repeats", "25", "-o", "pairs.csv"])
    out, err = capsys.readouterr()
    assert err == ""
    assert "sub-pixel edges: 25 acquisitions from 1 viewpoint" in out
    assert "inside the 95 % interval:" in out
    assert "written to pairs.csv" in out
    assert code == (1 if "NOT as predicted" in out else 0)
    with Path("pairs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["viewpoint"] for row in rows} == {"tilted"}


def test_json_of_both_ways(capsys):
    code = main(
        ["validate", "inspection.yaml", "--viewpoints", "s.csv", "--repeats", "20", "--edges", "both", "--json"]
    )
    document = json.loads(capsys.readouterr().out)
    assert [one["edges"] for one in document] == ["sub-pixel", "whole-pixel"]
    holds = [level["holds"] for one in document for level in one["coverage"]]
    assert code == (0 if all(holds) else 1)
    for one in document:
        assert one["coverage"][1]["acquisitions"] + one["drawn_unmeasured"] == 20


def test_where_nothing_is_seen_nothing_is_confirmed(capsys):
    Path("s.csv").write_text("id,x,y,z,qw,qx,qy,qz\naway,40,0,350,1,0,0,0\n")
    assert main(["validate", "inspection.yaml", "--viewpoints", "s.csv", "--repeats", "5"]) == 1
    assert "nothing could be measured" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "telling"),
    [
        (("--repeats", "0"), "repeats"),
        (("--sample", "0"), "sample"),
        (("--noise", "-1"), "noise"),
        (("--blur", "nan"), "blur"),
        (("--bits", "9"), "bits"),
        (("--rays", "30"), "rays"),
        (("--edges", "fine"), "edges"),
        (("--chord-error", "-1"), "chord_error"),
        (("--viewpoints", "none.csv"), "none.csv"),
    ],
)
def test_bad_numbers_are_reported(capsys, options, telling):
    given = ("--viewpoints", "s.csv") if options[0] != "--viewpoints" else ()
    assert telling in refused(capsys, "validate", "inspection.yaml", *given, *options)
