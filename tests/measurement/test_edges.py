"""Edges whose place is known to a hundredth of a pixel, and images in which there is none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from viewgauge.measurement.image.edges import BIAS_PX, EdgeFinder
from viewgauge.sensors import Window

SIZE = 160


def straight(offset, angle, blur, low=0.2, high=0.7):
    """An edge through (80, 80) + offset across, blurred by a Gaussian: exactly a normal distribution function."""
    v, u = np.mgrid[0:SIZE, 0:SIZE]
    across = -(u - 80) * np.sin(angle) + (v - 80) * np.cos(angle)
    return low + (high - low) * ndtr((across - offset) / blur)


def disc(radius, centre, blur):
    """A disc, blurred; for a radius much larger than the blur its edge is at the radius to blur² / (2 radius)."""
    v, u = np.mgrid[0:SIZE, 0:SIZE]
    return 0.2 + 0.5 * ndtr((radius - np.hypot(u - centre[0], v - centre[1])) / blur)


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2, 2.2])
@pytest.mark.parametrize("offset", [-3.37, 0.0, 4.81])
def test_a_clean_edge_is_found_to_a_hundredth_of_a_pixel(angle, offset):
    image = straight(offset, angle, 0.8)
    edge = EdgeFinder(image, noise=0.001).edge(np.array([80.0, 80.0]), direction(angle), np.arange(-9, 9 + 1.0), 8.0)
    assert edge is not None
    assert edge.coefficients[0] == pytest.approx(offset, abs=0.015)
    assert edge.coefficients[1] == pytest.approx(0, abs=2e-3)
    assert edge.contrast == pytest.approx(0.5, rel=0.05)
    assert edge.width_px == pytest.approx(0.8, rel=0.15)
    # where a line across it meets it
    met = edge.meets(np.array([80.0, 80.0]), np.array([-np.sin(angle), np.cos(angle)]))
    expected = np.array([80.0, 80.0]) + offset * np.array([-np.sin(angle), np.cos(angle)])
    assert met == pytest.approx(expected, abs=0.02)


def test_noise_spreads_the_edge_by_little_and_without_bias():
    """300 images with noise of 4 % of the step: the mean within 4 standard errors of the truth, spread below 0.05."""
    rng, found = np.random.default_rng(1), []
    clean = straight(1.234, 0.4, 0.8)
    for _ in range(300):
        image = clean + 0.02 * rng.standard_normal(clean.shape)
        edge = EdgeFinder(image, noise=0.02).edge(np.array([80.0, 80.0]), direction(0.4), np.arange(-9, 9 + 1.0), 6.0)
        assert edge is not None
        found.append(edge.coefficients[0])
    assert np.std(found) < 0.05
    assert np.mean(found) == pytest.approx(1.234, abs=4 * np.std(found) / np.sqrt(300) + 0.005)


def test_a_bent_edge_is_a_parabola():
    edge = EdgeFinder(disc(40.0, (80.0, 80.0), 0.8), noise=0.001).edge(
        np.array([80.0, 119.0]), direction(0.0), np.arange(-9, 9 + 1.0), 5.0, bent=True
    )
    assert edge is not None
    assert edge.coefficients[0] == pytest.approx(1.0, abs=0.03)
    assert edge.coefficients[2] == pytest.approx(-1 / (2 * 40), rel=0.1)


def test_where_there_is_no_edge_none_is_found():
    """200 images of noise alone; not one edge."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        image = 0.5 + 0.05 * rng.standard_normal((60, 60))
        finder = EdgeFinder(image)
        assert finder.noise == pytest.approx(0.05, rel=0.2)
        assert finder.edge(np.array([30.0, 30.0]), direction(rng.uniform(0, 3)), np.arange(-9, 9 + 1.0), 6.0) is None


def test_an_edge_elsewhere_or_turned_is_not_the_one_that_is_looked_for():
    finder = EdgeFinder(straight(9.0, 0.4, 0.8), noise=0.001)
    assert finder.edge(np.array([80.0, 80.0]), direction(0.4), np.arange(-9, 9 + 1.0), 5.0) is None
    finder = EdgeFinder(straight(0.0, 0.5, 0.8), noise=0.001)
    assert finder.edge(np.array([80.0, 80.0]), direction(0.4), np.arange(-9, 9 + 1.0), 5.0) is None


def test_of_two_equal_edges_the_nearer_one():
    image = straight(-4.0, 0.0, 0.6, 0.0, 0.4) + straight(2.0, 0.0, 0.6, 0.0, 0.4)
    edge = EdgeFinder(image, noise=0.001).edge(np.array([80.0, 80.0]), direction(0.0), np.arange(-9, 9 + 1.0), 7.0)
    assert edge is not None
    assert edge.coefficients[0] == pytest.approx(2.0, abs=0.05)


def found_of_two(nearer, farther, side, strength):
    """Where an edge is found beside two: at the nearer place, ``strength`` times the other's step, and at the other."""
    image = straight(side * nearer, 0.0, 0.6, 0.0, 0.4 * strength) + straight(side * farther, 0.0, 0.6, 0.0, 0.4)
    finder = EdgeFinder(image, noise=0.001)
    offset, _ = finder.offsets(np.array([[80.0, 80.0]]), np.array([[0.0, 1.0]]), 8.0)
    edge = finder.edge(np.array([80.0, 80.0]), direction(0.0), np.arange(-9, 10.0), 8.0)
    assert edge is not None
    assert edge.coefficients[0] == pytest.approx(offset[0], abs=0.1)
    return side * edge.coefficients[0]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("nearer", "farther"), [(-1.0, 6.0), (1.0, -6.0), (0.0, -6.0)])
def test_of_neighbouring_edges_the_nearer_one_unless_the_other_is_much_stronger(nearer, farther, side):
    """On either side; "much" is where the nearer has less than 0.6 of the stronger one's step."""
    for strength in (1.5, 1.0, 0.7, 0.63):
        assert found_of_two(nearer, farther, side, strength) == pytest.approx(nearer, abs=0.05)
    for strength in (0.57, 0.4, 0.1):
        assert found_of_two(nearer, farther, side, strength) == pytest.approx(farther, abs=0.05)


def test_a_stronger_edge_beyond_reach_is_not_taken():
    image = straight(5.0, 0.0, 0.6, 0.0, 0.2) + straight(-6.0, 0.0, 0.6, 0.0, 0.6)
    finder = EdgeFinder(image, noise=0.001)
    for reach, expected in ((5.5, 5.0), (8.0, -6.0)):
        edge = finder.edge(np.array([80.0, 80.0]), direction(0.0), np.arange(-9, 10.0), reach)
        assert edge is not None
        assert edge.coefficients[0] == pytest.approx(expected, abs=0.05)
    assert finder.edge(np.array([80.0, 80.0]), direction(0.0), np.arange(-9, 10.0), 4.0) is None


@pytest.mark.parametrize("slopes", [(0.02, 0.0), (0.0, -0.02), (0.015, 0.015)])
def test_shading_beside_an_edge_does_not_move_it(slopes):
    """A step of 0.5 with ramps of up to 4 % of it a pixel on either side, blurred numerically."""
    fine = np.arange(-60, 60, 0.02)
    below, above = (np.where(side, slope, 0.0) for side, slope in zip((fine < 0, fine >= 0), slopes, strict=True))
    profile = 0.3 + 0.5 * (fine >= 0) + (below + above) * fine
    kernel = np.exp(-0.5 * (np.arange(-5, 5, 0.02) / 0.7) ** 2)
    blurred = np.convolve(profile, kernel / kernel.sum(), mode="same")
    v, u = np.mgrid[0:SIZE, 0:SIZE]
    across = -(u - 80) * np.sin(0.3) + (v - 80) * np.cos(0.3) - 0.37
    image = np.interp(np.clip(across, -50, 50), fine, blurred)
    edge = EdgeFinder(image, noise=0.001).edge(np.array([80.0, 80.0]), direction(0.3), np.arange(-9, 10.0), 5.0)
    assert edge is not None
    # the steepest place of the smoothed profile would be off by up to 0.06 px: slope times its width squared over step
    assert edge.coefficients[0] == pytest.approx(0.37, abs=0.02)


# two steps up within three blurs look like one: of them no edge detector can say that they are two
@pytest.mark.parametrize(
    ("gap", "step"), [(g, s) for g in (2.0, 2.8, 3.5) for s in (0.25, -0.25, 0.1) if (g, s) != (2.0, -0.25)]
)
def test_an_edge_with_another_near_is_right_to_a_tenth_of_a_pixel_or_refused(gap, step):
    image = straight(0.0, 0.0, 0.7, 0.0, 0.4) - straight(gap, 0.0, 0.7, 0.0, step)
    edge = EdgeFinder(image, noise=0.001).edge(np.array([80.0, 80.0]), direction(0.0), np.arange(-9, 10.0), 4.0)
    assert edge is None or abs(edge.coefficients[0]) < 0.1
    if step == 0.25:
        assert edge is None


def test_a_bent_edge_is_no_straight_one():
    finder = EdgeFinder(disc(60.0, (80.0, 80.0), 0.8), noise=0.001)
    assert finder.edge(np.array([80.0, 140.0]), direction(0.0), np.arange(-9, 10.0), 4.0) is None
    assert finder.edge(np.array([80.0, 140.0]), direction(0.0), np.arange(-9, 10.0), 4.0, bent=True) is not None


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 4])
def test_the_stated_covariance_is_the_scatter(angle):
    """400 images, noise of 4 % of the step; a deviation is off by 3.5 % (one sigma), and the model of it by some."""
    rng, found, reported = np.random.default_rng(5), [], []
    clean = straight(0.6, angle, 0.7)
    for _ in range(400):
        finder = EdgeFinder(clean + 0.02 * rng.standard_normal(clean.shape), noise=0.02)
        edge = finder.edge(np.array([80.0, 80.0]), direction(angle), np.arange(5.0, 19.0), 5.0)
        if edge is not None:
            found.append(edge.coefficients[:2])
            reported.append(edge.covariance[:2, :2])
    assert len(found) > 390
    predicted = np.mean(reported, axis=0) - np.diag([BIAS_PX**2, 0])
    assert np.std(found, axis=0) == pytest.approx(np.sqrt(predicted.diagonal()), rel=0.2)


def test_in_a_window_the_same_edge_and_elsewhere_none():
    image = straight(1.3, 0.4, 0.8) + 0.01 * np.random.default_rng(1).standard_normal((SIZE, SIZE))
    windows = [Window(40, 40, 120, 120), Window(60, 60, 110, 115)]
    whole, part = EdgeFinder(image, 0.01), EdgeFinder(image, 0.01, windows)
    at = np.array([80.0, 80.0]), direction(0.4), np.arange(-9, 10.0), 5.0
    expected, found = whole.edge(*at), part.edge(*at)
    assert expected is not None
    assert found is not None
    assert found.coefficients == pytest.approx(expected.coefficients, abs=1e-3)
    along = 60 * direction(0.4)
    assert whole.edge(np.array([80.0, 80.0]) + along, *at[1:]) is not None
    assert part.edge(np.array([80.0, 80.0]) + along, *at[1:]) is None
