"""Images of a part only where they are looked at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..sensors import Camera, Window
from .image_sensor import ImageSensor
from .renderer import Renderer

__all__ = ["partial_image"]


def partial_image(
    renderer: Renderer,
    sensor: ImageSensor,
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    windows: Sequence[Window],
    rng: np.random.Generator,
) -> NDArray[np.uint16]:
    """``(rows, columns)`` grey values: in the windows those of the whole image, but for other noise; elsewhere 0."""
    columns, rows = camera.resolution
    grey = np.zeros((rows, columns), dtype=np.uint16)
    light_of = renderer.coverage if sensor.black_and_white else renderer.radiance
    for window in windows:
        wider = window.shrunk(-sensor.margin_px).within(camera)
        values = sensor.grey(light_of(T_part_camera, camera, wider), rng)
        top, left = window.top - wider.top, window.left - wider.left
        height, width = window.bottom - window.top, window.right - window.left
        grey[window.slices] = values[top : top + height, left : left + width]
    return grey
