"""Files from a browser: where they may land, and what an inspection among them may read."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

pytest.importorskip("viser")

import viewgauge as vg
from viewgauge.exceptions import InputError
from viewgauge.execution.child_process import Job
from viewgauge.jobs.workbench.child_jobs import load_uploaded
from viewgauge.web.uploads import INSPECTION_SUFFIXES, OTHER_SUFFIXES, stored

BLOCK = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("part.step", "part.step"),
        ("../../etc/cron.d/evil.step", "evil.step"),
        ("C:\\Users\\me\\part.stl", "part.stl"),
        ("/etc/passwd.csv", "passwd.csv"),
        (".hidden.stl", "hidden.stl"),
        ("a\x00b<script>.stl", "a_b_script_.stl"),
        ("x" * 300 + ".stl", "x" * 96 + ".stl"),
    ],
)
def test_files_land_in_their_folder_under_a_plain_name(tmp_path, name, plain):
    path = stored(tmp_path, name, b"content", OTHER_SUFFIXES)
    assert path == tmp_path / plain
    assert path.read_bytes() == b"content"
    assert [p.name for p in tmp_path.iterdir()] == [plain]


@pytest.mark.parametrize("name", ["script.py", "page.html", "noending", "..", "", "plan.json", "inspection.yaml.exe"])
def test_other_kinds_are_refused(tmp_path, name):
    with pytest.raises(InputError, match="not taken"):
        stored(tmp_path, name, b"", OTHER_SUFFIXES)
    assert not list(tmp_path.iterdir())


def test_large_inspections_are_refused(tmp_path):
    with pytest.raises(InputError, match="too large"):
        stored(tmp_path, "inspection.yaml", b" " * (2**20 + 1), INSPECTION_SUFFIXES)


def test_many_files_are_refused(tmp_path):
    for k in range(20):
        stored(tmp_path, f"{k}.stl", b"", OTHER_SUFFIXES)
    stored(tmp_path, "3.stl", b"again", OTHER_SUFFIXES)
    with pytest.raises(InputError, match="too many"):
        stored(tmp_path, "20.stl", b"", OTHER_SUFFIXES)


def test_a_link_in_its_place_is_not_followed(tmp_path):
    outside = tmp_path / "outside.csv"
    outside.write_text("mine")
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "viewpoints.csv").symlink_to(outside)
    stored(folder, "viewpoints.csv", b"theirs", OTHER_SUFFIXES)
    assert outside.read_text() == "mine"


@pytest.fixture
def sent(tmp_path):
    """What a visitor sent: an inspection beside its part; and a file outside."""
    folder = tmp_path / "visitor"
    folder.mkdir()
    for name in ("inspection.yaml", "slotted_block.step"):
        shutil.copyfile(BLOCK / name, folder / name)
    secret = tmp_path / "secret.yaml"
    secret.write_text("covariance: a secret\n")
    return folder


def naming(folder, key, name):
    """The inspection with a file named under a key."""
    text = (folder / "inspection.yaml").read_text(encoding="utf-8")
    replaced = {
        "part.file": text.replace("file: slotted_block.step", f"file: {name}"),
        "pose_uncertainty.covariance": text.replace("translation: 0.1 mm", f"covariance: {name}").replace(
            "  rotation: 0.02 deg\n", ""
        ),
        "candidates.viewpoints": text.replace("directions: 200", f"viewpoints: {name}"),
        "camera.calibration": text.replace("focal_length: 16 mm", f"calibration: {name}"),
        "pose_uncertainty.common.covariance": text.replace(
            "  rotation: 0.02 deg", f"  rotation: 0.02 deg\n  common:\n    covariance: {name}"
        ),
    }[key]
    assert replaced != text
    (folder / "inspection.yaml").write_text(replaced, encoding="utf-8")


def test_an_inspection_with_its_part_is_read_in_a_child(sent):
    inspection = Job(load_uploaded, sent / "inspection.yaml").result()
    assert len(inspection.part.characteristics) == 15


@pytest.mark.parametrize(
    "key",
    [
        "part.file",
        "pose_uncertainty.covariance",
        "candidates.viewpoints",
        "camera.calibration",
        "pose_uncertainty.common.covariance",
    ],
)
@pytest.mark.parametrize("how", ["above", "absolute", "link"])
def test_no_key_reads_a_file_outside_its_folder(sent, key, how):
    secret = sent.parent / "secret.yaml"
    name = {"above": "../secret.yaml", "absolute": str(secret), "link": "link.yaml"}[how]
    (sent / "link.yaml").symlink_to(secret)
    naming(sent, key, name)
    with pytest.raises(InputError, match="outside the project's folder") as caught:
        vg.load(sent / "inspection.yaml", within=sent)
    assert caught.value.key == key
    assert "a secret" not in str(caught.value)


def test_a_broken_inspection_is_reported_by_the_child(sent):
    (sent / "inspection.yaml").write_text("camera: [", encoding="utf-8")
    with pytest.raises(InputError, match="not valid YAML"):
        Job(load_uploaded, sent / "inspection.yaml").result()
