"""The command line as a user meets it: exit codes, messages, files, and nothing left half-done."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from box_inspection import refused, write

from inspections import BOX
from viewgauge.cli import main
from viewgauge.formats.step import kernel_process as step_process

pytestmark = pytest.mark.usefixtures("folder")

EXAMPLE = Path(__file__).parents[2] / "examples" / "slotted_block"
HEADER = "id,x,y,z,qw,qx,qy,qz\n"
ABOVE = "above,40,0,350,0,1,0,0\n"  # half a turn about x: looks down on the edge "width" of the box


# --- good runs --------------------------------------------------------------------------------------------------------


def test_plan_writes_its_files_and_ends_with_0(capsys):
    assert main(["plan", "inspection.yaml", "-o", "new/nested folder"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert sorted(p.name for p in Path("new/nested folder").iterdir()) == [
        "assignments.csv", "plan.json", "report.html", "viewpoints.csv",
    ]  # fmt: skip
    assert "2 of 2 characteristics" in out
    assert "nested folder" in out


def test_json_is_plan_json(capsys):
    assert main(["plan", "inspection.yaml", "-o", "out", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == json.loads(Path("out/plan.json").read_text())
    assert document["characteristics"][0]["id"] == "width"


def test_a_not_met_characteristic_is_1_and_is_named_with_the_best_reached_and_the_cause(capsys):
    write(requirement="{error: 1 nm, probability: 0.95}")
    assert main(["plan", "inspection.yaml", "-o", "out"]) == 1
    out = capsys.readouterr().out
    assert "  not met         width: best probability 0.0" in out
    assert "of 0.95 required; visible, but limited by pose error" in out
    assert main(["plan", "inspection.yaml", "-o", "out", "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert (document["count"], document["lower_bound"], document["proven"]) == (0, 0, True)
    assert {d["status"] for d in document["characteristics"]} == {"not_met"}


def test_a_hidden_characteristic_names_the_reason_that_dominates(capsys):
    write(candidates="{directions: 20, rolls: 1, cone: {half_angle: 10 deg}}")
    assert main(["plan", "inspection.yaml", "-o", "out"]) == 1
    assert "heel: best probability 0.0000 of 0.95 required; not visible from any of" in (out := capsys.readouterr().out)
    assert "on faces turned away (" in out


def test_no_tolerance_is_1_and_is_named_by_every_command(capsys):
    part = BOX["part"].replace("\n      tolerance: 0.1 mm", "")
    write(part=part, requirement="{fraction_of_tolerance: 50 %, probability: 0.9}")
    Path("s.csv").write_text(HEADER + ABOVE)
    for command in (["check"], ["plan", "-o", "out"], ["evaluate", "--viewpoints", "s.csv"]):
        assert main([command[0], "inspection.yaml", *command[1:]]) == 1
        out = capsys.readouterr().out
        assert "width" in out
        assert "basic value" in out
    assert main(["check", "inspection.yaml", "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert [d["id"] for d in document["not_measurable"]] == ["width"]
    statuses = {d["id"]: (d["status"], "basic value" in d["reason"]) for d in document["characteristics"]}
    assert statuses == {"heel": ("measurable", False), "width": ("not_measurable", True)}


def test_nothing_that_can_be_judged_is_1_and_no_crash(capsys):
    part = BOX["part"].replace("\n      tolerance: 0.1 mm", "").replace("\n      tolerance: '[-0.1, 0.2] mm'", "")
    write(part=part, requirement="{fraction_of_tolerance: 50 %, probability: 0.9}")
    Path("s.csv").write_text(HEADER + ABOVE)
    for command in (["check"], ["plan", "-o", "out"], ["evaluate", "--viewpoints", "s.csv", "-o", "t.csv"]):
        assert main([command[0], "inspection.yaml", *command[1:]]) == 1
        assert "basic value" in capsys.readouterr().out


def test_check_says_what_was_read(capsys):
    assert main(["check", "inspection.yaml"]) == 0
    out = capsys.readouterr().out
    assert "80 x 50 x 40 mm" in out
    assert "heel: measurand 80 mm (-0.1 +0.2)" in out
    assert main(["check", "inspection.yaml", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["part"]["size_mm"] == [80, 50, 40]
    assert [d["id"] for d in document["characteristics"]] == ["width", "heel"]
    assert list(document["inputs"]) == ["inspection.yaml", "box.stl"]


def test_evaluate_names_the_best_viewpoint_of_each_characteristic(capsys):
    Path("s.csv").write_text(HEADER + "far,40,0,35000,0,1,0,0\n" + ABOVE)
    assert main(["evaluate", "inspection.yaml", "--viewpoints", "s.csv"]) == 1
    out = capsys.readouterr().out
    assert "width: probability" in out
    assert "from above, accepted" in out
    assert "heel: not visible (facing_away), not accepted" in out
    assert main(["evaluate", "inspection.yaml", "--viewpoints", "s.csv", "--json"]) == 1
    best = json.loads(capsys.readouterr().out)["best"]
    assert (best["width"]["viewpoint"], best["width"]["accepted"]) == ("above", True)
    assert best["heel"]["reason"] == "facing_away"


def test_odd_paths_and_part_override(capsys):
    odd = Path("Prüf teile")
    odd.mkdir()
    Path("box.stl").rename(odd / "ein würfel.STL")
    write(odd / "mein plan.yaml", part=BOX["part"].replace("box.stl", "ein würfel.STL"))
    assert main(["check", str(odd / "mein plan.yaml")]) == 0, "the part lies beside the inspection file"
    write(odd / "none.yaml", part=BOX["part"].replace("  file: box.stl\n", ""))
    assert main(["check", str(odd / "none.yaml"), "--part", str(odd / "ein würfel.STL")]) == 0, "from where one stands"
    capsys.readouterr()
    assert main(["plan", str(odd / "mein plan.yaml"), "-o", str(odd / "ergebnis ö"), "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["inputs"]) == ["mein plan.yaml", "ein würfel.STL"]
    assert (odd / "ergebnis ö" / "report.html").exists()


def test_help_and_version(capsys):
    for arguments in ([], ["--help"], ["plan", "--help"], ["--version"]):
        assert main(arguments) == 0
    assert "Exit" not in capsys.readouterr().err


# --- tables -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr", ".CSV"])
def test_tables_read_back_equal(suffix):
    import viewgauge as vg
    from viewgauge.evaluation import COLUMNS

    if suffix in (".parquet", ".zarr"):
        pytest.importorskip("pyarrow" if suffix == ".parquet" else "zarr", reason="an optional library")
    Path("s.csv").write_text(HEADER + "far,40,0,3500,0,1,0,0\n" + ABOVE)
    for _ in range(2):  # the second run writes over the first
        assert main(["evaluate", "inspection.yaml", "--viewpoints", "s.csv", "-o", f"new/t{suffix}"]) == 1
    assert os.listdir("new") == [f"t{suffix}"]
    expected = vg.evaluate(vg.load("inspection.yaml"), "s.csv")
    path = f"new/t{suffix}"
    if suffix == ".zarr":
        import xarray as xr

        got = xr.open_zarr(path, consolidated=False).load()
        for name in (*COLUMNS, "measurand", "validity"):
            np.testing.assert_array_equal(got[name].values, expected[name].values, err_msg=name)
        return
    import pandas as pd

    rows = pd.read_parquet(path) if suffix == ".parquet" else pd.read_csv(path, keep_default_na=False, na_values=[])
    assert list(rows.columns) == ["viewpoint", "characteristic", *COLUMNS, "validity"]
    assert rows["viewpoint"].tolist() == ["far", "far", "above", "above"]
    assert rows["characteristic"].tolist() == ["width", "heel"] * 2
    for name in (*COLUMNS, "validity"):
        given = expected[name].values.ravel()
        if given.dtype == float:
            np.testing.assert_array_equal(pd.to_numeric(rows[name]).to_numpy(), given, err_msg=name)
        else:
            assert rows[name].tolist() == given.tolist(), name


def test_methods_agree_as_theory_says():
    import viewgauge as vg

    inspection = vg.load("inspection.yaml")
    vg.write_plan(vg.plan(inspection), inspection, "out")
    joint, independent, drawn = (
        vg.evaluate(inspection, "out/viewpoints.csv", method=method)
        for method in ("joint", "independent", "monte-carlo")
    )
    np.testing.assert_array_equal(joint["visible"], drawn["visible"])
    assert (independent["probability"] <= joint["probability"]).all(), "the paper's model overstates the spread"
    assert (independent["sigma_displacement_px"] > 2 * joint["sigma_displacement_px"]).any()
    # 99 % intervals of half-width 1e-3: twice that fails a right pair in less than 1 of 10^4 cases (t, 15 degrees)
    assert abs(drawn["probability"] - joint["probability"]).max() < 2e-3
    assert abs(drawn["expected_accuracy"] - joint["expected_accuracy"]).max() < 1e-4
    again = vg.evaluate(inspection, "out/viewpoints.csv", method="monte-carlo")
    np.testing.assert_array_equal(again["probability"], drawn["probability"])


def test_the_full_camera_gives_an_interval_as_narrow_as_asked():
    import pandas as pd

    Path("s.csv").write_text(HEADER + ABOVE)
    write(requirement="{accuracy: 0.9998, probability: 0.95}")
    command = ["evaluate", "inspection.yaml", "--viewpoints", "s.csv", "--method", "monte-carlo", "-o", "t.csv"]
    for precision in (1e-2, 5e-4):
        assert main([*command, "--precision", str(precision)]) == 1
        rows = pd.read_csv("t.csv", keep_default_na=False)
        assert rows.columns[-3:].tolist() == ["validity", "probability_low", "probability_high"]
        width, heel = rows.iloc[0], rows.iloc[1]
        assert 0.2 < width["probability"] < 0.8
        assert width["probability_low"] < width["probability"] < width["probability_high"]
        assert width["probability_high"] - width["probability_low"] <= 2 * precision
        assert (heel["probability_low"], heel["probability_high"]) == (0, 0), "not visible"


def test_a_plan_beyond_small_errors_is_warned_of_and_confirmed(capsys):
    # a pose known to 25 mm and 4 degrees
    write(
        pose_uncertainty="{translation: 25 mm, rotation: 4 deg}",
        requirement="{accuracy: 0.7, probability: 0.9}",
        candidates="{distance: '[300, 400] mm', directions: 20, rolls: 1}",
    )
    assert main(["plan", "inspection.yaml", "-o", "out"]) == 0
    out = capsys.readouterr().out
    assert "warning         width: " in out
    assert "; confirmed with the full camera model" in out
    planned = {d["id"]: d for d in json.loads(Path("out/plan.json").read_text())["characteristics"]}
    assert all(d["warning"] for d in planned.values())
    for method, reported in (("joint", True), ("monte-carlo", False)):
        command = ["evaluate", "inspection.yaml", "--viewpoints", "out/viewpoints.csv", "--method", method]
        assert main([*command, "--json"]) == 0
        best = json.loads(capsys.readouterr().out)["best"]
        assert main(command) == 0
        assert ("the full camera model answers with --method monte-carlo" in capsys.readouterr().out) is reported
    for name, characteristic in planned.items():
        # another place in the table, the same draws: what the plan states is what the full camera model gives
        assert characteristic["probability"] == pytest.approx(best[name]["probability"], abs=1e-12)
        assert best[name]["validity"] == characteristic["warning"]


# --- bad input: exit code 2 and one telling message -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "where", "telling"),
    [
        ({"camera": BOX["camera"].replace("16 mm", "-16 mm")}, "12:camera.focal_length", "-16 mm"),
        ({"camera": BOX["camera"].replace("16 mm", ".nan mm")}, "12:camera.focal_length", "nan mm"),
        ({"camera": BOX["camera"].replace("16 mm", "16")}, "12:camera.focal_length", "such as 16 mm"),
        ({"camera": BOX["camera"].replace("16 mm", "16 deg")}, "12:camera.focal_length", "16 deg"),
        ({"camera": BOX["camera"].replace("focal_length", "focal")}, "12:camera.focal", "unknown"),
        ({"camera": BOX["camera"].replace("2448", "-2448")}, "12:camera.resolution", "-2448"),
        (
            {"pose_uncertainty": "{translation: -0.1 mm, rotation: 0.02 deg}"},
            "13:pose_uncertainty.translation",
            "-0.1 mm",
        ),
        (
            {"pose_uncertainty": "{translation: 0.1 deg, rotation: 0.02 deg}"},
            "13:pose_uncertainty.translation",
            "0.1 deg",
        ),
        ({"requirement": "{accuracy: 1.5, probability: 0.95}"}, "14:requirement", "1.5"),
        ({"requirement": "{accuracy: 0.99, probability: 2}"}, "14:requirement.probability", "2"),
        ({"candidates": "{distance: '[600, 300] mm'}"}, "15:candidates.distance", "the nearer distance comes first"),
        ({"candidates": "{viewpoints: none.csv}"}, "", "none.csv"),
        ({"bogus": "1"}, "17:bogus", "unknown"),
        (
            {"part": BOX["part"].replace("[80, 0, 40]]", "[80, 0, 4000]]")},
            "4:part.characteristics",
            "outside the part: its end is 3960 mm from the surface",
        ),
        (
            {"part": BOX["part"].replace("[80, 0, 40]]", "[80, 0, .nan]]")},
            "5:part.characteristics[0].points",
            "nan",
        ),
        ({"part": "{file: box.stl}"}, "part.characteristics", "no characteristic to measure"),
        ({"part": BOX["part"].replace("box.stl", "gone.stl")}, "gone.stl", "cannot be read"),
        ({"part": BOX["part"].replace("box.stl", "gone.step")}, "gone.step", "does not exist"),
        ({"part": BOX["part"].replace("box.stl", "box.dwg")}, "box.dwg", "STEP (.stp, .step, .p21, .stpz"),
    ],
)
def test_bad_inspection_files(capsys, changes, where, telling):
    write(**changes)
    err = refused(capsys, "plan", "inspection.yaml", "-o", "out")
    assert where in err
    assert telling in err
    assert not Path("out").exists(), "nothing is left behind"


def test_missing_inspection_file(capsys):
    assert "none.yaml: the file does not exist" in refused(capsys, "check", "none.yaml")


def test_covariance_that_is_none(capsys):
    rows = np.diag([1.0, 1, 1, 1e-6, 1e-6, 1e-6])
    rows[0, 1] = rows[1, 0] = 2.0
    Path("cov.yaml").write_text("covariance:\n" + "".join(f"  - {row.tolist()}\n" for row in rows))
    write(pose_uncertainty="{covariance: cov.yaml}")
    err = refused(capsys, "check", "inspection.yaml")
    assert "pose_uncertainty.covariance" in err or "cov.yaml" in err
    assert "positive semidefinite" in err


@pytest.mark.parametrize(
    ("content", "telling"),
    [
        (HEADER + "a,0,0,300,0,1,1,0\n", "s.csv:2:qw, qx, qy, qz: the quaternion is not of unit length"),
        (HEADER + ABOVE + "a,0,nan,300,0,1,0,0\n", "s.csv:3:y: not a finite number"),
        (HEADER, "no viewpoints in the file"),
        ("id,x,y\n", "s.csv:1:z, qw, qx, qy, qz: columns are missing"),
    ],
)
def test_bad_viewpoints_files(capsys, content, telling):
    Path("s.csv").write_text(content)
    assert telling in refused(capsys, "evaluate", "inspection.yaml", "--viewpoints", "s.csv")
    write(candidates="{viewpoints: s.csv}")
    assert telling in refused(capsys, "plan", "inspection.yaml", "-o", "out")


def test_evaluate_without_viewpoints_says_where_to_give_them(capsys):
    assert "candidates.viewpoints" in refused(capsys, "evaluate", "inspection.yaml")


@pytest.mark.parametrize(
    ("name", "content", "telling"),
    [
        ("text.step", "this is no CAD file\n", "not a STEP file"),
        ("empty.step", "", "empty"),
        ("cut.step", None, "truncated"),
        ("empty.stl", "solid nothing\nendsolid nothing\n", "empty.stl"),
        ("empty.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangles"),
    ],
)
def test_bad_part_files(capsys, name, content, telling):
    step = (EXAMPLE / "slotted_block.step").read_text()
    Path(name).write_text(step[: len(step) // 2] if content is None else content)
    err = refused(capsys, "plan", "inspection.yaml", "-o", "out", "--part", name)
    assert name in err
    assert telling in err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("code", "telling"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "SIGSEGV"),
        ("import time; time.sleep(600)", "took longer than 2 s"),
    ],
)
def test_a_step_file_that_crashes_or_hangs_the_reader(capsys, monkeypatch, code, telling):
    monkeypatch.setattr(step_process, "_CHILD", (sys.executable, "-c", code))
    monkeypatch.setattr(step_process, "_LEAST_TIMEOUT_S", 2.0)
    monkeypatch.setattr(step_process, "_TIMEOUT_S_PER_MB", 0.0)
    Path("bad.step").write_text("ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;\n")
    err = refused(capsys, "plan", "inspection.yaml", "-o", "out", "--part", "bad.step")
    assert "bad.step" in err
    assert telling in err


def test_what_is_wrong_with_the_inspection_file_is_reported_before_its_part(capsys):
    write(part="{file: none.step}", camera=BOX["camera"].replace("16 mm", "16"))
    err = refused(capsys, "check", "inspection.yaml")
    assert "camera.focal_length" in err
    assert "none.step" not in err
    write(part="{file: none.step}")
    assert "none.step: the file does not exist" in refused(capsys, "check", "inspection.yaml")


def test_no_candidate_left(capsys):
    write(candidates="{distance: '[1, 2] mm', targets: 0}")
    err = refused(capsys, "plan", "inspection.yaml", "-o", "out")
    assert "no candidate viewpoint is left" in err
    assert "allow larger distances" in err
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("arguments", "telling"),
    [
        (["bogus"], 'Unknown command "bogus"'),
        (["plan"], "FILE"),
        (["plan", "inspection.yaml"], "--output"),
        (["check", "inspection.yaml", "--bogus"], "--bogus"),
        (["plan", "inspection.yaml", "-o", "out", "--seed", "1.5"], "'1.5' is not a whole number"),
        (["plan", "inspection.yaml", "-o", "out", "--seed", "-3"], "seed"),
        (["evaluate", "inspection.yaml", "--viewpoints", "s.csv", "--method", "exact"], "monte-carlo"),
        (["evaluate", "inspection.yaml", "--viewpoints", "s.csv", "--precision", "0"], "precision"),
        (["evaluate", "none.yaml", "--viewpoints", "s.csv", "-o", "t.xlsx"], "a suffix of .csv, .parquet, .zarr"),
        (["plan", "none.yaml", "-o", "box.stl"], "there is a file in its place"),
        (["plan", "none.yaml", "-o", "box.stl/out"], "there is a file in its place"),
        (["evaluate", "none.yaml", "--viewpoints", "s.csv", "-o", "box.stl/t.csv"], "there is a file in its place"),
    ],
)
def test_bad_arguments(capsys, arguments, telling):
    """Where the output is wrong it is told before anything is read: there is no none.yaml."""
    Path("s.csv").write_text(HEADER + ABOVE)
    assert telling in refused(capsys, *arguments)


def test_an_output_folder_without_permission(capsys, monkeypatch):
    Path("locked").mkdir()
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write everywhere
    assert "locked: nothing can be written to this folder" in refused(capsys, "plan", "none.yaml", "-o", "locked")
    assert Path("locked").is_dir(), "what was there stays"


def test_a_failure_leaves_an_older_plan_as_it_was(capsys):
    assert main(["plan", "inspection.yaml", "-o", "out"]) == 0
    before = {p.name: p.read_bytes() for p in Path("out").iterdir()}
    write(pose_uncertainty="{translation: -1 mm, rotation: 0.02 deg}")
    capsys.readouterr()
    refused(capsys, "plan", "inspection.yaml", "-o", "out")
    assert {p.name: p.read_bytes() for p in Path("out").iterdir()} == before


def test_errors_as_json(capsys):
    write(camera=BOX["camera"].replace("16 mm", "16"))
    assert main(["check", "inspection.yaml", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["kind"] == "InspectionFileError"
    assert error["file"] == "inspection.yaml"
    assert error["line"] == 12
    assert error["key"] == "camera.focal_length"
    assert "16" in error["got"]
    assert error["expected"]


# --- many viewpoints, many processes ----------------------------------------------------------------------------------


def plan(*options):
    return ["plan", "inspection.yaml", "-o", "out", *options]


def evaluate(*options):
    return ["evaluate", "inspection.yaml", "--viewpoints", "s.csv", *options]


def sampled(*options):
    return ["evaluate", "inspection.yaml", "--sampled", *options]


@pytest.mark.parametrize("command", [plan, evaluate])
@pytest.mark.parametrize(
    ("options", "telling"),
    [
        (["--workers", "0"], "'0' is not a whole number from 1 on"),
        (["--workers", "-1"], "'-1' is not a whole number from 1 on"),
        (["--workers", "1.5"], "'1.5' is not a whole number"),
        (["--workers", "x"], "'x' is not a whole number"),
        (["--workers", ""], "'' is not a whole number"),
        (["--workers"], "--workers"),
        (["--chunk", "0"], "'0' is not a whole number from 1 on"),
        (["--chunk", "-1"], "'-1' is not a whole number from 1 on"),
        (["--chunk", "x"], "'x' is not a whole number"),
        (["--chunk", "1e3"], "'1e3' is not a whole number"),
        (["--scheduler", "tcp://127.0.0.1:9"], "the scheduler cannot be reached"),
        (["--scheduler", "garbage"], "the address of a running Dask scheduler"),
        (["--scheduler", ""], "the scheduler cannot be reached"),
        (["--scheduler", "tcp://127.0.0.1:9", "--workers", "2"], "exclude each other"),
    ],
)
def test_bad_places_to_run(capsys, command, options, telling):
    if "reached" in telling or "running" in telling:
        pytest.importorskip("distributed", reason="Dask is not installed")
    Path("s.csv").write_text(HEADER + ABOVE)
    assert telling in refused(capsys, *command(*options))
    assert sorted(os.listdir()) == ["box.stl", "inspection.yaml", "s.csv"]


@pytest.mark.parametrize(
    ("command", "telling"),
    [
        (evaluate("-o", "t.csv", "--columns", "bogus"), "no such column"),
        (evaluate("--columns", "probability, bogus"), "bogus"),
        (evaluate("-o", "t.csv", "--columns", ""), "no column is named"),
        (evaluate("-o", "t.csv", "--columns", "probability,,visible"), "no such column"),
        (evaluate("-o", "t.csv", "--columns", "probability,probability"), "a column is named twice"),
        (evaluate("-o", "t.csv", "--columns", "probability_low"), "no such column"),
        (evaluate("--sampled"), "exclude each other"),
        (["plan", "inspection.yaml", "-o", "out", "--sampled"], "--sampled"),
        (sampled("-o", "box.stl/t.zarr"), "there is a file in its place"),
    ],
)
def test_bad_tables(capsys, command, telling):
    pytest.importorskip("zarr")
    Path("s.csv").write_text(HEADER + ABOVE)
    assert telling in refused(capsys, *command)
    assert sorted(os.listdir()) == ["box.stl", "inspection.yaml", "s.csv"]


def test_a_table_in_place_of_a_file(capsys):
    pytest.importorskip("zarr")
    Path("t.zarr").write_text("a file")
    assert "a folder cannot be written where a file is" in refused(capsys, *sampled("-o", "t.zarr"))
    Path("t.csv").mkdir()
    assert "a file cannot be written where a folder is" in refused(
        capsys, *sampled("-o", "t.csv", "--columns", "visible")
    )
    assert sorted(os.listdir()) == ["box.stl", "inspection.yaml", "t.csv", "t.zarr"]


def test_nothing_measurable_to_sample_for(capsys):
    part = BOX["part"].replace("\n      tolerance: 0.1 mm", "").replace("\n      tolerance: '[-0.1, 0.2] mm'", "")
    write(part=part, requirement="{fraction_of_tolerance: 50 %, probability: 0.9}")
    assert "see viewgauge check" in refused(capsys, *sampled("-o", "t.csv"))
    assert sorted(os.listdir()) == ["box.stl", "inspection.yaml"]


def test_sampled_evaluates_what_a_plan_would_choose_from(capsys):
    assert main([*plan(), "--json"]) == 0
    planned = json.loads(capsys.readouterr().out)
    assert main([*sampled("--chunk", "50", "--json")]) == 0
    judged = json.loads(capsys.readouterr().out)
    assert judged["viewpoints"] == planned["candidates"]
    for characteristic in planned["characteristics"]:
        assert judged["best"][characteristic["id"]]["probability"] >= characteristic["probability"] - 1e-12


@pytest.mark.parametrize("command", ["evaluate", "plan"])
def test_two_jobs_on_one_target(capsys, command):
    pytest.importorskip("zarr")
    pytest.importorskip("fcntl", reason="a POSIX system")
    from viewgauge.formats.files.journal import ChunkJournal

    Path("out").mkdir()
    place, arguments = {
        "evaluate": (Path("out/.t.zarr.partial"), sampled("-o", "out/t.zarr")),
        "plan": (Path("out/.partial"), plan("--chunk", "10")),
    }[command]
    with ChunkJournal(place, "another job"):
        err = refused(capsys, *arguments)
    assert "another process is writing this" in err
    assert f"process {os.getpid()} on" in err
    assert main(arguments) == 0
    assert not place.exists()


@pytest.mark.parametrize("option", [["--workers", "1"], ["--scheduler", "tcp://127.0.0.1:8786"]])
def test_without_dask(capsys, monkeypatch, option):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "viewgauge.execution.cluster", raising=False)
    monkeypatch.delattr("viewgauge.execution.cluster", raising=False)
    Path("s.csv").write_text(HEADER + ABOVE)
    for command in (plan, evaluate):
        assert 'pip install "viewgauge[distributed]"' in refused(capsys, *command(*option))


# --- as a process -----------------------------------------------------------------------------------------------------


def process(*arguments, **options):
    return subprocess.Popen(
        [sys.executable, "-m", "viewgauge", *arguments],
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
    )


def test_nothing_on_stderr_in_a_pipe_and_names_that_the_terminal_cannot_show():
    done = process("plan", "inspection.yaml", "-o", "ä", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    out, err = done.communicate(timeout=600)
    assert done.returncode == 0
    assert err == b""
    assert rb"written to \xe4" in out


@pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals and signals are POSIX only")
def test_progress_is_shown_on_a_terminal():
    import pty

    try:
        ours, theirs = pty.openpty()
    except OSError as error:
        pytest.skip(f"no pseudo-terminal can be opened here: {error}")
    running = process("plan", "inspection.yaml", "-o", "out", "--json", stderr=theirs)
    os.close(theirs)
    seen = b""
    try:
        while block := os.read(ours, 4096):
            seen += block
    except OSError:
        pass  # Linux says so when the other end is closed
    out, _ = running.communicate(timeout=600)
    os.close(ours)
    assert running.returncode == 0
    assert b"Evaluating" in seen
    assert json.loads(out)["proven"], "progress does not mix with the result"


@pytest.mark.skipif(os.name != "posix", reason="pipes that close early are told by a signal on POSIX only")
def test_a_reader_that_leaves_is_no_traceback():
    running = process("check", "inspection.yaml")
    running.stdout.close()
    err = running.stderr.read()
    running.stderr.close()
    assert running.wait(timeout=600) == 141
    assert err == b""


@pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals and signals are POSIX only")
def test_ctrl_c_during_a_plan_is_130_and_leaves_nothing_half_written(folder):
    # many candidates, so that the plan is not done when the signal comes; it is sent once planning has begun
    write(candidates="{directions: 20000, rolls: 8, distances: 10}")
    code = (
        "import signal, sys, viewgauge as vg\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a test run in the background ignores it
        "real = vg.plan\n"
        "def plan(*a, **k):\n    print('begun', flush=True)\n    return real(*a, **k)\n"
        "vg.plan = plan\n"
        "from viewgauge.cli import main\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", code, "plan", "inspection.yaml", "-o", "new/out"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stdout.readline() == "begun\n"
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=600)
    assert running.returncode == 130
    assert err == "viewgauge: interrupted; nothing was left half-written, and a long job goes on when started again\n"
    assert out == ""
    # a long job keeps what it has done, and nothing else
    assert sorted(p.name for p in folder.iterdir()) in (
        ["box.stl", "inspection.yaml"],
        ["box.stl", "inspection.yaml", "new"],
    )
    assert [p.name for p in folder.glob("new/out/*")] in ([], [".partial"])


@pytest.mark.parametrize("cause", [KeyboardInterrupt(), ValueError()])
def test_ctrl_c_in_compiled_code_is_an_interrupt_and_other_system_errors_are_not(capsys, monkeypatch, cause):
    """A compiled function that is interrupted as it returns raises SystemError, caused by the interrupt."""
    import viewgauge as vg

    def interrupted(*_, **__):
        raise SystemError("a result with an exception set") from cause

    monkeypatch.setattr(vg, "plan", interrupted)
    if isinstance(cause, KeyboardInterrupt):
        assert main(["plan", "inspection.yaml", "-o", "out"]) == 130
        assert "interrupted" in capsys.readouterr().err
        assert not Path("out").exists()
    else:
        with pytest.raises(SystemError):
            main(["plan", "inspection.yaml", "-o", "out"])
