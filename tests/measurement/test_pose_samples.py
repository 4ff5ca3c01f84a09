"""Pose errors from poses: the same that the simulation draws, whatever frame the poses are told in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strategies import rigid_poses
from viewgauge.exceptions import InputError
from viewgauge.geometry import PoseError, invert
from viewgauge.measurement import PoseSamples, errors_about_group_means, errors_of_poses, estimate_pose_error
from viewgauge.simulation.full_camera import draw_pose_errors

DEVIATIONS = np.array([0.2, 0.1, 0.3, 4e-4, 2e-4, 6e-4])


def pose_error():
    correlation = np.eye(6)
    correlation[0, 4] = correlation[4, 0] = 0.7
    return PoseError(correlation * np.outer(DEVIATIONS, DEVIATIONS))


def some_poses(n, rng):
    from scipy.spatial.transform import Rotation

    T = np.tile(np.eye(4), (n, 1, 1))
    T[:, :3, :3] = Rotation.random(n, rng=rng).as_matrix()
    T[:, :3, 3] = rng.uniform(-800, 800, (n, 3))
    return T


def reached(commanded, displacement):
    """Where the head is when the scene, seen from it, is displaced (the error's meaning, by frames alone)."""
    return commanded @ invert(displacement)


def test_the_errors_are_those_that_were_drawn():
    rng = np.random.default_rng(1)
    commanded = some_poses(50, rng)
    displacement = draw_pose_errors(pose_error(), 50, np.random.default_rng(7))
    expected = np.random.default_rng(7).standard_normal((50, 6)) @ pose_error().factor.T
    assert np.allclose(errors_of_poses(commanded, reached(commanded, displacement)), expected, atol=1e-12)


@given(base=rigid_poses(), tool=st.integers(0, 3))
def test_the_fixed_frame_does_not_matter(base, tool):
    rng = np.random.default_rng(tool)
    commanded = some_poses(5, rng)
    measured = reached(commanded, draw_pose_errors(pose_error(), 5, rng))
    moved = errors_of_poses(base @ commanded, base @ measured)
    assert np.allclose(moved, errors_of_poses(commanded, measured), atol=1e-9)


def test_repeated_visits_are_judged_about_their_own_mean():
    """100 poses visited 6 times, each with a systematic error of its own: only the scatter counts, 500 degrees."""
    rng = np.random.default_rng(3)
    commanded = np.repeat(some_poses(100, rng), 6, axis=0)
    systematic = np.repeat(draw_pose_errors(PoseError(100 * pose_error().covariance), 100, rng), 6, axis=0)
    measured = reached(reached(commanded, systematic), draw_pose_errors(pose_error(), 600, rng))
    names = np.repeat(np.arange(100), 6).astype(str)
    errors, groups = errors_about_group_means(measured, names)
    assert groups == 100
    assert np.abs(errors.reshape(100, 6, 6).mean(axis=1)).max() < 1e-10
    found = estimate_pose_error(PoseSamples(errors, tuple(names), repeated=True), groups)
    assert found.degrees_of_freedom == 500
    assert not found.mean.any()
    # a deviation of 500 degrees of freedom is off by 3 % (one sigma): 5 sigma
    assert found.deviation == pytest.approx(DEVIATIONS, rel=0.16)
    correlation = found.covariance[0, 4] / (found.deviation[0] * found.deviation[4])
    assert correlation == pytest.approx(0.7, abs=5 * 0.51 / np.sqrt(500))


def test_a_pose_visited_once_says_nothing():
    with pytest.raises(InputError, match="visited only once"):
        errors_about_group_means(some_poses(3, np.random.default_rng(0)), ["a", "a", "b"])
