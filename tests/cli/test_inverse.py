"""improve and specify as a user meets them: words, JSON, files, exit codes, bad input."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from box_inspection import refused, write

from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("folder")

HARD = "{accuracy: 0.9997, probability: 0.95}"  # more than the box's pose uncertainty allows
FEW = "{directions: 30, rolls: 2, distance: '[250, 450] mm'}"


def asked(capsys, *arguments, code):
    assert main(list(arguments)) == code
    out, err = capsys.readouterr()
    assert err == ""
    return out


def test_improve_reports_the_slack_of_what_is_met(capsys):
    out = asked(capsys, "improve", "inspection.yaml", code=0)
    assert out.startswith("2 of 2 characteristics are met today")
    part = next(line.split() for line in out.splitlines() if line.split()[:1] == ["part"])
    assert part[1] == "met"
    assert float(part[2]) > 0.1  # px: the step of the edge detector may be worse than it is
    assert "edge detector against pose uncertainty" in out


def test_improve_reports_what_to_change_and_ends_with_1(capsys):
    write(requirement=HARD, candidates=FEW)
    document = json.loads(asked(capsys, "improve", "inspection.yaml", "--json", code=1))
    assert document["part"]["met"] is False
    not_met = [d for d in document["characteristics"] if not d["met"]]
    assert not_met
    for d in not_met:
        pose_error = d["changes"]["pose_error"]
        assert pose_error["factor"] is None or 0 < pose_error["factor"] < 1
        assert pose_error["verified"]
    out = asked(capsys, "improve", "inspection.yaml", code=1)
    row = next(line for line in out.splitlines() if line.strip().startswith(not_met[0]["id"]))
    assert "not met" in row
    # what is printed is rounded to the side that keeps the answer
    value = not_met[0]["changes"]["translation"]["value"]
    if value is not None:
        printed = [float(number) for number in re.findall(r"\d+\.?\d*(?:e-\d+)?", row.split("met", 1)[1])]
        assert any(value * 0.998 < number <= value for number in printed)


def test_improve_writes_json_to_a_file_in_a_new_folder(capsys):
    out = asked(capsys, "improve", "inspection.yaml", "-o", "new/answers.json", code=0)
    assert "written to new/answers.json" in out
    document = json.loads(Path("new/answers.json").read_text())
    assert set(document["knobs"]) == {"pixel", "translation", "rotation", "pose_error", "focal_length", "distance"}
    assert document["inputs"].keys() == {"inspection.yaml", "box.stl"}


@pytest.mark.parametrize("command", ["improve", "specify"])
def test_answers_as_a_page(capsys, command):
    write(candidates="{directions: 12, rolls: 1, distances: 1, targets: 0}")
    out = asked(capsys, command, "inspection.yaml", "-o", "answers.html", code=0)
    assert "written to answers.html" in out
    assert "<h2>Edge detector against pose uncertainty</h2>" in Path("answers.html").read_text()


@pytest.mark.parametrize("command", ["improve", "specify"])
def test_an_unknown_kind_of_file_is_refused_before_any_work(capsys, command):
    err = refused(capsys, command, "inspection.yaml", "-o", "new/answers.txt")
    assert ".json or .html" in err
    assert not Path("new").exists()


def test_specify_names_cameras_and_pose_errors(capsys):
    write(candidates="{directions: 12, rolls: 1, distances: 1, targets: 0}")
    out = asked(capsys, "specify", "inspection.yaml", "-o", "cameras.json", code=0)
    document = json.loads(Path("cameras.json").read_text())
    assert len(document["choices"]) == 36
    assert document["smallest"]["pose_error_factor"] >= 1
    assert document["smallest"]["sensor"] in out
    factors = [c["pose_error_factor"] for c in document["best"]]
    assert all(f is None or f > 0 for f in factors)
    for best in document["best"]:
        of_sensor = [c["pose_error_factor"] or 0 for c in document["choices"] if c["sensor"] == best["sensor"]]
        assert (best["pose_error_factor"] or 0) == max(of_sensor)


def test_what_cannot_be_seen_at_all_is_left_out_and_named(capsys):
    write(candidates="{directions: 40, cone: {axis: [0, -1, 2], half_angle: 20 deg}}")
    out = asked(capsys, "improve", "inspection.yaml", code=1)
    assert "not seen from any viewpoint that was tried: heel" in out


@pytest.mark.parametrize("command", ["improve", "specify"])
def test_bad_input_is_reported(capsys, command):
    assert "does not exist" in refused(capsys, command, "absent.yaml")
    write(requirement="{accuracy: 2, probability: 0.95}")
    assert "inspection.yaml:14:requirement.accuracy" in refused(capsys, command, "inspection.yaml")
    write(part="{file: box.stl}")
    assert "no characteristic to measure" in refused(capsys, command, "inspection.yaml")
    write()
    assert "folder" in refused(capsys, command, "inspection.yaml", "-o", "inspection.yaml/x.json")


def test_specify_needs_candidates_of_its_own(capsys):
    Path("viewpoints.csv").write_text("id,x,y,z,qw,qx,qy,qz\nabove,40,0,350,0,1,0,0\n")
    write(candidates="{viewpoints: viewpoints.csv}")
    assert "viewpoints given one by one" in refused(capsys, "specify", "inspection.yaml")
    assert main(["improve", "inspection.yaml", "--json"]) in (0, 1)
    assert "distance" not in json.loads(capsys.readouterr().out)["knobs"]
