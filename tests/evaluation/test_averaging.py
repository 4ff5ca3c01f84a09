"""Acquisitions against the single acquisition of the other modules, and the rules that any mean obeys."""

import math

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.evaluation import Acquisitions, averaged_success_probability, image_segment, success_probability
from viewgauge.evaluation.compiled.kernel import ProbabilityKernel
from viewgauge.geometry import invert, look_at, transform, view_block
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.visibility import VISIBLE

CAMERA = vg.Camera(16, (0.00345, 0.004), (2448, 2048), edge_resolution_px=0.3)
ENDS = np.array([[-20.0, 5.0, 0.0], [25.0, 10.0, 8.0]])  # part frame
EYES = np.array([[0, 0, 400], [250, 0, 300], [-250, 40, 300], [0, 260, 280], [10, -300, 250]], dtype=float)
POSES = look_at(EYES, [1.0, 2.0, 3.0], [0.1, 1.0, 2.0, 0.5, 2.7])
POINTS = transform(invert(POSES)[:, None], ENDS)
LENGTH = float(np.linalg.norm(ENDS[1] - ENDS[0]))

FACTOR = np.random.default_rng(1).standard_normal((6, 6)) * np.array([0.1, 0.1, 0.2, 3e-4, 3e-4, 2e-4])[:, None]
FULL = FACTOR @ FACTOR.T / 6
POSE_ERROR = np.eye(4)
POSE_ERROR[:3, 3] = [10.0, -20.0, -60.0]


def pose_error(common_share):
    return vg.PoseError(FULL, T_camera_frame=POSE_ERROR, common_covariance=FULL * common_share)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_one_acquisition_is_the_single_acquisition_of_the_joint_model(share):
    error = pose_error(share)
    allowed = np.array([0.005, 0.02, 0.05])
    law = Acquisitions.of(POINTS, CAMERA, error).mean_of(np.arange(len(POINTS))[:, None])
    image = image_segment(POINTS[:, 0], POINTS[:, 1], CAMERA, error)
    scale = LENGTH / image.length_mm
    np.testing.assert_allclose(law.std(), scale * image.total_error().std(), rtol=1e-12)
    np.testing.assert_allclose(law.sigma, scale * image.sigma_displacement_mm, rtol=1e-12)
    expected = success_probability(POINTS[:, 0], POINTS[:, 1], CAMERA, error, allowed[:, None] / LENGTH)
    np.testing.assert_allclose(law.central_probability(allowed[:, None]), expected, atol=1e-12)


def test_one_acquisition_is_the_compiled_kernel_of_the_plan():
    error = pose_error(0.5)
    measurands = MeasurandTable(
        ENDS[None], np.zeros((1, 2, 1, 3)), np.zeros(1, bool), np.zeros(1, int), np.zeros(1, int)
    )
    kernel = ProbabilityKernel(measurands, np.array([0.02 / LENGTH]), CAMERA, error)
    reason = np.full((1, 256), VISIBLE, dtype=np.int8)
    probability, _ = kernel.probabilities(view_block(POSES), len(POSES), reason)
    for k, points in enumerate(POINTS):
        # the kernel promises 1e-11
        assert averaged_success_probability(points[None], CAMERA, error, 0.02) == pytest.approx(
            float(probability[0, k]), abs=1e-10
        )


def test_the_same_acquisition_again_and_again_averages_only_what_is_drawn_anew():
    once = Acquisitions.of(POINTS[:1], CAMERA, pose_error(0.0))
    for share in (0.0, 0.5, 1.0):
        law = Acquisitions.of(POINTS[:1], CAMERA, pose_error(share)).mean_of(np.zeros(4, dtype=int))
        sigma = float(once.mean_of([0]).sigma)
        assert law.sigma == pytest.approx(sigma * math.sqrt(share + (1 - share) / 4), rel=1e-12)
        np.testing.assert_allclose(law.half_widths, np.tile(once.half_widths_mm[0] / 4, 4), rtol=1e-12)


def test_opposed_acquisitions_cancel_what_they_share():
    # A camera that stands off by 0.1 mm along x sees a tilted segment longer; from the other side, where its other
    # end is the nearer one, shorter by as much.
    shift = np.diag([0.01, 0, 0, 0, 0, 0])
    error = vg.PoseError(shift, common_covariance=shift)
    points = np.array([[[-20.0, 0, 390], [20.0, 0, 410]], [[-20.0, 0, 410], [20.0, 0, 390]]])
    acquisitions = Acquisitions.of(points, CAMERA, error)
    u = (16 * (points[0, :, 0] + 0.1) / points[0, :, 2], 16 * points[0, :, 0] / points[0, :, 2])
    by_hand = np.hypot(40, 20) * (np.ptp(u[0]) / np.ptp(u[1]) - 1)
    assert acquisitions.mean_of([0]).sigma == pytest.approx(abs(by_hand), rel=1e-9)
    assert acquisitions.mean_of([0, 1]).sigma == pytest.approx(0, abs=1e-12)


def test_acquisitions_are_in_any_order_and_no_more_than_the_worst_spread():
    acquisitions = Acquisitions.of(POINTS, CAMERA, pose_error(0.4))
    law, reversed_law = acquisitions.mean_of([0, 2, 3]), acquisitions.mean_of([3, 0, 2])
    assert law.central_probability(0.01) == pytest.approx(float(reversed_law.central_probability(0.01)), abs=1e-13)
    assert law.std() <= acquisitions.mean_of([[0], [2], [3]]).std().max()
    assert acquisitions.mean_of(np.array([[0, 1], [2, 3]])).central_probability(0.01).shape == (2,)


def test_what_cannot_be_averaged_is_refused():
    with pytest.raises(vg.InputError, match="common"):
        Acquisitions.of(POINTS, CAMERA, vg.PoseError(FULL))
    with pytest.raises(vg.InputError, match="in front"):
        Acquisitions.of(-POINTS, CAMERA, pose_error(0.0))
    with pytest.raises(vg.InputError, match="in front"):
        Acquisitions.of(POINTS[0], CAMERA, pose_error(0.0))
    with pytest.raises(vg.InputError, match="end-on"):
        Acquisitions.of([[[0, 0, 300], [0, 0, 320]]], CAMERA, pose_error(0.0))
    with pytest.raises(vg.InputError, match="allowed_error_mm"):
        averaged_success_probability(POINTS, CAMERA, pose_error(0.0), math.nan)
