"""An inspection that is saved with turned knobs is, read again, the one that was looked at; other lines stay."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.jobs.workbench.saved_inspection import changed_inspection_text
from viewgauge.jobs.workbench.what_if import WhatIf

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"
TURNED = {
    "pixel_pitch_mm": 0.0048,
    "edge_px": 0.21,
    "focal_length_mm": 21.5,
    "translation_mm": 0.083,
    "rotation_rad": np.radians(0.031),
    "required": 0.9985,
    "probability": 0.963,
}


@pytest.fixture
def folder(tmp_path):
    for name in ("inspection.yaml", "slotted_block.step", "real_camera.yaml", "camera.yaml"):
        shutil.copyfile(EXAMPLE / name, tmp_path / name)
    return tmp_path


def saved(folder, name="inspection.yaml", **turned):
    """The text, what has no place, and the inspection that was looked at."""
    path = folder / name
    inspection = vg.load(path)
    what_if = WhatIf(inspection, None)
    knobs = replace(what_if.today, **turned)
    text, homeless = changed_inspection_text(path.read_text(encoding="utf-8"), inspection, knobs)
    (folder / "saved.yaml").write_text(text, encoding="utf-8")
    return text, homeless, what_if.turned(knobs)


def test_read_again_it_is_the_same(folder):
    text, homeless, looked_at = saved(folder, **TURNED)
    assert homeless == ()
    again = vg.load(folder / "saved.yaml")
    assert again.camera.resolution == looked_at.camera.resolution
    assert again.camera.focal_length_mm == pytest.approx(21.5)
    assert again.camera.pixel_pitch_mm == pytest.approx((0.0048, 0.0048))
    assert again.camera.edge_resolution_px == pytest.approx(0.21)
    np.testing.assert_allclose(
        again.pose_error.camera_covariance, looked_at.pose_error.camera_covariance, rtol=1e-8, atol=1e-18
    )
    assert again.requirement.kind == "accuracy"
    assert (again.requirement.value, again.requirement.probability) == pytest.approx((0.9985, 0.963))
    assert "# the block lies on a table: the camera stays above it" in text
    assert again.candidates == vg.load(folder / "inspection.yaml").candidates


def test_what_was_not_turned_stays_to_the_letter(folder):
    text, homeless, _ = saved(folder)
    assert (text, homeless) == ((folder / "inspection.yaml").read_text(encoding="utf-8"), ())


def test_other_lines_stay(folder):
    text, _, _ = saved(folder, focal_length_mm=25.0)
    before = (folder / "inspection.yaml").read_text(encoding="utf-8").splitlines()
    changed = [(a, b) for a, b in zip(before, text.splitlines(), strict=True) if a.split() != b.split()]
    assert [(a.split(), b.split()) for a, b in changed if "pivot" not in a and "distance" not in a] == [
        (["focal_length:", "16", "mm"], ["focal_length:", "25", "mm"])
    ]


def test_what_other_files_state_has_no_place(folder):
    text, homeless, _ = saved(folder, "real_camera.yaml", focal_length_mm=30.0, pixel_pitch_mm=0.002, distance=1.2)
    assert homeless == ("pixel pitch", "focal length", "distance")
    assert text == (folder / "real_camera.yaml").read_text(encoding="utf-8")
