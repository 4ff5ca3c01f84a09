"""What a plan would be worth: every answer is what evaluating the inspection that a user would write gives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.jobs.workbench.what_if import WhatIf
from viewgauge.planning.improve.knob_values import KnobValues, moved_along_axis, with_pixel_pitch

BLOCK = Path(__file__).resolve().parents[2] / "examples" / "slotted_block" / "inspection.yaml"


@pytest.fixture(scope="module")
def inspection():
    inspection = vg.load(BLOCK)
    part = replace(
        inspection.part,
        characteristics=tuple(d for d in inspection.part.characteristics if d.id in ("E1", "E5", "E9", "E14/1")),
    )
    return replace(inspection, part=part, candidates=replace(inspection.candidates, directions=60))


@pytest.fixture(scope="module")
def plan(inspection):
    """For nearly certain measurements, so that it has more than one viewpoint."""
    demanding = replace(inspection, requirement=replace(inspection.requirement, probability=0.985))
    return vg.plan(demanding, prove=False, refine=False)


@pytest.fixture(scope="module")
def what_if(inspection, plan):
    return WhatIf(inspection, plan)


def poses_of(plan):
    return np.array([viewpoint.T_part_camera for viewpoint in plan.viewpoints])


def assert_answers(answers, inspection, poses):
    """They are the best of the table that the API evaluates."""
    table = vg.evaluate(inspection, poses)
    best = table.probability.values.max(axis=0)
    assert [answer.characteristic.id for answer in answers.characteristics] == list(table.characteristic.values)
    assert [answer.probability for answer in answers.characteristics] == pytest.approx(best, abs=1e-12)
    assert [answer.met for answer in answers.characteristics] == list(table.accepted.values.any(axis=0))
    assert answers.met == table.accepted.values.any(axis=0).sum()
    names = list(answers.viewpoints)
    for j, answer in enumerate(answers.characteristics):
        if answer.viewpoint is None:
            assert not table.visible.values[:, j].any()
            assert answer.reason in set(table.reason.values[:, j])
        else:
            assert table.probability.values[names.index(answer.viewpoint), j] == pytest.approx(best[j], abs=1e-12)


def test_as_the_inspection_has_it(what_if, inspection, plan):
    assert_answers(what_if.answers(what_if.today), inspection, poses_of(plan))


def camera_of(inspection, **changes):
    return replace(inspection, camera=replace(inspection.camera, **changes))


def pose_error_of(inspection, translation, rotation):
    pose_error = vg.PoseError.from_standard_deviations(
        translation_mm=translation, rotation_rad=np.radians(rotation), pivot_mm=(0, 0, -16)
    )
    return replace(inspection, pose_error=pose_error)


@pytest.mark.parametrize(
    ("changes", "written"),
    [
        (
            {"pixel_pitch_mm": 0.0069},
            lambda i: camera_of(i, pixel_pitch_mm=(0.0069, 0.0069), resolution=(1224, 1024)),
        ),
        ({"edge_px": 0.25}, lambda i: camera_of(i, edge_resolution_px=0.25)),
        ({"focal_length_mm": 25.0}, lambda i: camera_of(i, focal_length_mm=25.0)),
        ({"translation_mm": 0.17}, lambda i: pose_error_of(i, 0.17, 0.02)),
        ({"rotation_rad": np.radians(0.05)}, lambda i: pose_error_of(i, 0.1, 0.05)),
        ({"required": 0.9993}, lambda i: replace(i, requirement=vg.Requirement("accuracy", 0.9993, 0.95))),
        ({"probability": 0.99}, lambda i: replace(i, requirement=vg.Requirement("accuracy", 0.999, 0.99))),
    ],
)
def test_each_knob_is_what_a_user_would_write(what_if, inspection, plan, changes, written):
    answers = what_if.answers(replace(what_if.today, **changes))
    assert_answers(answers, written(inspection), poses_of(plan))
    # and it is not without effect
    before = [answer.probability for answer in what_if.answers(what_if.today).characteristics]
    if "probability" not in changes:
        assert [answer.probability for answer in answers.characteristics] != pytest.approx(before, abs=1e-4)


def test_distance_moves_cameras_along_their_axes(what_if, inspection, plan):
    answers = what_if.answers(replace(what_if.today, distance=1.4))
    for name, T in answers.viewpoints.items():
        (planned,) = [viewpoint.T_part_camera for viewpoint in plan.viewpoints if viewpoint.id == name]
        measurands = [d.measurand for d in plan.characteristics if d.viewpoint == name]
        middle = np.concatenate(measurands).mean(axis=0)
        depth, before = ((middle - pose[:3, 3]) @ planned[:3, 2] for pose in (T, planned))
        assert depth == pytest.approx(1.4 * before)
        np.testing.assert_allclose(T[:3, :3], planned[:3, :3])
        moved = T[:3, 3] - planned[:3, 3]
        assert np.linalg.norm(np.cross(moved, planned[:3, 2])) < 1e-9 * np.linalg.norm(moved)
    assert_answers(answers, inspection, np.array(list(answers.viewpoints.values())))


def test_a_dragged_camera_stands_where_it_was_dragged_to(what_if, inspection, plan):
    knobs = replace(what_if.today, distance=0.8)
    name = plan.viewpoints[0].id
    wanted = plan.viewpoints[0].T_part_camera.copy()
    wanted[:3, 3] += [12.0, -7.0, 5.0]
    answers = what_if.answers(knobs, {name: what_if.placed(knobs, name, wanted)})
    np.testing.assert_allclose(answers.viewpoints[name], wanted, atol=1e-9)
    assert_answers(answers, inspection, np.array(list(answers.viewpoints.values())))


def test_without_a_plan_nothing_is_measured(inspection):
    what_if = WhatIf(inspection, None)
    answers = what_if.answers(what_if.today)
    assert answers.viewpoints == {}
    assert {answer.reason for answer in answers.characteristics} == {"no viewpoint yet"}
    assert answers.met == 0


def test_laws_and_budget_are_those_of_the_answer(what_if):
    answers = what_if.answers(replace(what_if.today, translation_mm=0.2))
    seen = [answer for answer in answers.characteristics if answer.viewpoint is not None]
    assert len(seen) > 1
    for answer in seen:
        laws, budget = (make(answers, answer.characteristic.id) for make in (what_if.laws, what_if.budget))
        assert float(laws.probability(answer.allowed_error_mm)) == pytest.approx(answer.probability, abs=1e-9)
        assert float(budget.probability) == pytest.approx(answer.probability, abs=1e-9)
        assert float(budget.combined_uncertainty_mm) == pytest.approx(laws.standard_uncertainty_mm, rel=1e-9)


def test_directions_are_what_cameras_there_would_measure(what_if, inspection):
    """The centre of the image looks at the middle of the characteristic from each; the reason is the table's."""
    answers = what_if.answers(what_if.today)
    found = what_if.directions(answers, "E5", 320.0)
    assert np.linalg.norm(found.directions, axis=1) == pytest.approx(1)
    # even: a Fibonacci lattice of 900 has its mean near the centre
    assert np.abs(found.directions.mean(axis=0)).max() < 2e-3
    some = np.arange(0, len(found.directions), 37)
    table = vg.evaluate(inspection, found.T_part_camera[some]).sel(characteristic="E5")
    assert found.probability[some] == pytest.approx(table.probability.values, abs=1e-12)
    assert list(found.reason[some]) == list(table.reason.values)
    eyes = found.T_part_camera[:, :3, 3]
    np.testing.assert_allclose(eyes, found.target_mm + 320.0 * found.directions, atol=1e-9)
    ahead = found.target_mm - eyes
    np.testing.assert_allclose(ahead / 320.0, found.T_part_camera[:, :3, 2], atol=1e-9)
    assert 0 < (found.reason == "").sum() < len(found.reason)


def test_view_draws_what_the_table_says(what_if, plan):
    answers = what_if.answers(what_if.today)
    name = plan.viewpoints[0].id
    view = what_if.view(answers, name)
    assert view.png.startswith(b"\x89PNG")
    assert {d.id for d in view.characteristics} == {a.characteristic.id for a in answers.characteristics}
    for j, characteristic in enumerate(view.characteristics):
        assert characteristic.probability == answers.table.probability[0, j]
        assert (characteristic.ends_px is None) == bool(characteristic.reason)


def test_candidates_are_some_of_those_that_a_plan_samples(what_if, inspection):
    answers = what_if.answers(what_if.today)
    poses, share = what_if.candidates(answers, 50)
    assert len(poses) == len(share) == 50
    accepted = vg.evaluate(inspection, poses).accepted.values
    assert share == pytest.approx(accepted.mean(axis=1))


def test_a_value_out_of_range_is_refused_with_words(what_if):
    with pytest.raises(vg.InputError, match="accuracy must lie between 0 and 1"):
        what_if.answers(replace(what_if.today, required=1.0))


@pytest.mark.parametrize(
    ("field", "value"),
    [("distance", 0.0), ("distance", np.nan), ("focal_length_mm", -1.0), ("pixel_pitch_mm", np.inf), ("edge_px", -0.1)],
)
def test_knobs_stand_at_numbers_that_there_are(what_if, field, value):
    with pytest.raises(vg.InputError) as caught:
        replace(what_if.today, **{field: value})
    assert caught.value.key == field


def test_requirements_by_other_figures_stay(inspection):
    from viewgauge.evaluation import CapabilityRequirement

    requirement = CapabilityRequirement("cg", 1.33)
    knobs = KnobValues.of(replace(inspection, requirement=requirement).setup)
    assert knobs.required is None
    same = replace(knobs, edge_px=0.2).applied(replace(inspection, requirement=requirement).setup).requirement
    assert same is requirement


def test_smaller_pixels_on_the_same_sensor_see_the_same():
    camera = vg.Camera(16.0, (0.004, 0.005), (1000, 800), principal_point_px=(510.2, 395.9))
    finer = with_pixel_pitch(camera, 0.5)
    assert finer.resolution == (2000, 1600)
    points = np.array([[10.0, -20.0, 400.0], [-31.0, 17.0, 350.0]])
    before, after = (c.to_pixels(c.project(points)) for c in (camera, finer))
    # the centre of pixel 0 is at 0: its left border at -0.5 in both
    np.testing.assert_allclose(after + 0.5, 2 * (before + 0.5), atol=1e-9)


def test_moving_by_one_is_staying():
    T = np.eye(4)[None]
    np.testing.assert_array_equal(moved_along_axis(T, np.array([[0, 0, 300.0]]), 1.0), T)
