"""The law of a measured length, against the full camera model's draws."""

from __future__ import annotations

import numpy as np
import pytest

from viewgauge.geometry import PoseError, invert, look_at, transform
from viewgauge.measurement.image.length_law import length_law
from viewgauge.sensors import Camera, EdgeDetector
from viewgauge.simulation.full_camera import simulate_length_errors

POSE_ERROR = PoseError.from_standard_deviations(0.1, 3e-4, pivot_mm=(0, 0, -16))
CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.1)
T = look_at(np.array([[60.0, -80, 380]]), np.array([[20.0, 10, 0]]), np.array([0.4]))[0]
POINTS = np.array([[0.0, 0, 0], [45, 20, 5]])


@pytest.mark.parametrize("whole_pixels", [False, True])
def test_it_is_pose_error_and_ends_and_pixels(whole_pixels):
    """Half a million draws: a deviation is off by 0.1 % (one sigma); the law, of first order, by about 0.5 %."""
    law = length_law(POINTS, T, CAMERA, POSE_ERROR, 0.0007, whole_pixels=whole_pixels)
    step = 1.0 if whole_pixels else 0.0
    exact = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=step)
    rng = np.random.default_rng(2)
    start, end = transform(invert(T), POINTS)
    drawn = simulate_length_errors(start, end, exact, POSE_ERROR, 500_000, rng) + 0.0007 * rng.standard_normal(500_000)
    assert float(law.std()) == pytest.approx(drawn.std(), rel=6e-3)
    for x in (0.5, 1.0, 2.0):
        bound = x * float(law.std())
        assert float(law.central_probability(bound)) == pytest.approx((np.abs(drawn) <= bound).mean(), abs=4e-3)


def test_what_the_inspection_says_of_noise_gives_way_to_the_image_but_not_its_offset():
    def spread(camera):
        return float(length_law(POINTS, T, camera, POSE_ERROR, 0.0007, whole_pixels=False).std())

    def located(**changes):
        return Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_detector=EdgeDetector(**changes))

    assert spread(located(noise_px=3.0)) == pytest.approx(spread(CAMERA))
    assert spread(located(noise_px=0.0, bias_px=0.5)) ** 2 == pytest.approx(
        spread(CAMERA) ** 2 + (2 * 0.5 * 0.00345) ** 2
    )
