"""A kind of requirement added from outside the package: a class, its keys, and one registration."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import trimesh

import viewgauge as vg
from viewgauge.formats.inspection.requirement_section import KINDS, register
from viewgauge.formats.inspection.validation import build, validate
from viewgauge.formats.inspection.values import Length, Section


@dataclass(frozen=True)
class PerLength(vg.Requirement):
    """A + L/K, as the error of coordinate measuring machines is stated, at 95 %."""

    kind: str = field(init=False, default="per_length")
    value: float
    probability: float = field(init=False, default=0.95)
    per_mm: float = 0.0

    def __post_init__(self):
        if self.value <= 0:
            raise vg.InputError("must be positive", key="fixed", got=self.value)

    def allowed_error_mm(self, nominal_mm, tolerance_mm):  # noqa: ARG002
        return self.value + self.per_mm * nominal_mm

    @property
    def text(self):
        return f"error of at most {self.value:g} mm + {self.per_mm:g} L"


class PerLengthSection(Section):
    key: ClassVar[str] = "per_length"

    fixed: Length
    per_metre: Length

    @classmethod
    def read(cls, value, where, problems):
        section = validate(cls, value, where, problems)
        return build(PerLength, where, problems, section.fixed, section.per_metre / 1000) if section else None


@pytest.fixture(autouse=True)
def registered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    trimesh.creation.box(bounds=[(0, 0, 0), (80, 50, 40)]).export("box.stl")
    register(PerLengthSection)
    yield
    del KINDS["per_length"]


def inspection(requirement):
    Path("inspection.yaml").write_text(
        "part:\n  file: box.stl\n  characteristics:\n"
        "    - {id: width, points: [[0, 0, 40], [80, 0, 40]], unit: mm, tolerance: 0.1 mm}\n"
        "camera: {focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048]}\n"
        f"pose_uncertainty: {{translation: 0.01 mm, rotation: 0.002 deg}}\nrequirement: {requirement}\n"
        "candidates: {directions: 20, rolls: 1, distances: 1}\n"
    )
    return vg.load("inspection.yaml")


def test_it_is_read_planned_and_put_in_words():
    read = inspection("{per_length: {fixed: 10 um, per_metre: 500 um}}")
    assert read.requirement == PerLength(0.01, per_mm=0.0005)
    plan = vg.plan(read, refine=False, prove=False)
    (width,) = plan.characteristics
    assert width.allowed_error_mm == pytest.approx(0.01 + 80 * 0.0005)
    own = vg.plan(
        inspection(f"{{error: {0.01 + 80 * 0.0005} mm, probability: 0.95}}"), refine=False, prove=False
    ).characteristics[0]
    assert np.isclose(width.probability, own.probability, rtol=0, atol=1e-12)
    assert read.requirement.text == "error of at most 0.01 mm + 0.0005 L"


def test_its_mistakes_are_reported_with_their_key_and_it_stands_alone():
    with pytest.raises(vg.InspectionFileError, match=r"requirement\.per_length\.per_metre"):
        inspection("{per_length: {fixed: 10 um}}")
    with pytest.raises(vg.InspectionFileError, match="the probability follows from the per_length"):
        inspection("{per_length: {fixed: 10 um, per_metre: 1 um}, probability: 0.9}")
    with pytest.raises(vg.InspectionFileError, match="more than one requirement"):
        inspection("{per_length: {fixed: 10 um, per_metre: 1 um}, error: 1 mm}")
