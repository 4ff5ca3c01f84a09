"""The pinhole camera as a sensor: Jacobians against differences of the true motion, lines of sight against images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import viewgauge as vg
from strategies import points_in_front, rigid_poses
from viewgauge.geometry import Lens, invert, point_jacobian, transform
from viewgauge.sensors import Camera, Sensor, Window

PINHOLE = Camera(16.0, (0.004, 0.005), (4000, 3001), principal_point_px=(2011.25, 1480.0))
LENSES = {
    "pinhole": None,
    "radial-tangential": Lens("radial-tangential", (-0.12, 0.05, 4e-4, -3e-4, 0.01)),
    "equidistant": Lens("equidistant", (-0.02, 0.004, 1e-4, 0.0)),
}
CAMERAS = {
    name: Camera(16.0, (0.004, 0.005), (4000, 3001), principal_point_px=(2011.25, 1480.0), lens=lens)
    for name, lens in LENSES.items()
}
names = st.sampled_from(sorted(CAMERAS))
STEPS = np.array([1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6])  # mm and rad


def displaced(points, error):
    """Points after the true motion ``p' = Exp(delta) p + d``; to first order ``p + delta x p + d``."""
    return points @ Rotation.from_rotvec(error[3:]).as_matrix().T + error[:3]


def differences(image, point, steps=STEPS, T_camera_frame=None):
    """``(2, 6)``: central differences of an image with respect to a motion in a frame, the camera's by default."""
    T = np.eye(4) if T_camera_frame is None else T_camera_frame
    columns = []
    for step in np.diag(steps):
        ahead, behind = (image(transform(T, displaced(transform(invert(T), point), s))) for s in (step, -step))
        columns.append((ahead - behind) / (2 * step.sum()))
    return np.array(columns).T


def test_the_camera_is_a_sensor():
    assert isinstance(PINHOLE, Sensor)
    assert not isinstance(Window(0, 0, 1, 1), Sensor)


@settings(deadline=None)
@given(names, points_in_front())
def test_the_jacobians_are_those_of_differences(name, point):
    camera = CAMERAS[name]
    scale = 16.0 / point[2] * np.array([1, 1, 1, *[1 + np.abs(point).max()] * 3])
    # steps as small as the point is near; central differences leave their square, and rounding of 1e-16/1e-6
    steps = STEPS * np.array([*[min(point[2], 100.0)] * 3, 1, 1, 1])
    by_force = differences(camera.project, point, steps)
    np.testing.assert_allclose(camera.pose_jacobian(point) / scale, by_force / scale, atol=1e-7)
    by_force = differences(lambda p: camera.to_pixels(camera.project(p)), point, steps)
    np.testing.assert_allclose(camera.pose_jacobian_px(point) / scale, by_force / scale, atol=1e-7 / 0.004)


@settings(deadline=None)
@given(points_in_front().filter(lambda point: point[2] > 40), rigid_poses())
def test_an_error_in_another_frame_is_brought_to_the_camera_by_the_adjoint(point, T_camera_frame):
    error = vg.PoseError(np.eye(6), T_camera_frame=T_camera_frame)
    by_force = differences(PINHOLE.project, point, T_camera_frame=T_camera_frame)
    lever = 1 + np.abs(point).max() + np.linalg.norm(T_camera_frame[:3, 3])
    scale = 16.0 / point[2] * np.array([1, 1, 1, *[lever] * 3])
    np.testing.assert_allclose(PINHOLE.pose_jacobian(point) @ error.adjoint / scale, by_force / scale, atol=1e-6)


def test_the_jacobian_is_the_papers_and_keeps_the_shape_of_arrays():
    points = np.random.default_rng(2).uniform(50, 400, (4, 3, 3))
    for camera in CAMERAS.values():
        np.testing.assert_array_equal(camera.pose_jacobian(points), point_jacobian(points, 16.0))
        assert camera.pose_jacobian_px(points).shape == (4, 3, 2, 6)
    pixels = np.diag([1 / 0.004, 1 / 0.005]) @ point_jacobian(points, 16.0)
    np.testing.assert_allclose(PINHOLE.pose_jacobian_px(points), pixels, rtol=1e-14)


@pytest.mark.parametrize("name", CAMERAS)
def test_what_has_no_image_has_no_jacobian(name):
    points = [[1.0, 2, 0], [0, 0, 0], [1, 2, -300], [1, 2, 300]]
    for J in (CAMERAS[name].pose_jacobian(points), CAMERAS[name].pose_jacobian_px(points)):
        assert np.isnan(J[:3]).all()
        assert np.isfinite(J[3]).all()


@settings(deadline=None)
@given(names, st.tuples(st.floats(-0.5, 3999.5), st.floats(-0.5, 3000.5)), st.sampled_from([1e-3, 1.0, 300.0, 1e5]))
def test_a_point_on_a_line_of_sight_is_shown_where_the_line_begins(name, pixel, distance):
    camera = CAMERAS[name]
    origin, direction = camera.lines_of_sight(pixel)
    np.testing.assert_array_equal(origin, [0, 0, 0])
    assert np.linalg.norm(direction) == pytest.approx(1, abs=1e-15)
    assert direction[2] > 0
    shown = camera.to_pixels(camera.project(origin + distance * direction))
    np.testing.assert_allclose(shown, pixel, atol=1e-7)


def test_the_line_of_sight_of_the_principal_point_is_the_optical_axis():
    for camera in CAMERAS.values():
        _, direction = camera.lines_of_sight([[2011.25, 1480.0]])
        np.testing.assert_allclose(direction, [[0, 0, 1]], atol=1e-15)


def test_the_line_of_sight_by_hand():
    # 1000 px of 4 um to the right of the principal point: 4 mm at 16 mm
    _, direction = PINHOLE.lines_of_sight([3011.25, 1480.0])
    np.testing.assert_allclose(direction, np.array([4, 0, 16]) / np.sqrt(272), rtol=1e-14)


def test_where_the_lens_shows_nothing_there_is_no_line_of_sight():
    folding = Camera(16.0, (0.004, 0.004), (400, 300), lens=Lens("radial-tangential", (-0.5, 0.0, 0.0, 0.0)))
    _, direction = folding.lines_of_sight([[200.0, 150.0], [9000.0, 150.0]])
    assert np.isfinite(direction[0]).all()
    assert np.isnan(direction[1]).all()
