"""Edges whose place is known to a hundredth of a pixel, and images in which there is none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from viewgauge.measurement.edges import EdgeFinder

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
