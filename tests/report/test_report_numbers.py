"""Every number that the report prints is the API's, and its charts draw what the API computes."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_report import Page

import viewgauge as vg
from viewgauge.evaluation.error_budget import GROUPS
from viewgauge.jobs.budgets import capability_of_characteristics, error_budgets
from viewgauge.jobs.improvement.improve import settled_improvement
from viewgauge.jobs.laws import measurand_laws
from viewgauge.jobs.write_report import plan_details, plan_report
from viewgauge.report import render_report

BLOCK = Path(__file__).resolve().parents[2] / "examples" / "slotted_block" / "inspection.yaml"
STEP = 1e-4
"""Probabilities are printed to four digits, rounded down."""


@pytest.fixture(scope="module")
def inspection():
    """Four characteristics of the block, one of which no viewpoint meets."""
    inspection = vg.load(BLOCK)
    part = replace(
        inspection.part,
        characteristics=tuple(d for d in inspection.part.characteristics if d.id in ("E1", "E5", "E9", "E14/1")),
    )
    options = replace(inspection.candidates, directions=60)
    return replace(
        inspection, part=part, candidates=options, requirement=replace(inspection.requirement, probability=0.99)
    )


@pytest.fixture(scope="module")
def plan(inspection):
    return vg.plan(inspection, prove=False, refine=False)


@pytest.fixture(scope="module")
def text(plan, inspection):
    return plan_report(plan, inspection)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def number(text: str) -> float:
    """A printed number; "> 0.9999" is the number it exceeds."""
    return float(re.sub(r"[^0-9.eE+-]", "", text.replace("−", "-")))


def is_floor_of(text: str, value: float) -> bool:
    return number(text) - 1e-9 <= value <= number(text) + STEP + 1e-9


def rows_of(page: Page, columns: int, name: str) -> list[str]:
    (row,) = [row for row in page.rows if len(row) == columns and row[0] == name]
    return row


def test_some_characteristic_is_met_and_some_is_not(plan):
    assert {characteristic.status for characteristic in plan.characteristics} == {"met", "not_met"}


def test_table_of_characteristics(page, plan):
    for characteristic in plan.characteristics:
        row = rows_of(page, 10, characteristic.id)
        assert row[1] == characteristic.kind
        assert number(row[2]) == pytest.approx(characteristic.nominal_mm, abs=5e-5)
        assert number(row[4]) == pytest.approx(characteristic.allowed_error_mm, abs=5e-5)
        assert row[5] == {"met": "met", "not_met": "not met"}[characteristic.status]
        assert is_floor_of(row[6], characteristic.probability)
        assert is_floor_of(row[7], characteristic.expected_accuracy)
        assert row[8] == (characteristic.viewpoint or "–")


def test_table_of_viewpoints(page, plan):
    for viewpoint in plan.viewpoints:
        row = rows_of(page, 7, viewpoint.id)
        position = [number(part) for part in row[1].split(", ")]
        assert position == pytest.approx(viewpoint.T_part_camera[:3, 3], abs=0.051)
        assert [number(part) for part in row[2].split(", ")] == pytest.approx(
            viewpoint.T_part_camera[:3, 2], abs=5.1e-4
        )
        assert row[5:] == [str(len(viewpoint.observes)), ", ".join(viewpoint.observes)]


def test_laws(page, plan, inspection):
    laws = measurand_laws(inspection, plan)
    assert set(laws) == {characteristic.id for characteristic in plan.characteristics}
    for characteristic in plan.characteristics:
        law = laws[characteristic.id]
        # beside the table: the laws' own probability is the plan's
        assert float(law.probability(characteristic.allowed_error_mm)) == pytest.approx(
            characteristic.probability, abs=1e-9
        )
        uncertainty = f"u {law.standard_uncertainty_mm:.4f}".rstrip("0")
        joint, of_1998 = re.search(
            re.escape(f"{characteristic.id}{uncertainty} mm")
            + r"allowed \S+ mmprobability (.*?)by the model of 1998 ([\d.]+)",
            page.text,
        ).groups()
        assert is_floor_of(joint, characteristic.probability)
        assert is_floor_of(of_1998, float(law.independent_probability(characteristic.allowed_error_mm)))


def test_charts_of_the_laws(page, plan, inspection):
    laws, charts = measurand_laws(inspection, plan), page.scene["laws"]
    ranked = sorted(plan.characteristics, key=lambda d: (d.status == "met", d.probability))
    for k, characteristic in enumerate(ranked):
        law, (densities, accuracy) = laws[characteristic.id], charts[f"law-{k}"]
        (total,) = [curve for curve in densities["data"] if curve["name"] == "together"]
        micrometres = total["x0"] + total["dx"] * np.arange(len(total["y"]))
        assert total["y"] == pytest.approx(law.total.pdf(micrometres / 1000) / 1000, rel=1e-3, abs=1e-12)
        joint = accuracy["data"][0]
        percent = joint["x0"] + joint["dx"] * np.arange(len(joint["y"]))
        error = (1 - percent / 100) * law.length_mm
        assert joint["y"] == pytest.approx(law.probability(error), abs=1e-4)


def test_error_budget(page, plan, inspection):
    for name, budget in error_budgets(inspection, plan).items():
        row = rows_of(page, 11, name)
        assert number(row[1]) == pytest.approx(float(budget.combined_uncertainty_mm), abs=5.1e-5)
        shares = [budget.group_share["translation"], budget.group_share["rotation"], budget.share[6], budget.share[7]]
        assert [number(cell) for cell in row[3:7]] == pytest.approx([100 * float(s) for s in shares], abs=0.51)
        without = [budget.group_probability_without[group] for group in ("camera", "translation", "rotation")]
        assert all(
            is_floor_of(cell, float(value)) for cell, value in zip(row[7:], [budget.probability, *without], strict=True)
        )
    assert GROUPS.keys() >= {"camera", "translation", "rotation"}


def test_figures_of_the_measurand(page, plan, inspection):
    figures = capability_of_characteristics(inspection, plan)
    for name, figure in figures.items():
        (row,) = [row for row in page.rows if len(row) == 6 and row[0] == name and "≤" not in row[2]]
        assert number(row[1]) == pytest.approx(figure.expanded_uncertainty_mm, abs=5.1e-5)
        values = (figure.percent_p_to_t, figure.cg, figure.cgk, figure.test_uncertainty_ratio)
        assert [number(cell) for cell in row[2:]] == pytest.approx(values, rel=6e-3)


def test_what_to_improve(page, plan, inspection):
    improvement = settled_improvement(inspection, plan)
    knobs = list(improvement.today)
    assert knobs == ["pixel", "translation", "rotation", "pose_error"]
    for characteristic in improvement.characteristics:
        candidates = [row for row in page.rows if len(row) == 6 and row[0] == characteristic.id]
        (row,) = [row for row in candidates if "≤" in "".join(row) or "(" in "".join(row)]
        assert is_floor_of(row[1], characteristic.probability)
        for cell, knob in zip(row[2:], knobs, strict=True):
            change = characteristic.changes[knob]
            if change.value is None:
                assert is_floor_of(cell, change.best_probability)
            else:
                assert number(cell) == pytest.approx(change.value, rel=1e-3)


def test_summary(page, plan):
    met = [characteristic for characteristic in plan.characteristics if characteristic.status == "met"]
    weakest = min(met, key=lambda characteristic: characteristic.probability)
    assert f"{len(met)} of {len(plan.characteristics)}" in page.text
    assert f"{weakest.id}probability {int(weakest.probability * 1e4) / 1e4:.4f}" in page.text
    assert f"{plan.candidate_count:,}" in page.text
    assert str(plan.seed) in page.row("Seed")


def test_views_show_the_part_and_where_the_measurands_are(page, plan, inspection):
    """The picture is light where the part is, and the drawn ends are where the camera images the two points."""
    pictures = [attributes for tag, attributes in page.elements if tag == "image"]
    assert len(pictures) == plan.count
    lines = [attributes for tag, attributes in page.elements if tag == "line"]
    drawn = [[float(line[key]) for key in ("x1", "y1", "x2", "y2")] for line in lines]
    for viewpoint, picture in zip(plan.viewpoints, pictures, strict=True):
        grey = np.asarray(Image.open(BytesIO(base64.b64decode(picture["href"].split(",")[1]))))
        shape = np.array(inspection.camera.resolution[::-1]) / 2448 * 480
        assert grey.shape == pytest.approx(shape, abs=1)
        assert (grey > 80).mean() > 0.02
        T = np.linalg.inv(viewpoint.T_part_camera)
        for characteristic in plan.characteristics:
            if characteristic.viewpoint != viewpoint.id:
                continue
            at_camera = characteristic.measurand @ T[:3, :3].T + T[:3, 3]
            # a pinhole by hand, so that the drawing is judged by other formulas
            pixels = at_camera[:, :2] / at_camera[:, 2:] * 16 / 0.00345 + [1223.5, 1023.5]
            assert min(np.abs(np.array(line) - pixels.ravel()).max() for line in drawn) < 0.06


def test_it_is_small_and_complete(text, inspection):
    assert len(text.encode()) < 10_000_000
    assert all(digest in text for digest in inspection.inputs.values())
    assert "http://" not in re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL)


def test_data_of_the_pictures_is_valid_json_without_nan(page):
    assert json.dumps(page.scene, allow_nan=False)


def test_a_report_that_would_be_too_large_shows_less_and_says_so(plan, inspection):
    """Pictures that hardly compress, as of many intricate viewpoints."""
    noise = np.random.default_rng(3).integers(0, 256, 450_000, dtype=np.uint8).tobytes()
    shown = plan_details(plan, inspection)
    many = tuple(replace(shown.views[0], viewpoint=f"S{k}", png=noise) for k in range(12))
    text = render_report(
        plan,
        inspection.part,
        inspection.camera,
        inspection.requirement,
        title="large",
        inputs={},
        details=replace(shown, views=many),
    )
    assert len(text.encode()) <= 9_900_000
    page = Page(text)
    reported = re.search(r"The first (\d+) of 12 viewpoints are here", page.text)
    pictures = [attributes for tag, attributes in page.elements if tag == "image"]
    assert len(pictures) == int(reported[1])
    assert 0 < len(pictures) < 12
