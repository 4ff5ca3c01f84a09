"""The first-order effect of a pose error on image points, against two independent derivations."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings

import viewgauge as vg
from strategies import points_in_front, pose_covariances
from viewgauge.geometry import point_jacobian

F = 16.0
POINTS = np.array([[30.0, -20.0, 400.0], [0.0, 0.0, 250.0], [-80.0, 55.0, 1100.0], [1e-9, 40.0, 60.0]])


def image_after_true_motion(point, error, f):
    """Image of a point moved by Trans(d) Rot_x Rot_y Rot_z (paper, eq. 6), each rotation written out; mpmath."""
    dx, dy, dz, rx, ry, rz = error
    x, y, z = map(mp.mpf, map(float, point))
    x, y = mp.cos(rz) * x - mp.sin(rz) * y, mp.sin(rz) * x + mp.cos(rz) * y
    z, x = mp.cos(ry) * z - mp.sin(ry) * x, mp.sin(ry) * z + mp.cos(ry) * x
    y, z = mp.cos(rx) * y - mp.sin(rx) * z, mp.sin(rx) * y + mp.cos(rx) * z
    x, y, z = x + dx, y + dy, z + dz
    return f * x / z, f * y / z


@pytest.mark.parametrize("point", POINTS, ids=str)
def test_jacobian_equals_differences_of_the_true_motion(point):
    # central differences with step 1e-15 in 50 digits: good to 1e-30 relative
    J = point_jacobian(point, F)
    with mp.workdps(50):
        for column in range(6):
            step = [mp.mpf(10) ** -15 * (k == column) for k in range(6)]
            ahead = image_after_true_motion(point, step, F)
            behind = image_after_true_motion(point, [-s for s in step], F)
            for row in range(2):
                slope = float((ahead[row] - behind[row]) / (2 * step[column]))
                assert J[row, column] == pytest.approx(slope, rel=1e-13, abs=1e-15)


def paper_lambdas(point, f):
    """lambda_1…21 of eq. (7) and (8), lambda_20 with its sign corrected (theory section 8), for C1, C2, C3."""
    C1, C2, C3 = point[0], point[1], point[2] + f  # the paper's frame begins in the image plane, the lens at z = f
    numerator_u = [f * C1 * C2, f * ((f - C3) * C3 - C1**2), f * C2 * (C3 - f), f * (f - C3), 0, f * C1]
    numerator_v = [f * (C2**2 - (f - C3) * C3), -f * C1 * C2, f * C1 * (f - C3), 0, f * (f - C3), f * C2]
    denominator = [-C2 * (f - C3), C1 * (f - C3), 0, 0, 0, -(f - C3)]
    return np.array([numerator_u, numerator_v]), np.array(denominator), (f - C3) ** 2


@pytest.mark.parametrize("point", POINTS, ids=str)
def test_the_papers_equations_hold_for_the_displaced_image_with_the_corrected_sign(point):
    # This is what makes the next test's oracle trustworthy: eq. 7 and 8 are exact for the motion I + [delta]x.
    rotation, shift = np.array([2e-3, -1e-3, 3e-3]), np.array([0.5, -0.3, 0.8])
    paper = point + np.array([0, 0, F])
    moved = paper + np.cross(rotation, paper) + shift
    exact = F * moved[:2] / (F - moved[2]) - F * paper[:2] / (F - paper[2])
    numerator, denominator, constant = paper_lambdas(point, F)
    error = np.concatenate([rotation, shift])  # the paper's order
    np.testing.assert_allclose(numerator @ error / (denominator @ error + constant), exact, rtol=1e-9)


@settings(deadline=None)
@given(points_in_front(), pose_covariances())
def test_image_covariance_equals_the_papers_with_its_pivot(point, covariance):
    error = vg.PoseError(covariance, pivot_mm=(0.0, 0.0, -F))
    J = point_jacobian(point, F)
    numerator, _, constant = paper_lambdas(point, F)
    # first order; the paper's image is the inverted one; rotation comes first there
    paper = -(numerator / constant)[:, [3, 4, 5, 0, 1, 2]]
    expected = paper @ covariance @ paper.T
    lever = (F / point[2]) ** 2 * (1 + np.abs(point).max() ** 2) * (1 + F) ** 2
    np.testing.assert_allclose(
        J @ error.camera_covariance @ J.T, expected, rtol=1e-9, atol=1e-12 * lever * (covariance.max() + 1e-300)
    )


def test_signs_that_everyone_can_check():
    # the scene moves: right -> image right; down -> down; away -> towards the centre; turned about the axis -> turned
    J = point_jacobian([10.0, 20.0, 400.0], F)
    assert J[0, 0] == J[1, 1] == F / 400
    assert J[0, 1] == J[1, 0] == 0
    assert (J[:, 2] < 0).all()
    np.testing.assert_allclose(J[:, 5], [-20 * F / 400, 10 * F / 400])
    on_axis = point_jacobian([0.0, 0.0, 400.0], F)
    np.testing.assert_allclose(on_axis[:, 3:5], [[0, F], [-F, 0]])  # turning about y moves the image right


def test_jacobians_of_arrays_are_those_of_their_points():
    points = np.stack([POINTS, POINTS[::-1]])
    J = point_jacobian(points, F)
    assert J.shape == (2, 4, 2, 6)
    for index in np.ndindex(2, 4):
        np.testing.assert_array_equal(J[index], point_jacobian(points[index], F))
    assert math.isclose(J[0, 0, 0, 0], 2 * point_jacobian(POINTS[0], F / 2)[0, 0])
