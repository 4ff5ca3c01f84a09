"""The pose error: which covariances are taken, and how it acts at the camera."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings

import viewgauge as vg
from strategies import points_in_front, pose_covariances, rigid_poses

FULL = np.diag([0.1, 0.2, 0.3, 1e-3, 2e-3, 3e-3]) ** 2


def displaced(point_camera, T_camera_frame, d, angles):
    """A camera-frame point after the pose error frame's coordinates moved by q' = q + angles x q + d."""
    q = np.linalg.solve(T_camera_frame, [*point_camera, 1])[:3]
    q = (
        q
        + np.array(
            [
                angles[1] * q[2] - angles[2] * q[1],
                angles[2] * q[0] - angles[0] * q[2],
                angles[0] * q[1] - angles[1] * q[0],
            ]
        )
        + d
    )
    return (T_camera_frame @ [*q, 1])[:3]


def displacement_covariance_by_force(covariance, T_camera_frame, point):
    """3x3 covariance of a point's displacement, by displacing it with each of the six errors in turn."""
    steps = np.eye(6)
    columns = np.array([displaced(point, T_camera_frame, e[:3], e[3:]) - point for e in steps]).T
    return columns @ covariance @ columns.T


def displacement_covariance_at_camera(error, point):
    """The same from ``camera_covariance``: an error that acts at the centre of projection."""
    columns = np.array([displaced(point, np.eye(4), e[:3], e[3:]) - point for e in np.eye(6)]).T
    return columns @ error.camera_covariance @ columns.T


@settings(deadline=None)
@given(pose_covariances(), rigid_poses(), points_in_front())
def test_the_error_moves_points_alike_reported_in_its_own_or_in_the_camera_frame(covariance, T_camera_frame, point):
    error = vg.PoseError(covariance, T_camera_frame=T_camera_frame)
    expected = displacement_covariance_by_force(covariance, T_camera_frame, point)
    actual = displacement_covariance_at_camera(error, point)
    # rounding grows with the lever arms squared
    scale = (covariance.max() + 1e-300) * (1 + np.linalg.norm(point) + np.linalg.norm(T_camera_frame[:3, 3])) ** 2
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-12 * scale)


@settings(deadline=None)
@given(pose_covariances(), rigid_poses())
@example(np.outer([0, 0, 0, 1e-5, 1.9e-159, 0], [0, 0, 0, 1e-5, 1.9e-159, 0]), np.eye(4))  # a variance that underflows
@example(np.diag([0, 0, 0, 0, 1e-320, 0]), np.eye(4))
def test_the_covariance_at_the_camera_is_symmetric_and_positive_semidefinite(covariance, T_camera_frame):
    at_camera = vg.PoseError(covariance, T_camera_frame=T_camera_frame).camera_covariance
    size = np.abs(at_camera).max() + 1e-300  # subnormal numbers round coarsely
    np.testing.assert_allclose(at_camera, at_camera.T, atol=1e-14 * size)
    assert np.linalg.eigvalsh(at_camera)[0] >= -1e-12 * size


def test_a_pivot_is_a_pose_error_frame_without_rotation():
    T = np.eye(4)
    T[:3, 3] = [5.0, -3.0, -16.0]
    by_pivot = vg.PoseError(FULL, pivot_mm=(5.0, -3.0, -16.0))
    np.testing.assert_array_equal(by_pivot.camera_covariance, vg.PoseError(FULL, T_camera_frame=T).camera_covariance)
    np.testing.assert_array_equal(by_pivot.T_camera_frame, T)


def test_without_a_pivot_the_error_acts_at_the_centre_of_projection():
    np.testing.assert_array_equal(vg.PoseError(FULL).camera_covariance, FULL)


def test_turning_about_a_pivot_moves_the_camera_by_the_lever_arm():
    # rotation about the y axis of a frame 100 mm behind the camera: x moves by 100 mm times the angle
    error = vg.PoseError.from_standard_deviations(0.0, [0.0, 1e-3, 0.0], pivot_mm=(0.0, 0.0, -100.0))
    assert error.camera_covariance[0, 0] == pytest.approx((100 * 1e-3) ** 2)
    assert error.camera_covariance[0, 4] == pytest.approx(100 * 1e-6), "with the sign of the turn"


def test_standard_deviations_come_one_or_three_at_a_time():
    error = vg.PoseError.from_standard_deviations(0.1, [1e-3, 2e-3, 0])
    np.testing.assert_allclose(error.covariance, np.diag([0.01, 0.01, 0.01, 1e-6, 4e-6, 0]), rtol=1e-15)


@pytest.mark.parametrize("name", ["translation_mm", "rotation_rad"])
@pytest.mark.parametrize("bad", [-0.1, math.nan, math.inf, [0.1, 0.1], [0.1, -0.1, 0.1], np.ones((3, 1))])
def test_bad_standard_deviations_are_refused(name, bad):
    with pytest.raises(vg.InputError, match=name):
        vg.PoseError.from_standard_deviations(**{"translation_mm": 0.1, "rotation_rad": 1e-3, name: bad})


def changed(*entries):
    matrix = FULL.copy()
    for row, column, value in entries:
        matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    ("covariance", "telling"),
    [
        (np.eye(3), "6x6"),
        (np.eye(7), "6x6"),
        (np.ones(6), "6x6"),
        (1.0, "6x6"),
        ("identity", "6x6"),
        ([[1, 2], [3]], "6x6"),
        (changed((2, 2, math.nan)), "finite"),
        (changed((0, 1, math.inf), (1, 0, math.inf)), "finite"),
        (changed((0, 0, -0.01)), "negative variance"),
        (changed((0, 1, 0.01)), "not symmetric"),
        (changed((3, 4, 1e-6)), "not symmetric"),  # small in mm, but not for angles
        (changed((0, 1, 0.021), (1, 0, 0.021)), "not positive semidefinite"),  # correlation 1.05
        (changed((3, 4, 2.1e-6), (4, 3, 2.1e-6)), "not positive semidefinite"),
        (changed((0, 3, -1.05e-4), (3, 0, -1.05e-4)), "not positive semidefinite"),
        (changed((5, 5, 0.0), (0, 5, 1e-6), (5, 0, 1e-6)), "not positive semidefinite"),
    ],
)
def test_what_is_not_a_covariance_is_refused(covariance, telling):
    with pytest.raises(vg.InputError, match=telling):
        vg.PoseError(covariance)


@pytest.mark.parametrize("correlation", [1.0, -1.0, 0.99])
def test_perfectly_correlated_errors_are_taken(correlation):
    value = correlation * 0.1 * 1e-3
    matrix = changed((0, 3, value), (3, 0, value))
    np.testing.assert_array_equal(vg.PoseError(matrix).covariance, matrix)


def test_a_rounded_covariance_of_low_rank_is_taken():
    factor = np.random.default_rng(3).standard_normal((6, 2)) * np.sqrt(FULL.diagonal())[:, None]  # of rank two
    rounded = np.array([[float(f"{value:.10g}") for value in row] for row in factor @ factor.T])
    np.testing.assert_allclose(vg.PoseError(rounded).covariance, rounded)


def test_the_covariance_is_a_copy_that_cannot_be_changed():
    mine = FULL.copy()
    error = vg.PoseError(mine)
    mine[0, 0] = 99.0
    np.testing.assert_array_equal(error.covariance, FULL)
    with pytest.raises(ValueError, match="read-only"):
        error.covariance[0, 0] = 99.0


@pytest.mark.parametrize(
    ("frame", "telling"),
    [
        ({"pivot_mm": (0, 0)}, "pivot_mm"),
        ({"pivot_mm": (0, 0, math.nan)}, "pivot_mm"),
        ({"T_camera_frame": np.eye(3)}, "T_camera_frame"),
        ({"T_camera_frame": np.diag([1.0, 1, -1, 1])}, "not a rotation"),
        ({"T_camera_frame": np.stack([np.eye(4), np.eye(4)])}, "one 4x4"),
        ({"pivot_mm": (0, 0, -16), "T_camera_frame": np.eye(4)}, "not both"),
    ],
)
def test_a_pose_error_frame_that_is_none_is_refused(frame, telling):
    with pytest.raises(vg.InputError, match=telling):
        vg.PoseError(FULL, **frame)


# --- the part that is common to all acquisitions --------------------------------------------------------------------


@settings(deadline=None)
@given(pose_covariances(), pose_covariances(), rigid_poses())
def test_common_and_repeatability_make_up_the_whole(common, repeatability, T_camera_frame):
    error = vg.PoseError(common + repeatability, T_camera_frame=T_camera_frame, common_covariance=common)
    whole = vg.PoseError(common + repeatability, T_camera_frame=T_camera_frame)
    np.testing.assert_array_equal(error.camera_covariance, whole.camera_covariance)
    np.testing.assert_array_equal(error.factor, whole.factor)
    scale = np.sqrt(np.outer(whole.covariance.diagonal(), whole.covariance.diagonal()))
    # 1e-150: products of deviations smaller than that have fewer digits, down to none
    assert (np.abs(error.repeatability_covariance - repeatability) <= 1e-12 * scale + 1e-150).all()
    assert not error.common_covariance.flags.writeable


def test_nothing_is_said_of_a_common_part_unless_stated():
    assert vg.PoseError(FULL).common_covariance is None
    assert vg.PoseError(FULL).repeatability_covariance is None
    assert not vg.PoseError(FULL, common_covariance=np.zeros((6, 6))).common_covariance.any()
    assert not vg.PoseError(FULL, common_covariance=FULL).repeatability_covariance.any()


@pytest.mark.parametrize(
    ("common", "telling"),
    [
        (np.eye(3), "the common covariance must be a finite 6x6"),
        (changed((0, 1, 0.01)), "the common covariance is not symmetric"),
        (changed((0, 1, 0.021), (1, 0, 0.021)), "the common covariance is not positive semidefinite"),
        (FULL * 1.001, "more than the covariance"),
        (np.diag([0.01, 0.04, 0.09, 1.01e-6, 0, 0]), "more than the covariance"),  # small in mm, but not for angles
        (changed((0, 1, 0.01), (1, 0, 0.01)), "more than the covariance"),  # by a correlation that the whole has not
    ],
)
def test_a_common_part_that_is_no_part_is_refused(common, telling):
    with pytest.raises(vg.InputError, match=telling):
        vg.PoseError(FULL, common_covariance=common)


def test_no_error_has_no_common_part():
    whole = np.diag([0.01, 0, 0, 0, 0, 0])
    with pytest.raises(vg.InputError, match="more than the covariance"):
        vg.PoseError(whole, common_covariance=np.diag([0.01, 0, 0, 0, 1e-12, 0]))
