"""The best screw axes leave of measured poses what was no motion of the joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from viewgauge.exceptions import InputError
from viewgauge.geometry import PoseError, invert
from viewgauge.measurement import errors_of_poses, fit_serial_arm
from viewgauge.simulation.full_camera import draw_pose_errors

POSE_ERROR = PoseError.from_standard_deviations((0.2, 0.1, 0.3), (4e-4, 2e-4, 6e-4))
SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "positioner"

# screw axes of a turntable on a tilting cradle, not quite at right angles, and the pose at zero
AXES = [
    np.array([120.0, -40, 15, 0.01, 0.02, 1.0]),
    np.array([-10.0, 300, 80, 0.999, -0.03, 0.01]),
]
REACH = np.array([400.0, 50, 700, 0.3, -0.8, 1.2])


def matrix(twist):
    v, w = twist[:3], twist[3:]
    return np.array([[0, -w[2], w[1], v[0]], [w[2], 0, -w[0], v[1]], [-w[1], w[0], 0, v[2]], [0, 0, 0, 0]])


def poses_of(joints):
    """By SciPy's matrix exponential of the 4x4 twists."""
    at_zero = expm(matrix(REACH))
    return np.array([expm(matrix(AXES[0] * a)) @ expm(matrix(AXES[1] * b)) @ at_zero for a, b in joints])


@pytest.fixture(scope="module")
def joints():
    return np.random.default_rng(4).uniform([-2.5, -1.2], [2.5, 1.2], (120, 2))


def test_without_errors_nothing_is_left(joints):
    nominal, parameters = fit_serial_arm(joints, poses_of(joints))
    assert parameters == 18
    assert np.abs(nominal - poses_of(joints)).max() < 1e-6


def test_what_is_left_is_the_error(joints):
    """120 poses, 117 degrees of freedom: deviations are off by 6.5 % (one sigma)."""
    drawn = draw_pose_errors(POSE_ERROR, len(joints), np.random.default_rng(9))
    measured = poses_of(joints) @ invert(drawn)
    nominal, _ = fit_serial_arm(joints, measured)
    errors = errors_of_poses(nominal, measured)
    expected = np.sqrt(POSE_ERROR.covariance.diagonal())
    assert np.sqrt((errors**2).sum(axis=0) / 117) == pytest.approx(expected, rel=4.5 * 0.065)


def test_too_few_poses_are_refused(joints):
    with pytest.raises(InputError, match="too few poses"):
        fit_serial_arm(joints[:3], poses_of(joints[:3]))


@pytest.mark.skipif(not SHARED.is_dir(), reason="measured poses of a positioner: ../shared/data/positioner is absent")
def test_a_real_positioner():
    """The size of the residuals that come with the data, fitted by others in another frame: 0.22, 0.22, 0.26 mm and
    0.35, 0.34, 0.79 mrad; frames differ, so to a third."""
    from viewgauge.formats.poses.pose_samples_file import read_pose_samples

    errors = read_pose_samples(SHARED / "measurements.yaml").samples.errors
    assert errors.shape == (205, 6)
    root_mean_square = np.sqrt((errors**2).mean(axis=0))
    assert np.linalg.norm(root_mean_square[:3]) == pytest.approx(np.linalg.norm([0.22, 0.22, 0.26]), rel=0.33)
    assert np.linalg.norm(root_mean_square[3:]) == pytest.approx(np.linalg.norm([0.35, 0.34, 0.79]) * 1e-3, rel=0.33)
