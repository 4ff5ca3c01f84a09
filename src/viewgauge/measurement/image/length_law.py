"""The law of the error of a length that is measured in an image of known noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...errors import TotalError
from ...evaluation.segment import image_segment
from ...geometry import PoseError, invert, transform
from ...sensors import Camera, EdgeDetector

__all__ = ["length_law"]


def length_law(
    points: NDArray[np.float64],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    pose_error: PoseError,
    deviation_mm: float,
    *,
    whole_pixels: bool,
) -> TotalError:
    """The law of measured less nominal image length, mm on the ideal image, at first order.

    The pose error, the camera's calibration and its edges' offset are as the inspection states them; the location of
    the ends is as the image itself tells it, in place of what an edge detector or quantization step of the inspection
    says.

    Parameters
    ----------
    points
        ``(2, 3)`` mm, part frame: both ends of the measurand.
    T_part_camera
        ``(4, 4)`` mm: the planned viewpoint.
    deviation_mm
        Standard deviation of the length by the image's noise
        (:class:`~viewgauge.measurement.image.measurand_image.MeasurandImage`).
    whole_pixels
        The ends were put to the corners of pixels.
    """
    offset = None if camera.edge_detector is None or whole_pixels else EdgeDetector(0.0, camera.edge_detector.bias_px)
    locating = replace(camera, edge_detector=offset, edge_resolution_px=1.0 if whole_pixels else 0.0)
    start, end = transform(invert(T_part_camera), points)
    image = image_segment(start, end, locating, pose_error)
    sigma = np.hypot(np.hypot(image.sigma_displacement_mm, image.sigma_camera_mm), deviation_mm)
    return TotalError.of_half_widths(sigma, image.camera.half_widths_mm)
