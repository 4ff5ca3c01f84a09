"""A point's displacement law against the exact motion, and the paper's own form against it in rational arithmetic."""

import math
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import viewgauge as vg
from strategies import points_in_front, pose_covariances, rigid_poses
from viewgauge.errors import NormalRatio, PointDisplacement, covariance_numerator_denominator, lambdas
from viewgauge.geometry import point_jacobian

F = 16.0
POINT = np.array([-30.0, 10.0, 480.0])
AT_IMAGE_PLANE = (0.0, 0.0, -F)
numbers = st.fractions(min_value=-100, max_value=100, max_denominator=50)


def moved_image(point, twist, f=F):
    """Image of p + delta x p + d."""
    p = point + np.cross(twist[3:], point) + twist[:3]
    return f * p[:2] / p[2]


@settings(deadline=None)
@given(points_in_front(), st.lists(st.floats(-1e-2, 1e-2), min_size=6, max_size=6))
def test_zeta_xi_chi_are_the_exact_error_of_the_image_point(point, twist):
    law = PointDisplacement(point, F, np.zeros((6, 6)))
    twist = np.array(twist) * [point[2], point[2], point[2], 1, 1, 1]
    zeta, xi = law.zeta_row @ twist, law.xi_row @ twist
    chi = law.mean_chi + law.chi_row @ twist
    expected = moved_image(point, twist) - F * point[:2] / point[2]
    np.testing.assert_allclose([zeta / chi, xi / chi], expected, rtol=1e-10, atol=1e-14)


@settings(deadline=None)
@given(points_in_front(), pose_covariances(), rigid_poses())
def test_first_order_is_the_image_jacobian(point, covariance, T_camera_frame):
    error = vg.PoseError(covariance, T_camera_frame=T_camera_frame)
    law = PointDisplacement(point, F, error.camera_covariance)
    J = point_jacobian(point, F)
    np.testing.assert_allclose(law.jacobian, J, rtol=1e-13, atol=1e-13 * np.abs(J).max())
    for marginal, row in ((law.u, J[0]), (law.v, J[1])):
        sigma = math.sqrt(max(row @ error.camera_covariance @ row, 0))
        assert float(marginal.sigma_numerator / marginal.mean_denominator) == pytest.approx(sigma, rel=1e-6, abs=1e-9)
        assert -1 <= marginal.correlation <= 1


def test_the_laws_are_those_of_the_drawn_image_points():
    # Kolmogorov-Smirnov on 20 000 draws of the pose error, seed fixed; false alarm 1e-4 for each coordinate
    error = vg.PoseError.from_standard_deviations([5.0, 3.0, 20.0], [0.02, 0.01, 0.03], pivot_mm=AT_IMAGE_PLANE)
    law = PointDisplacement(POINT, F, error.camera_covariance)
    twists = np.random.default_rng(5).multivariate_normal(np.zeros(6), error.camera_covariance, 20_000)
    images = np.array([moved_image(POINT, twist) for twist in twists]) - F * POINT[:2] / POINT[2]
    assert stats.kstest(images[:, 0], law.u.cdf).pvalue > 1e-4
    assert stats.kstest(images[:, 1], law.v.cdf).pvalue > 1e-4


def test_correlation_grows_with_the_distance_from_the_axis():
    # paper, III-B: Cov = 0 on the axis, and the spread of u grows with X
    error = vg.PoseError.from_standard_deviations(0.5, 1e-3, pivot_mm=AT_IMAGE_PLANE)
    points = np.stack([[0.0, 50.0, 150.0, 300.0], np.zeros(4), np.full(4, 500.0)], axis=-1)
    law = PointDisplacement(points, F, error.camera_covariance)
    assert law.r_zeta_chi[0] == 0
    assert law.u.mode()[0] == 0
    assert (np.diff(np.abs(law.r_zeta_chi)) > 0).all()
    assert (np.diff(law.u.std()) > 0).all()
    # the paper's image is inverted: its correlation, of the sign of C1, is the negative of this one
    assert (law.r_zeta_chi[1:] < 0).all()


@pytest.mark.parametrize("f", [F, [[F], [2 * F], [35.0]]])
def test_points_and_covariances_broadcast(f):
    covariances = np.stack([np.eye(6) * k * 1e-4 for k in (1, 2)])[:, None]
    points = np.stack([POINT, 2 * POINT, POINT + 1])
    law = PointDisplacement(points, F, covariances)
    assert law.u.std().shape == (2, 3)
    alone = PointDisplacement(points[1], F, covariances[1, 0])
    assert law.u.cdf(0.01)[1, 1] == pytest.approx(float(alone.u.cdf(0.01)), abs=1e-15)
    assert law.r_xi_chi[1, 1] == pytest.approx(float(alone.r_xi_chi))
    assert PointDisplacement(POINT, f, np.eye(6)).u.std().shape == np.shape(f)


def test_without_error_the_law_is_a_single_value():
    law = PointDisplacement(POINT, F, np.zeros((6, 6)))
    assert isinstance(law.u, NormalRatio)
    assert (law.u.var(), law.v.mean(), law.r_zeta_chi, law.sigma_xi) == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (([1.0, 2.0], F, np.eye(6)), "point_mm"),
        (([1.0, 2.0, 0.0], F, np.eye(6)), "lens"),
        ((POINT, math.nan, np.eye(6)), "focal_length_mm"),
        ((POINT, F, np.eye(5)), "covariance"),
    ],
)
def test_bad_arguments_are_refused(arguments, name):
    with pytest.raises(vg.InputError, match=name):
        PointDisplacement(*arguments)


# --- the paper's own form -----------------------------------------------------------------------------------


def exact_lambdas(c1, c2, c3, f):
    """lambda_1 … lambda_21 in rational arithmetic, from u' - u and v' - v of the paper's text, unit by unit.

    (u' - u) (f - C3) D = f ((f - C3) A - C1 D) with u' = f A / D, A and D linear in the errors: chi = (f - C3) D.
    """

    def displaced(e):  # numerators of u', v' over f, and their denominator
        dx, dy, dz, tx, ty, tz = e
        return (
            c1 + c3 * dy - c2 * dz + tx,
            c2 + c1 * dz - c3 * dx + ty,
            f - (c3 + c2 * dx - c1 * dy + tz),
        )

    def parts(e):
        a, b, d = displaced(e)
        return f * ((f - c3) * a - c1 * d), f * ((f - c3) * b - c2 * d), (f - c3) * d

    constant = parts([0] * 6)
    columns = [parts([int(k == n) for k in range(6)]) for n in range(6)]
    return [[*(column[i] - constant[i] for column in columns), constant[i]] for i in range(3)]


@settings(deadline=None)
@given(numbers, numbers, numbers, numbers)
def test_lambdas_follow_from_the_displaced_image_and_lambda_20_is_misprinted(c1, c2, c3, f):
    # polynomials of low degree that agree at these random rational points are equal
    values = [float(x) for x in (c1, c2, c3, f)]
    expected = np.array([float(x) for row in exact_lambdas(c1, c2, c3, f) for x in row])
    scale = max(1.0, *np.abs(values)) ** 3
    np.testing.assert_allclose(lambdas(*values), expected, rtol=1e-12, atol=1e-12 * scale)
    differs = lambdas(*values, printed=True) != lambdas(*values)
    assert differs.nonzero()[0].tolist() == ([19] if c3 != f else [])


@settings(deadline=None)
@given(numbers, numbers, numbers, numbers, numbers, numbers)
def test_covariances_follow_from_the_lambdas(c1, c2, c3, f, rotation, translation):
    zeta, xi, chi = exact_lambdas(c1, c2, c3, f)
    variances = [rotation**2] * 3 + [translation**2] * 3
    expected = [sum(a * b * v for a, b, v in zip(row, chi, variances, strict=False)) for row in (zeta, xi)]
    common = f * (f - c3) * ((f * c3 - c1**2 - c2**2 - c3**2) * rotation**2 - translation**2)
    assert expected == [c1 * common, c2 * common]  # eq. 13, 14 with the sign of sigma_j² put right: exactly
    assert all(isinstance(value, int | Fraction) for value in expected)
    sigmas = (abs(float(rotation)), abs(float(translation)))
    found = covariance_numerator_denominator(float(c1), float(c2), float(c3), float(f), *sigmas)
    size = max(1.0, *(abs(float(x)) for x in (c1, c2, c3, f, rotation, translation))) ** 7
    np.testing.assert_allclose(found, [float(x) for x in expected], rtol=1e-9, atol=1e-13 * size)


@settings(deadline=None)
@given(points_in_front(), st.floats(1.0, 50.0), st.floats(1e-6, 1e-2), st.floats(1e-3, 5.0))
def test_the_papers_form_is_the_same_law_in_another_frame(point, f, sigma_rotation, sigma_translation):
    X, Y, Z = point
    error = vg.PoseError.from_standard_deviations(sigma_translation, sigma_rotation, pivot_mm=(0.0, 0.0, -f))
    law = PointDisplacement(point, f, error.camera_covariance)
    paper = lambdas(X, Y, Z + f, f)
    variances = np.array([sigma_rotation] * 3 + [sigma_translation] * 3) ** 2
    zeta, xi, chi = paper[:6], paper[7:13], paper[14:20]
    assert paper[20] == pytest.approx(float(law.mean_chi), rel=1e-9)
    assert zeta**2 @ variances == pytest.approx(float(law.sigma_zeta**2), rel=1e-8)
    assert xi**2 @ variances == pytest.approx(float(law.sigma_xi**2), rel=1e-8)
    assert chi**2 @ variances == pytest.approx(float(law.sigma_chi**2), rel=1e-8)
    covariances = covariance_numerator_denominator(X, Y, Z + f, f, sigma_rotation, sigma_translation)
    for covariance, r, sigma in zip(
        covariances, (law.r_zeta_chi, law.r_xi_chi), (law.sigma_zeta, law.sigma_xi), strict=True
    ):
        # the paper's image is inverted: numerators change their sign
        assert float(covariance) == pytest.approx(-float(r * sigma * law.sigma_chi), rel=1e-6, abs=1e-9)


def test_the_printed_signs_are_wrong_by_a_draw():
    # theory.md, errata: the exact error, against the ratio with either sign of lambda_20
    c, f, errors = np.array([40.0, -25.0, 516.0]), F, np.array([1e-3, -2e-3, 1.5e-3, 0.4, -0.3, 0.9])
    rotation, translation = errors[:3], errors[3:]
    moved = c + np.cross(rotation, c) + translation
    exact = f * moved[0] / (f - moved[2]) - f * c[0] / (f - c[2])
    ratio = {}
    for printed in (False, True):
        row = lambdas(*c, f, printed=printed)
        ratio[printed] = row[:6] @ errors / (row[20] + row[14:20] @ errors)
    assert ratio[False] == pytest.approx(exact, rel=1e-12)
    assert abs(ratio[True] / exact - 1) > 1e-3


def test_the_papers_form_broadcasts():
    assert lambdas(np.zeros((3, 1)), np.zeros(4), 500.0, F).shape == (3, 4, 21)
    zeta, xi = covariance_numerator_denominator(np.arange(3.0), 0.0, 500.0, F, 1e-3, 0.1)
    assert zeta.shape == (3,)
    assert (np.diff(zeta) > 0).all()  # increasing in C1, as the paper says
    assert (xi == 0).all()
