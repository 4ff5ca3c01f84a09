"""Lens distortion against OpenCV, which shares no code with it."""

import numpy as np
import pytest

from viewgauge.exceptions import InputError
from viewgauge.geometry import Lens
from viewgauge.sensors import Camera

cv2 = pytest.importorskip("cv2")

RNG = np.random.default_rng(0)
POINTS = RNG.uniform(-0.6, 0.6, (500, 2))
IN_SPACE = np.concatenate([POINTS, np.ones((500, 1))], axis=1)[:, None]
LENSES = {
    f"{n} coefficients": Lens("radial-tangential", (-0.2, 0.05, *RNG.normal(0, 0.02, n - 2).tolist()))
    for n in (4, 5, 8, 12)
} | {"fisheye": Lens("equidistant", (0.05, -0.02, 0.01, -0.003))}


def by_opencv(lens):
    """Places, and derivatives with respect to the coefficients ``(n, 2, k)``."""
    coefficients, no = np.array(lens.coefficients), np.zeros(3)
    if lens.model == "equidistant":
        places, J = cv2.fisheye.projectPoints(IN_SPACE, no, no, np.eye(3), coefficients)
        return places[:, 0], J.reshape(len(POINTS), 2, -1)[..., 4:8]
    places, J = cv2.projectPoints(IN_SPACE, no, no, np.eye(3), coefficients)
    return places[:, 0], J.reshape(len(POINTS), 2, -1)[..., 10:]


@pytest.mark.parametrize("lens", LENSES.values(), ids=LENSES)
def test_places_and_derivatives_are_opencv_s(lens):
    places, J = by_opencv(lens)
    np.testing.assert_allclose(lens.distort(POINTS), places, atol=1e-14)
    np.testing.assert_allclose(lens.coefficient_jacobian(POINTS), J, atol=1e-12)


@pytest.mark.parametrize("lens", LENSES.values(), ids=LENSES)
def test_the_derivative_is_that_of_differences(lens):
    """Central differences of 1e-6: off by 1e-10 for rounding."""
    h = 1e-6
    steps = [(lens.distort(POINTS + h * e) - lens.distort(POINTS - h * e)) / (2 * h) for e in np.eye(2)]
    np.testing.assert_allclose(lens.jacobian(POINTS), np.stack(steps, axis=-1), atol=2e-9)


@pytest.mark.parametrize("lens", LENSES.values(), ids=LENSES)
def test_undistorting_undoes_it(lens):
    np.testing.assert_allclose(lens.undistort(lens.distort(POINTS)), POINTS, atol=1e-12)
    assert lens.undistort(np.zeros(2)) == pytest.approx(np.zeros(2))
    assert lens.jacobian(np.zeros(2)) == pytest.approx(np.eye(2))


def test_where_a_lens_folds_it_shows_nothing():
    """r (1 - r²/2) is largest at r = 0.8165, where it is 0.5443."""
    folding = Lens("radial-tangential", (-0.5, 0, 0, 0))
    assert folding.undistort([0.5, 0.0]) == pytest.approx([0.6180339887, 0.0])  # the golden ratio, not the root beyond
    assert np.isnan(folding.undistort([0.55, 0.0])).all()


@pytest.mark.parametrize(
    ("model", "coefficients", "problem"),
    [
        ("fisheye", (0, 0, 0, 0), "unknown lens model"),
        ("radial-tangential", (0, 0, 0), "number of coefficients"),
        ("equidistant", (0, 0, 0, 0, 0), "number of coefficients"),
        ("equidistant", (0, 0, 0, np.nan), "finite"),
        ("equidistant", ("a", 0, 0, 0), "finite"),
    ],
)
def test_bad_lenses_are_refused(model, coefficients, problem):
    with pytest.raises(InputError, match=problem):
        Lens(model, coefficients)


CAMERA = Camera(
    8.0, (0.00345, 0.0036), (2448, 2048), principal_point_px=(1200.0, 1030.0), lens=LENSES["5 coefficients"]
)


def test_pixels_are_where_opencv_projects_and_lead_back():
    points = np.array([[10.0, -20, 100], [40, 30, 120], [-35, 5, 90]])
    matrix = np.array([[8 / 0.00345, 0, 1200], [0, 8 / 0.0036, 1030], [0, 0, 1]])
    expected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(CAMERA.lens.coefficients))
    px = CAMERA.to_pixels(CAMERA.project(points))
    np.testing.assert_allclose(px, expected[:, 0], atol=1e-9)
    np.testing.assert_allclose(CAMERA.from_pixels(px), CAMERA.project(points), atol=1e-11)
    step = 1e-5
    image = CAMERA.project(points)
    J = np.stack(
        [(CAMERA.to_pixels(image + step * e) - CAMERA.to_pixels(image - step * e)) / 2e-5 for e in np.eye(2)], -1
    )
    np.testing.assert_allclose(CAMERA.pixel_jacobian(image), J, rtol=1e-6)


def test_a_lens_that_folds_within_the_image_is_refused():
    with pytest.raises(InputError, match="two directions in one place"):
        Camera(8.0, (0.00345, 0.00345), (2448, 2048), lens=Lens("radial-tangential", (-9.0, 0, 0, 0)))


@pytest.mark.parametrize(
    ("matrix", "problem"),
    [
        (np.eye(3), "not a covariance"),
        (-np.eye(4), "negative"),
        ([[1, 0.5, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], "not symmetric"),
        ([[1, 2, 0, 0], [2, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], "some combination"),
        (np.full((4, 4), np.nan), "not a covariance"),
        ("text", "not a matrix"),
    ],
)
def test_bad_covariances_of_intrinsics_are_refused(matrix, problem):
    with pytest.raises(InputError, match=problem):
        Camera(8.0, (0.00345, 0.00345), (2448, 2048), intrinsics_covariance=matrix)
