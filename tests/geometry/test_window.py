"""Rectangles of pixels, within the image."""

import numpy as np
import pytest

from viewgauge.sensors import Camera, Window

CAMERA = Camera(16.0, (0.01, 0.01), (320, 240))


@pytest.mark.parametrize(
    ("places", "reach", "expected"),
    [
        ([[10.2, 20.7]], 3.0, Window(7, 17, 15, 25)),
        ([[10.0, 20.0], [30.0, 5.0]], 1.0, Window(9, 4, 32, 22)),
        ([[0.0, 0.0]], 5.0, Window(0, 0, 6, 6)),
        ([[319.0, 239.0]], 5.0, Window(314, 234, 320, 240)),
        ([[-50.0, 20.0]], 5.0, None),
        ([[400.0, 20.0]], 5.0, None),
    ],
)
def test_around_places(places, reach, expected):
    found = Window.around(places, reach, CAMERA)
    assert found == expected
    if found is not None:
        for u, v in np.clip(places, 0, [319, 239]):
            assert found.left <= u < found.right
            assert found.top <= v < found.bottom


def test_slices_take_what_it_says_and_nothing_of_an_empty_one():
    image = np.arange(240)[:, None] * 1000 + np.arange(320)
    assert image[Window(3, 5, 10, 9).slices].shape == (4, 7)
    assert image[Window(3, 5, 10, 9).slices][0, 0] == 5003
    assert image[Window.whole(CAMERA).slices].shape == (240, 320)
    assert Window(3, 5, 10, 9).shrunk(1) == Window(4, 6, 9, 8)
    assert image[Window(3, 5, 10, 9).shrunk(4).slices].size == 0
    assert Window(3, 5, 10, 9).shrunk(-4).within(CAMERA) == Window(0, 1, 14, 13)
