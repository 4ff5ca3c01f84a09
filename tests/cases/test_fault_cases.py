"""What goes wrong beside the input's values: other files, damaged files, devices, closed streams, two at once."""

from __future__ import annotations

import csv
import json
import os
import shutil
import socket
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import viewgauge as vg
from viewgauge.cli import main
from viewgauge.formats.files.images import image_size
from viewgauge.formats.plan.plan_schema import checksum
from viewgauge.formats.tables.table_layout import Column, TableLayout
from viewgauge.formats.tables.table_zarr import ZarrTable

INSPECTION = """part:
  file: box.stl
  characteristics:
    - {id: width, points: [[0, 0, 40], [80, 0, 40]], unit: mm, tolerance: 1 mm}
    - {id: depth, points: [[0, 0, 40], [0, 50, 40]], unit: mm, tolerance: 1 mm}
camera:
  focal_length: 16 mm
  pixel_pitch: 13.8 um
  resolution: [306, 256]
  edge_detector: {quantization: 0.1 px}
pose_uncertainty: {translation: 0.1 mm, rotation: 0.02 deg}
requirement: {accuracy: 0.99, probability: 0.9}
candidates: {directions: 40, rolls: 2, distance: 600 mm}
"""
QUICK = ("--no-prove", "--no-refine")


def inspection_in(folder: Path) -> Path:
    box = trimesh.creation.box(extents=(80, 50, 40))
    box.apply_translation([40, 25, 20])
    box.export(folder / "box.stl")
    (folder / "inspection.yaml").write_text(INSPECTION)
    return folder / "inspection.yaml"


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A folder with an inspection, its plan, and an image of each of its viewpoints."""
    folder = tmp_path_factory.mktemp("project")
    inspection = inspection_in(folder)
    assert main(["plan", str(inspection), "-o", str(folder / "plan"), *QUICK]) in (0, 1)
    given = ["simulate", str(inspection), "--viewpoints", str(folder / "plan" / "viewpoints.csv")]
    assert main([*given, "-o", str(folder / "images")]) == 0
    return folder


@pytest.fixture
def folder(project, tmp_path):
    return Path(shutil.copytree(project, tmp_path / "project"))


def measure(folder: Path, inspection: str = "inspection.yaml") -> int:
    given = [folder / inspection, folder / "plan", folder / "images"]
    return main(["measure", *map(str, given), "-o", str(folder / "m")])


# --- one identity chain ---------------------------------------------------------------------------------------------


def empty_tolerance(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["tolerance_mm"] = []


def number_as_id(plan: dict[str, Any]) -> None:
    plan["viewpoints"][0]["id"] = 7


def huge_nominal(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["nominal_mm"] = int("9" * 400)


def tolerance_ten_times(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["tolerance_mm"] = [10 * v for v in plan["characteristics"][0]["tolerance_mm"]]


def mirrored_pose(plan: dict[str, Any]) -> None:
    for row in plan["viewpoints"][0]["T_part_camera"][:3]:
        row[0] = -row[0]


def unknown_status(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["status"] = "fine"


def unknown_viewpoint(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["viewpoint"] = "nowhere"


def no_measurand(plan: dict[str, Any]) -> None:
    plan["characteristics"][0]["measurand"] = None


def text_as_pose(plan: dict[str, Any]) -> None:
    plan["viewpoints"][0]["T_part_camera"] = "as before"


EDITS = {
    empty_tolerance: "characteristics[0].tolerance_mm",
    number_as_id: "viewpoints[0].id",
    huge_nominal: "characteristics[0].nominal_mm",
    tolerance_ten_times: "characteristics[0].tolerance_mm",
    mirrored_pose: "viewpoints[0].T_part_camera",
    unknown_status: "characteristics[0].status",
    unknown_viewpoint: "characteristics[0].viewpoint",
    no_measurand: "characteristics[0].measurand",
    text_as_pose: "viewpoints[0].T_part_camera",
}


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.__name__)
def test_an_edited_plan_is_refused_with_its_key(folder, edit: Callable[[dict[str, Any]], None], capsys):
    path = folder / "plan" / "plan.json"
    plan = json.loads(path.read_text())
    edit(plan)
    plan["checksum"] = checksum(plan) if edit is not huge_nominal else ""  # as one does who knows of it
    path.write_text(json.dumps(plan))
    assert measure(folder) == 2
    assert EDITS[edit] in capsys.readouterr().err


def test_any_other_edit_is_noticed_too(folder, capsys):
    path = folder / "plan" / "plan.json"
    plan = json.loads(path.read_text())
    plan["viewpoints"][0]["T_part_camera"][0][3] += 5.0
    path.write_text(json.dumps(plan))
    assert measure(folder) == 2
    assert "changed after it was written" in capsys.readouterr().err


@pytest.mark.parametrize("changed", ["inspection", "part"])
def test_a_plan_of_other_files_is_refused_unless_accepted(folder, changed, capsys):
    if changed == "part":
        (folder / "box.stl").write_bytes(b"x" + (folder / "box.stl").read_bytes()[1:])
        other, text = "inspection.yaml", INSPECTION
    else:
        other, text = "other.yaml", INSPECTION.replace("16 mm", "16.4 mm")
    (folder / other).write_text(text)
    assert measure(folder, other) == 2
    assert "[plan_inputs]" in capsys.readouterr().err
    (folder / other).write_text(text + "accept: [plan_inputs]\n")
    assert measure(folder, other) in (0, 1)


def test_the_same_files_under_other_names_are_the_same(folder):
    (folder / "renamed.yaml").write_text(INSPECTION)
    assert measure(folder, "renamed.yaml") in (0, 1)


def test_plot_looks_at_the_plan_too(folder, capsys):
    (folder / "other.yaml").write_text(INSPECTION.replace("16 mm", "16.4 mm"))
    assert main(["plot", str(folder / "other.yaml"), str(folder / "plan"), "-o", str(folder / "x.html")]) == 2
    assert "[plan_inputs]" in capsys.readouterr().err


# --- images ---------------------------------------------------------------------------------------------------------


def bomb(path: Path, side: int) -> None:
    """A PNG file that says it has side x side pixels, and holds next to nothing."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 1, 0, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"\0" * 100)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def test_an_image_of_another_size_is_named_and_the_others_measured(folder, capsys):
    good = sorted((folder / "images").glob("*.png"))[0]
    bomb(good.with_name(good.stem.split("_")[0] + "_0002.png"), 60_000)
    assert image_size(good) == (306, 256)
    assert measure(folder) in (1, 2)
    err = capsys.readouterr().err
    assert "60000 x 60000" in err
    assert "306 x 256" in err
    rows = list(csv.DictReader((folder / "m" / "measurements.csv").open()))
    assert {row["verdict"] for row in rows if row["image"] == good.name} - {"not measured"}


# --- devices and streams --------------------------------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs pipes with a name")
@pytest.mark.parametrize("given", ["inspection", "viewpoints", "covariance", "plan", "camera", "samples"])
@pytest.mark.parametrize("device", ["pipe", "/dev/zero"])
def test_a_pipe_or_a_device_is_no_file(tmp_path, given, device, capsys):
    inspection, place = inspection_in(tmp_path), tmp_path / "given.yaml"
    if device == "pipe":
        os.mkfifo(place)
    else:
        place.symlink_to(device)
    if given == "covariance":
        inspection.write_text(
            INSPECTION.replace("{translation: 0.1 mm, rotation: 0.02 deg}", "{covariance: given.yaml}")
        )
    arguments = {
        "inspection": ["check", place],
        "viewpoints": ["evaluate", inspection, "--viewpoints", place],
        "covariance": ["check", inspection],
        "plan": ["plot", inspection, place, "-o", tmp_path / "x.html"],
        "camera": ["camera", place],
        "samples": ["characterize", place],
    }[given]
    assert main([str(argument) for argument in arguments]) == 2
    assert "pipe or a device" in capsys.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full device")
@pytest.mark.parametrize(("how", "code"), [("> /dev/full", 2), (">&-", 0)])
def test_output_that_cannot_be_written_is_no_traceback(how, code):
    command = f"'{sys.executable}' -m viewgauge schema {how}"
    done = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert "Traceback" not in done.stderr
    assert done.returncode == code


def test_a_scheduler_that_never_answers(monkeypatch):
    cluster = pytest.importorskip("viewgauge.execution.cluster")
    monkeypatch.setattr(cluster, "_CONNECT_S", 0.5)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen(1)
        with (
            pytest.raises(vg.InputError, match="cannot be reached"),
            cluster.remote(f"tcp://127.0.0.1:{silent.getsockname()[1]}"),
        ):
            pass


# --- two at once, and what was left behind --------------------------------------------------------------------------


def test_two_plans_into_one_folder(tmp_path, capsys):
    from viewgauge.jobs.write import output_folder

    inspection = inspection_in(tmp_path)
    with output_folder(tmp_path / "out", alone=True):
        assert main(["plan", str(inspection), "-o", str(tmp_path / "out"), *QUICK]) == 2
    assert "another process is writing this" in capsys.readouterr().err
    assert main(["plan", str(inspection), "-o", str(tmp_path / "out"), *QUICK]) in (0, 1)


def table(path: Path) -> ZarrTable:
    layout = TableLayout(
        viewpoint_ids=tuple(f"V{k}" for k in range(6)),
        characteristic_ids=("a", "b"),
        columns=(Column("probability", "real"),),
        chunk_viewpoints=2,
    )
    return ZarrTable(path, layout, "the same job")


def write_chunk(table: ZarrTable, chunk: int) -> None:
    values = {"probability": np.arange(4.0).reshape(2, 2) + chunk}
    table.write(2 * chunk, values, {"chunk": chunk})


def damage_empty(job: Path) -> None:
    (job / "table" / "probability" / "0.0").write_bytes(b"")


def damage_gone(job: Path) -> None:
    (job / "table" / "probability" / "0.0").unlink()


def damage_no_summary(job: Path) -> None:
    np.savez(job / "done" / "00000000.npz", other=1)


def damage_bad_summary(job: Path) -> None:
    np.savez(job / "done" / "00000000.npz", summary="{")


def damage_layout(job: Path) -> None:
    (job / "table" / "probability" / ".zarray").write_text("{")


def damage_extra(job: Path) -> None:
    shutil.copy(job / "done" / "00000000.npz", job / "done" / "99999999.npz")


DAMAGES = [damage_empty, damage_gone, damage_no_summary, damage_bad_summary, damage_layout, damage_extra]


def tree(folder: Path) -> dict[str, bytes]:
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_a_damaged_journal_gives_the_same_table(tmp_path, damage):
    pytest.importorskip("zarr")
    with table(tmp_path / "whole.zarr") as whole:
        for chunk in range(3):
            write_chunk(whole, chunk)
    with pytest.raises(KeyboardInterrupt), table(tmp_path / "t.zarr") as stopped:  # noqa: PT012
        write_chunk(stopped, 0)
        write_chunk(stopped, 1)
        raise KeyboardInterrupt
    (job,) = (path for path in (tmp_path / ".t.zarr.partial").iterdir() if path.is_dir())
    damage(job)
    with table(tmp_path / "t.zarr") as again:
        assert 1 in again.done
        assert (0 in again.done) == (damage in (damage_layout, damage_extra))
        for chunk in {0, 1, 2} - again.done.keys():
            write_chunk(again, chunk)
    assert tree(tmp_path / "t.zarr") == tree(tmp_path / "whole.zarr")


@pytest.mark.skipif(sys.platform != "linux", reason="needs an exchange of folders")
def test_a_folder_is_replaced_in_one_step(tmp_path):
    from viewgauge.formats.files.atomic import exchange

    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "file").write_text(name)
    assert exchange(tmp_path / "one", tmp_path / "other")
    assert (tmp_path / "other" / "file").read_text() == "one"
