"""Parts of images are parts of the whole; a camera that is not what its calibration says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewgauge.geometry import Lens, look_at
from viewgauge.sensors import Camera, Window
from viewgauge.simulation.image_sensor import ImageSensor
from viewgauge.simulation.partial_image import partial_image
from viewgauge.simulation.renderer import Renderer
from viewgauge.simulation.true_camera import true_camera

CAMERA = Camera(12.0, (0.005, 0.005), (120, 90))
PLATE = np.array([[-4.0, -3, 0], [4, -3, 0], [4, 3, 0], [-4, 3, 0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
T = look_at(np.array([[0.0, 0, 250]]), np.zeros((1, 3)), np.array([0.3]))[0]


@pytest.mark.parametrize(
    "sensor", [ImageSensor(blur_px=1.3), ImageSensor(), ImageSensor(black_and_white=True), ImageSensor(bits=12)]
)
def test_in_the_windows_the_whole_image_and_elsewhere_nothing(sensor):
    renderer, windows = Renderer(PLATE, TRIANGLES), [Window(0, 0, 30, 30), Window(20, 10, 90, 60)]
    rng = np.random.default_rng(0)
    whole = partial_image(renderer, sensor, T, CAMERA, [Window.whole(CAMERA)], rng)
    part = partial_image(renderer, sensor, T, CAMERA, windows, rng)
    inside = np.zeros((90, 120), dtype=bool)
    for window in windows:
        inside[window.slices] = True
    assert whole[inside].max() > 100
    assert np.array_equal(part[inside], whole[inside])
    assert not part[~inside].any()


def test_true_cameras_scatter_as_the_calibration_says():
    """2000 draws: variances are off by 3.2 % (one sigma), correlations by 0.022 at most: 4.7 sigma."""
    deviation = np.array([1.5, 1.2, 2.0, 2.5, 0.01, 0.02, 1e-4, 2e-4])
    correlation = np.eye(8)
    correlation[0, 1] = correlation[1, 0] = 0.9
    correlation[4, 5] = correlation[5, 4] = -0.8
    covariance = correlation * np.outer(deviation, deviation)
    lens = Lens("radial-tangential", (-0.1, 0.05, 1e-3, -1e-3))
    camera = replace(CAMERA, lens=lens, intrinsics_covariance=tuple(map(tuple, covariance.tolist())))
    rng, drawn = np.random.default_rng(3), []
    for _ in range(2000):
        true = true_camera(camera, rng)
        assert true.intrinsics_covariance is None
        assert true.lens is not None
        focal = [true.focal_length_mm / pitch for pitch in true.pixel_pitch_mm]
        drawn.append([*focal, *true.principal_point, *true.lens.coefficients])
    mean = [2400, 2400, *CAMERA.principal_point, *lens.coefficients]
    assert (np.abs(np.mean(drawn, axis=0) - mean) < 4 * deviation / np.sqrt(2000)).all()
    found = np.cov(np.array(drawn).T) / np.outer(deviation, deviation)
    assert np.abs(found - correlation).max() < 0.15
    assert true_camera(CAMERA, rng) is CAMERA
