"""Poses: look-at, quaternions, transforms."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import viewgauge as vg
from strategies import quaternions, rigid_poses
from viewgauge.geometry import invert, look_at, pose_from_quaternion, quaternion_from_pose, require_poses, transform
from viewgauge.geometry.poses import skew

coordinates = st.tuples(*[st.one_of(st.sampled_from([0.0, 100.0, -100.0]), st.floats(-500, 500))] * 3).map(np.array)
rolls = st.one_of(st.sampled_from([0.0, math.pi / 2, math.pi]), st.floats(-7, 7))


def rotation_by_formula(q):
    """Rotation matrix of a unit quaternion w, x, y, z, from v' = v + 2w (u x v) + 2 u x (u x v)."""
    w, u = q[0], np.array(q[1:])
    return np.array([v + 2 * w * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v)) for v in np.eye(3)]).T


@given(coordinates, coordinates, rolls)
def test_look_at_puts_the_target_on_the_optical_axis_with_z_forward(eye, target, roll):
    distance = math.dist(eye, target)
    assume(distance > 1e-3)
    T_part_camera = require_poses(look_at(eye, target, roll))
    np.testing.assert_array_equal(T_part_camera[:3, 3], eye)
    seen = transform(invert(T_part_camera), target)
    np.testing.assert_allclose(seen, [0, 0, distance], rtol=1e-12, atol=1e-9)


def test_without_roll_the_image_is_level_and_the_parts_up_is_up():
    T_part_camera = look_at([300.0, -200.0, 150.0], [0.0, 0.0, 20.0])
    assert T_part_camera[2, 0] == pytest.approx(0, abs=1e-15), "the image's x axis is level"
    assert T_part_camera[2, 1] < 0, "y points down"


def test_looking_along_the_parts_z_axis_needs_no_up():
    for sign in (1, -1):
        T = require_poses(look_at([0.0, 0.0, 100.0 * sign], [0.0, 0.0, 0.0]))
        np.testing.assert_allclose(T[:3, 2], [0, 0, -sign], atol=1e-15)


def test_roll_turns_the_camera_clockwise_about_its_axis():
    level, rolled = look_at([0, -100, 0], [0, 0, 0]), look_at([0, -100, 0], [0, 0, 0], math.pi / 2)
    np.testing.assert_allclose(level[:3, 0], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(level[:3, 1], [0, 0, -1], atol=1e-15)
    np.testing.assert_allclose(rolled[:3, 0], level[:3, 1], atol=1e-15)  # x goes where y (down) was
    np.testing.assert_allclose(rolled[:3, 2], level[:3, 2], atol=1e-15)


def test_look_at_broadcasts_eyes_targets_and_rolls():
    eyes = np.array([[0.0, -100, 0], [100, 0, 0], [0, 0, 100]])[:, None]
    T = look_at(eyes, np.zeros(3), np.array([0.0, 1.0]))
    assert T.shape == (3, 2, 4, 4)
    for i, j in np.ndindex(3, 2):
        np.testing.assert_array_equal(T[i, j], look_at(eyes[i, 0], np.zeros(3), [0.0, 1.0][j]))


@pytest.mark.parametrize(
    ("eye", "target", "telling"),
    [
        ([1, 2, 3], [1, 2, 3], "coincides"),
        ([[0, 0, 1], [0, 0, 0]], [0, 0, 0], "coincides"),
        ([math.nan, 0, 0], [0, 0, 0], "eye_mm"),
        ([1, 0, 0], [0, 0, math.inf], "target_mm"),
        ([1, 0], [0, 0, 0], "3 numbers"),
    ],
)
def test_a_camera_that_looks_nowhere_is_refused(eye, target, telling):
    with pytest.raises(vg.InputError, match=telling):
        look_at(eye, target)


@given(quaternions(), coordinates)
def test_a_quaternion_gives_its_rotation_and_comes_back(q, position):
    T = pose_from_quaternion(position, q)
    np.testing.assert_allclose(T[:3, :3], rotation_by_formula(q), atol=1e-14)
    np.testing.assert_array_equal(T[:3, 3], position)
    np.testing.assert_array_equal(T[3], [0, 0, 0, 1])
    back = quaternion_from_pose(T)
    assert back[0] >= 0
    assert min(np.abs(back - q).max(), np.abs(back + q).max()) < 1e-14  # q and -q are one rotation


def test_quaternions_come_in_arrays():
    qs = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0.5, 0.5, 0.5, 0.5]]).reshape(3, 1, 4)
    T = pose_from_quaternion(np.zeros(3), qs)
    assert T.shape == (3, 1, 4, 4)
    np.testing.assert_allclose(quaternion_from_pose(T), qs, atol=1e-15)
    np.testing.assert_allclose(T[2, 0, :3, :3], [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-15)


def test_a_rounded_quaternion_is_taken_and_made_exact():
    T = pose_from_quaternion([0, 0, 0], [0.7071, 0.7071, 0, 0])
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("q", [[1, 0.02, 0, 0], [0, 0, 0, 0], [2, 0, 0, 0], [math.nan, 0, 0, 0], [math.inf, 0, 0, 0]])
def test_a_quaternion_that_is_not_of_unit_length_is_refused(q):
    with pytest.raises(vg.InputError, match="not of unit length"):
        pose_from_quaternion([0, 0, 0], q)


@pytest.mark.parametrize(
    ("position", "q", "telling"),
    [
        ([0, math.nan, 0], [1, 0, 0, 0], "position_mm"),
        ([0, 0], [1, 0, 0, 0], "3 numbers"),
        ([0, 0, 0], [1, 0, 0], "4 numbers"),
    ],
)
def test_a_pose_without_three_and_four_numbers_is_refused(position, q, telling):
    with pytest.raises(vg.InputError, match=telling):
        pose_from_quaternion(position, q)


@given(rigid_poses(), rigid_poses(), coordinates)
def test_transforms_compose_and_invert(T_a_b, T_b_c, point):
    one_by_one = transform(T_a_b, transform(T_b_c, point))
    np.testing.assert_allclose(transform(T_a_b @ T_b_c, point), one_by_one, atol=1e-10)
    np.testing.assert_allclose(transform(invert(T_a_b), transform(T_a_b, point)), point, atol=1e-10)
    np.testing.assert_allclose(T_a_b @ invert(T_a_b), np.eye(4), atol=1e-12)


def test_transform_broadcasts_poses_against_points():
    poses = look_at(np.array([[0.0, -100, 0], [100, 0, 0]]), np.zeros(3))
    points = np.arange(15.0).reshape(5, 3)
    seen = transform(invert(poses)[:, None], points)
    assert seen.shape == (2, 5, 3)
    np.testing.assert_allclose(seen[1, 4], (np.linalg.inv(poses[1]) @ [*points[4], 1])[:3], atol=1e-12)


@given(coordinates, coordinates)
def test_skew_is_the_cross_product(a, b):
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b), atol=1e-9)


@pytest.mark.parametrize(
    ("pose", "telling"),
    [
        (np.diag([1.0, 1, -1, 1]), "not a rotation"),
        (np.diag([2.0, 2, 2, 1]), "not a rotation"),
        (np.eye(4) + np.eye(4)[[2, 0, 1, 3]] * 1e-3, "not a rotation"),
        (np.where(np.eye(4) > 0, 1.0, np.nan), "finite"),
        (np.eye(4)[:3], "4x4"),
        (np.diag([1.0, 1, 1, 2]), "last row"),
        ("identity", "4x4"),
        ([[1, 2], [3]], "4x4"),
    ],
)
def test_what_is_not_a_rigid_pose_is_refused(pose, telling):
    with pytest.raises(vg.InputError, match=telling):
        require_poses(pose)
