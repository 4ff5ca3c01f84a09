"""The largest error with which a segment is measured: by hand where there is one viewpoint and one error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from viewgauge.error_sources import scaled_pose_error
from viewgauge.evaluation import Evaluator, Requirement, Setup
from viewgauge.geometry import PoseError, look_at
from viewgauge.part import Characteristic, LengthBetweenPoints, Mesh
from viewgauge.planning.improve.knobs import KNOBS, Rig
from viewgauge.planning.improve.least_change import SHORT, largest_factor, meeting, met_interval
from viewgauge.sensors import Camera

LENGTH, DEPTH, FOCAL, PITCH, REQUIRED = 40.0, 250.0, 12.0, 0.005, 0.9
CAMERA = Camera(FOCAL, (PITCH, PITCH), (1200, 900), edge_resolution_px=0.25)
PLATE = Mesh(
    np.array([[-60.0, -60, 0], [60, -60, 0], [60, 60, 0], [-60, 60, 0], [0, 0, -5]]),
    np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]),
)
UP = np.array([[0.0, 0.0, 1.0]])
ENDS = np.array([[-LENGTH / 2, 0, 0], [LENGTH / 2, 0, 0]])
BAR = Characteristic("bar", "measurand", LENGTH, (-0.2, 0.2), (LengthBetweenPoints(ENDS[0], ENDS[1], UP, UP),))
# straight above, image columns along the bar
ABOVE = look_at(np.array([[0.0, 0.0, DEPTH]]), np.zeros((1, 3)), np.zeros(1))


def along_x(pose):
    """The pose turned about its optical axis so that the bar lies along u."""
    turned = pose.copy()
    turned[0, :3, :3] = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
    return turned


POSE = along_x(ABOVE)


def evaluator(error_mm, camera=CAMERA, pose_error=None, characteristics=(BAR,)):
    none = PoseError(np.zeros((6, 6)))
    return Evaluator(
        characteristics, PLATE, Setup(camera, pose_error or none, Requirement("error", error_mm, REQUIRED))
    )


def turned(base, setup, name):
    def at(factor):
        changed = KNOBS[name].turned(setup, factor)
        return base.with_errors(changed.camera, changed.pose_error)

    return at


@pytest.mark.parametrize("allowed_mm", [0.01, 0.026, 0.2])
def test_pixels_alone_by_hand(allowed_mm):
    # the error of the length is the difference of two uniform errors: triangular on (-step, step), so that
    # Pr{|error| <= a} = 1 - (1 - a / step)²; one step on the part is pitch * depth / focal length
    base = evaluator(allowed_mm)
    setup = Rig(CAMERA, PoseError(np.zeros((6, 6))), (200.0, 300.0))
    found = largest_factor(turned(base, setup, "pixel"), POSE)
    step_on_part = CAMERA.edge_resolution_px * PITCH * DEPTH / FOCAL
    by_hand = allowed_mm / (1 - np.sqrt(1 - REQUIRED)) / step_on_part
    assert found.factor == pytest.approx(by_hand, rel=SHORT)  # what is promised
    assert found.factor <= by_hand * (1 + 1e-9)


@pytest.mark.parametrize("sigma_mm", [0.02, 0.3])
def test_translation_alone_by_hand(sigma_mm):
    # only along the optical axis, with an ideal edge detector: the length scales with the depth, error = L sigma / Z
    pose_error = PoseError.from_standard_deviations((0, 0, sigma_mm), 0.0)
    camera = replace(CAMERA, edge_resolution_px=0.0)
    base = evaluator(0.05, camera, pose_error)
    for name in ("translation", "pose_error"):
        found = largest_factor(turned(base, Rig(camera, pose_error, (200.0, 300.0)), name), POSE)
        by_hand = 0.05 * DEPTH / LENGTH / norm.ppf((1 + REQUIRED) / 2) / sigma_mm
        assert found.factor == pytest.approx(by_hand, rel=SHORT)
    rotation = largest_factor(turned(base, Rig(camera, pose_error, (200.0, 300.0)), "rotation"), POSE)
    assert rotation.unlimited == (by_hand > 1), "there is no rotation to be less of"


def test_what_no_factor_helps_has_none():
    pose_error = PoseError.from_standard_deviations((0, 0, 5.0), 0.0)
    base = evaluator(0.05, CAMERA, pose_error)
    setup = Rig(CAMERA, pose_error, (200.0, 300.0))
    assert largest_factor(turned(base, setup, "pixel"), POSE).factor is None
    away = POSE.copy()
    away[0, :3, 2] *= -1  # looks away: nothing is seen, whatever the errors
    away[0, :3, 0] *= -1
    assert largest_factor(turned(base, setup, "pose_error"), away).factor is None


def test_all_characteristics_each_from_its_own_viewpoint():
    # two bars, of which each viewpoint sees one; the part is met as long as both are
    far = np.array([[-LENGTH / 2, 5, 0], [LENGTH / 2, 5, 0]])
    other = replace(BAR, id="other", measurands=(LengthBetweenPoints(far[0], far[1], -UP, -UP),))
    below = POSE.copy()
    below[0, :3, :3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    below[0, 2, 3] = -400.0
    pose_error = PoseError.from_standard_deviations((0, 0, 0.1), 0.0)
    base = evaluator(0.05, CAMERA, pose_error, (BAR, other))
    both = np.concatenate([POSE, below])
    setup = Rig(CAMERA, pose_error, (200.0, 300.0))
    seen = meeting(base.with_errors(replace(CAMERA, edge_resolution_px=0.0), scaled_pose_error(pose_error, 0, 0)), both)
    apart = [largest_factor(turned(base.of([j]), setup, "pixel"), both).factor for j in range(2) if seen[:, j].any()]
    together = largest_factor(turned(base, setup, "pixel"), both).factor
    assert together == (pytest.approx(min(apart), rel=SHORT) if len(apart) == 2 else None)


def test_scaling_a_pose_error_scales_its_deviations_and_what_acquisitions_share():
    covariance = np.diag([0.1, 0.2, 0.3, 1e-3, 2e-3, 3e-3]) ** 2
    covariance[0, 5] = covariance[5, 0] = 0.5 * 0.1 * 3e-3
    pose_error = PoseError(covariance, (0, 0, -16.0), common_covariance=covariance / 4)
    scaled = scaled_pose_error(pose_error, 2.0, 0.5)
    deviations = np.sqrt(scaled.covariance.diagonal())
    assert deviations == pytest.approx([0.2, 0.4, 0.6, 5e-4, 1e-3, 1.5e-3])
    assert scaled.covariance[0, 5] / (deviations[0] * deviations[5]) == pytest.approx(0.5)
    assert scaled.common_covariance == pytest.approx(scaled.covariance / 4)
    assert (scaled.T_camera_frame == pose_error.T_camera_frame).all()


@given(
    low=st.floats(0.2, 2.9),
    width=st.floats(0.3, 3.0),
    second=st.booleans(),
)
def test_the_interval_is_found_with_its_ends(low, width, second):
    high = low + width

    def is_met(factor):
        return low <= factor <= high or (second and 6.5 <= factor <= 7.5)

    ladder = (2.0 ** (np.arange(-12, 13) / 4)).tolist()
    met = [is_met(factor) for factor in ladder]
    found = met_interval(ladder, met, is_met)
    if not any(met):
        assert found is None
        return
    near_one = min((f for f, m in zip(ladder, met, strict=True) if m), key=lambda f: abs(np.log(f)))
    assert found is not None
    ends = (low, high) if low <= near_one <= high else (6.5, 7.5)
    if second and 6.5 - high < 2 and high >= 6.5 * 2**-0.25:
        return  # the two may look like one on the ladder
    assert found.low == pytest.approx(ends[0], rel=SHORT)
    assert found.high == pytest.approx(ends[1], rel=SHORT)
    assert is_met(found.low)
    assert is_met(found.high)


def test_an_end_that_is_not_reached_is_none():
    ladder = [0.5, 1.0, 2.0]
    found = met_interval(ladder, [True, True, True], lambda _: True)
    assert found is not None
    assert found.low is None
    assert found.high is None
    assert met_interval(ladder, [False] * 3, lambda _: False) is None
