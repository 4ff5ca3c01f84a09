"""The diameter of a rendered round plate, seen at an angle: found to hundredths of a pixel, or refused."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from viewgauge.geometry import Lens, invert, look_at, transform
from viewgauge.measurement.image.edges import EdgeFinder
from viewgauge.measurement.image.rim import find_rim
from viewgauge.sensors import Camera
from viewgauge.simulation.image_sensor import ImageSensor
from viewgauge.simulation.renderer import Renderer

RADIUS, SIDES = 10.0, 720  # of the plate, mm; as many-sided its radius is right to 1e-4 mm
ANGLE = np.linspace(0, 2 * np.pi, SIDES, endpoint=False)
RING = np.stack([RADIUS * np.cos(ANGLE), RADIUS * np.sin(ANGLE), np.zeros(SIDES)], axis=1)
PLATE = np.vstack([RING, [[0.0, 0, 0]]])
FAN = np.array([[k, (k + 1) % SIDES, SIDES] for k in range(SIDES)])
CAMERA = Camera(16.0, (0.01, 0.01), (320, 240))
AXIS = np.array([0.0, 0, 1])


def pose(tilt, distance=150.0):
    eye = distance * np.array([[np.sin(tilt) * 0.6, np.sin(tilt) * 0.8, np.cos(tilt)]])
    return look_at(eye, np.zeros((1, 3)), np.array([0.3]))[0]


def diameter(angle):
    return RADIUS * np.array([[-np.cos(angle), -np.sin(angle), 0], [np.cos(angle), np.sin(angle), 0]])


@lru_cache(maxsize=2)
def light(T, camera):
    """What falls on the sensor: the same in every image that only noise tells apart."""
    return Renderer(PLATE, FAN, rays_per_pixel=89).radiance(np.reshape(T, (4, 4)), camera)


def seen(T, angle, camera=CAMERA, noise=0.0, rng=None, hidden=None, guess=None):
    """What the rim gives, and the true length, both mm on the image."""
    shown = light(tuple(T.ravel()), camera)
    grey = ImageSensor(blur_px=0.6, noise=noise, bits=12).grey(shown, rng or np.random.default_rng(0)) / 4095
    if hidden is not None:
        grey = np.where(hidden, 0.3, grey)
    expected = invert(T if guess is None else guess)
    finder = EdgeFinder(grey, max(noise, 0.0005))
    points = transform(expected, diameter(angle))
    true = float(np.linalg.norm(np.diff(camera.project(transform(invert(T), diameter(angle))), axis=0)))
    return find_rim(finder, points, expected[:3, :3] @ AXIS, camera, 6.0), true


@pytest.mark.parametrize("tilt", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("angle", [0.2, 1.4])
@pytest.mark.parametrize("lens", [None, Lens("radial-tangential", (-0.3, 0.1, 1e-3, -2e-3))])
def test_the_diameter_is_right_to_a_few_hundredths_of_a_pixel(tilt, angle, lens):
    camera = Camera(16.0, (0.01, 0.01), (320, 240), lens=lens)
    T = pose(tilt)
    rim, true = seen(T, angle, camera)
    assert rim is not None
    length = float(np.linalg.norm(np.diff(rim.ends, axis=0)))
    assert abs(length - true) / 0.01 < 0.06, "px, of about 200"
    assert np.sqrt(rim.variance_mm2) / 0.01 < 0.06


def test_it_is_looked_for_from_a_few_pixels_off():
    T, guess = pose(0.7), pose(0.7)
    guess[:3, 3] += T[:3, :3] @ [0.25, -0.2, 0.3]  # about 4 px
    (rim, true), (same, _) = seen(T, 0.5, guess=guess), seen(T, 0.5)
    assert rim is not None
    assert same is not None
    # the chord's direction is the guess's: second order of what it is turned by
    assert np.linalg.norm(np.diff(rim.ends, axis=0)) == pytest.approx(
        np.linalg.norm(np.diff(same.ends, axis=0)), rel=2e-3
    )
    assert np.linalg.norm(np.diff(rim.ends, axis=0)) == pytest.approx(true, rel=2e-3)


def test_the_stated_variance_is_the_scatter():
    """60 images, noise of 3 %: a deviation is off by 9 % (one sigma): 4.4 sigma. Without what is the same in all."""
    rng, T = np.random.default_rng(4), pose(0.6)
    found = [seen(T, 0.4, noise=0.03, rng=rng)[0] for _ in range(60)]
    assert all(rim is not None for rim in found)
    lengths = np.array([np.linalg.norm(np.diff(rim.ends, axis=0)) for rim in found])
    predicted = np.sqrt(np.mean([rim.variance_mm2 for rim in found]) - (2 * 0.02 * 0.01) ** 2)
    assert lengths.std() == pytest.approx(predicted, rel=0.4)


def test_half_a_rim_or_none_is_refused():
    columns = np.arange(320)[None, :]
    T = pose(0.4)
    assert seen(T, 0.4, hidden=columns > 165)[0] is None
    assert seen(T, 0.4, hidden=columns >= 0)[0] is None
    assert seen(T, 0.4, hidden=abs(columns - 160) < 8)[0] is not None, "two short arcs are missing"
