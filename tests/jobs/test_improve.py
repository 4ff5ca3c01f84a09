"""What to improve on the slotted block: every answer is met and 0.1 % short of it is not, by the evaluated table."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.evaluation import WARNINGS
from viewgauge.execution.chunks import candidate_grid
from viewgauge.jobs.write import describe_answers
from viewgauge.planning.improve.catalogue import SensorFormat
from viewgauge.planning.inspection import ExplicitSettings

BLOCK = Path(__file__).resolve().parents[2] / "examples" / "slotted_block" / "looks.yaml"
SHORT = 1.001
DIMENSIONS = ("E1", "E5", "E7", "E9")


def inspection_of(**changes):
    inspection = vg.load(BLOCK)
    part = replace(inspection.part, dimensions=tuple(d for d in inspection.part.dimensions if d.id in DIMENSIONS))
    options = replace(inspection.candidates, directions=60)
    return replace(inspection, part=part, candidates=options, looks=1, **changes)


@pytest.fixture(scope="module")
def inspection():
    return inspection_of()


@pytest.fixture(scope="module")
def improvement(inspection):
    return vg.improve(inspection)


def head_of(inspection, translation, rotation):
    scale = np.diag([translation] * 3 + [rotation] * 3)
    head = inspection.head
    return vg.PoseError(scale @ head.covariance @ scale, T_camera_head=head.T_camera_head)


def changed(inspection, knob, value, today):
    """The inspection a user would write with this value in it."""
    factor = value / today[knob]
    if knob == "pixel":
        return replace(inspection, camera=replace(inspection.camera, edge_resolution_px=value))
    if knob == "translation":
        return replace(inspection, head=head_of(inspection, factor, 1))
    if knob == "rotation":
        return replace(inspection, head=head_of(inspection, 1, factor))
    if knob == "head":
        return replace(inspection, head=head_of(inspection, factor, factor))
    if knob == "focal_length":
        near, far = inspection.candidates.distance_mm
        options = replace(inspection.candidates, distance_mm=(near * factor, far * factor))
        return replace(inspection, camera=replace(inspection.camera, focal_length_mm=value), candidates=options)
    options = replace(inspection.candidates, distance_mm=(value, value), distances=1)
    return replace(inspection, candidates=options)


def met(inspection, extra):
    """Ids met from some candidate or extra pose, by the table that evaluate gives."""
    grid = candidate_grid(inspection, inspection.part.dimensions)
    poses = np.concatenate([grid.poses(0, len(grid)), np.zeros((0, 4, 4)) if extra is None else extra])
    settings = ExplicitSettings(tuple(f"C{k}" for k in range(len(poses))), poses)
    table = vg.evaluate(replace(inspection, settings=settings))
    sure = (table["accepted"] & ~table["validity"].isin(WARNINGS)).any("setting")
    return set(table["dimension"].values[sure.values])


@pytest.fixture(scope="module")
def extra(inspection):
    """The poses that refining found."""
    plan = vg.plan(inspection, prove=False)
    return np.array([d.T_part_camera for d in plan.dimensions if d.T_part_camera is not None])


@pytest.mark.parametrize("knob", ["pixel", "translation", "rotation", "head", "focal_length", "distance"])
def test_met_at_the_answer_and_not_short_of_it(inspection, improvement, extra, knob):
    today, moves = improvement.today, knob in ("focal_length", "distance")
    tried = 0
    for dimension in improvement.dimensions:
        change = dimension.changes[knob]
        assert change.verified
        if change.interval is None:
            continue
        low, high = change.interval
        for value, beyond in ((low, 1 / SHORT), (high, SHORT)):
            if value:
                at = met(changed(inspection, knob, value, today), None if moves else extra)
                short = met(changed(inspection, knob, value * beyond, today), None if moves else extra)
                assert dimension.id in at
                assert dimension.id not in short
                tried += 1
    assert tried, "some dimension has an answer"


def test_what_is_met_has_slack_and_what_is_not_needs_less(improvement, inspection, extra):
    today = met(inspection, extra)
    assert {d.id for d in improvement.dimensions if d.met} == today
    assert 0 < len(today) < len(DIMENSIONS)
    for dimension in improvement.dimensions:
        for name in ("pixel", "translation", "rotation", "head"):
            factor = dimension.changes[name].factor
            assert factor is None or (factor >= 1) == dimension.met
            if factor is None:  # hopeless: without this error it is still not sure enough, but surer than today
                best = dimension.changes[name].best_probability
                assert dimension.probability - 1e-9 <= best < 0.95


def test_the_part_is_as_good_as_its_worst_dimension(improvement):
    for name in ("pixel", "translation", "rotation", "head"):
        factors = {d.id: d.changes[name].factor for d in improvement.dimensions}
        change = improvement.part[name]
        if None in factors.values():
            assert change.factor is None
            assert set(change.limited_by) == {i for i, f in factors.items() if f is None}
        else:
            assert change.factor == min(factors.values())
            assert factors[change.limited_by[0]] == change.factor
        assert change.verified


def test_finer_pixels_allow_a_worse_head(improvement, inspection, extra):
    heads = [0.0 if t.head_factor is None else t.head_factor for t in improvement.trade_off]
    pixels = [t.pixel_px for t in improvement.trade_off]
    assert pixels == sorted(pixels)
    assert heads == sorted(heads, reverse=True)
    trade = next(t for t in reversed(improvement.trade_off) if t.head_factor is not None)
    both = changed(inspection, "pixel", trade.pixel_px, improvement.today)
    assert met(replace(both, head=head_of(inspection, trade.head_factor, trade.head_factor)), extra) == set(DIMENSIONS)
    worse = trade.head_factor * SHORT
    assert met(replace(both, head=head_of(inspection, worse, worse)), extra) < set(DIMENSIONS)


def test_what_cannot_be_turned_is_left_out():
    inspection = inspection_of()
    camera = replace(inspection.camera, edge_resolution_px=0.0)
    head = head_of(inspection, 1, 0)
    improvement = vg.improve(replace(inspection, camera=camera, head=head))
    assert set(improvement.today) == {"translation", "head", "focal_length", "distance"}
    assert not improvement.trade_off


def test_explicit_settings_stay_where_they_are(inspection):
    settings = ExplicitSettings(("A",), vg.plan(inspection, prove=False).settings[0].T_part_camera[None])
    improvement = vg.improve(replace(inspection, settings=settings))
    assert set(improvement.today) == {"pixel", "translation", "rotation", "head"}
    with pytest.raises(vg.InputError, match="settings given one by one"):
        vg.specify(replace(inspection, settings=settings))


def test_without_a_dimension_nothing_can_be_asked(inspection):
    empty = replace(inspection, part=replace(inspection.part, dimensions=()))
    for question in (vg.improve, vg.specify):
        with pytest.raises(vg.InputError, match="no dimension"):
            question(empty)


def test_documents_hold_the_answers(improvement, inspection):
    document = describe_answers(improvement, inspection)
    assert document["dimensions"][0]["changes"]["pixel"]["value"] == improvement.dimensions[0].changes["pixel"].value
    assert document["knobs"]["distance"]["today"] == 450


def test_a_camera_is_specified_with_a_head(inspection):
    sensors = (SensorFormat("big", (4096, 3000), 0.00345), SensorFormat("small", (720, 540), 0.0069))
    asked = replace(inspection, requirement=vg.Requirement("accuracy", 0.999, 0.95))
    specification = vg.specify(asked, sensors=sensors, focal_lengths_mm=(25.0, 16.0))
    assert [(c.sensor.name, c.focal_length_mm) for c in specification.choices] == [
        ("small", 16.0), ("small", 25.0), ("big", 16.0), ("big", 25.0),
    ]  # fmt: skip
    answered = 0
    for choice in specification.choices:
        assert choice.head.verified
        pitch = (choice.sensor.pixel_pitch_mm,) * 2
        camera = vg.Camera(
            choice.focal_length_mm, pitch, choice.sensor.resolution, inspection.camera.edge_resolution_px
        )
        with_camera = replace(asked, camera=camera)
        assert len(met(with_camera, None)) == choice.met
        if choice.head.factor is not None:
            factor = choice.head.factor
            at = met(replace(with_camera, head=head_of(asked, factor, factor)), None)
            short = met(replace(with_camera, head=head_of(asked, factor * SHORT, factor * SHORT)), None)
            assert len(at) == len(DIMENSIONS)
            assert len(short) < len(DIMENSIONS)
            assert choice.translation_mm == pytest.approx(factor * np.sqrt(asked.head.covariance[:3, :3].max()))
            answered += 1
        if choice.pixel.factor is not None:
            step = choice.pixel.value
            at = met(replace(with_camera, camera=replace(camera, edge_resolution_px=step)), None)
            short = met(replace(with_camera, camera=replace(camera, edge_resolution_px=step * SHORT)), None)
            assert len(short) < len(at) == len(DIMENSIONS)
    assert answered
    smallest = specification.smallest
    good = [c for c in specification.best if c.head.factor is not None and c.head.factor >= 1]
    assert smallest == (good[0] if good else None)
    document = describe_answers(specification, inspection)
    assert len(document["choices"]) == 4
