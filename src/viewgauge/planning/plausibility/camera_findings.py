"""What is implausible in a camera: its sensor, its lens, and how it is focused."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...findings import Finding
from ...sensors import Camera
from .usual_range import UsualRange

__all__ = ["camera_findings"]

_PITCH = UsualRange(
    "pixel_pitch",
    "the width of a pixel",
    0.0005,
    0.1,
    "um",
    1e3,
    "a pitch in mm written as um, or in um as nm",
    "a pitch in um written as mm, or the sensor's width in place of the pixel's",
)
_FOCAL_LENGTH = UsualRange(
    "focal_length",
    "the focal length",
    0.5,
    3000.0,
    "mm",
    1.0,
    "a focal length in m written as mm",
    "a focal length in um or in px written as mm",
)
_SENSOR = UsualRange(
    "sensor_size",
    "the sensor's diagonal",
    0.5,
    150.0,
    "mm",
    1.0,
    "the pixel pitch has another unit, or the resolution is that of a part of the image",
    "the pixel pitch has another unit, or the resolution is in subpixels",
)
_FIELD = UsualRange(
    "field_of_view",
    "the field of view over the image's diagonal",
    math.radians(0.5),
    math.radians(160.0),
    "deg",
    math.degrees(1.0),
    "focal length and pixel pitch are in different units",
    "the focal length is in mm where pixels were meant, or in m, or the pixel pitch is too large",
)
_F_NUMBER = UsualRange(
    "f_number",
    "the f-number",
    0.7,
    64.0,
    "",
    1.0,
    "the aperture's width as a share of the focal length, in place of its inverse",
    "the aperture in another measure",
)
_FEWEST_LINES = 16
_SHAPE = 20  # most columns for a row, or rows for a column
_OFF_MIDDLE = 0.1  # of the image's width
_LEAST_FOCUS = 2.0  # focal lengths: an image as large as the object
_LARGEST_DETECTOR_PX = 5.0
_LARGEST_BLUR_PX = 20.0


def camera_findings(camera: Camera) -> Iterator[Finding]:
    """Every finding of a camera by itself."""
    columns, rows = camera.resolution
    yield from _lines(columns, rows)
    for pitch in dict.fromkeys(camera.pixel_pitch_mm):
        yield from _PITCH.judge(pitch, "camera.pixel_pitch")
    width, height = camera.pixel_pitch_mm
    if max(width, height) > 1.5 * min(width, height):
        yield Finding(
            "pixel_shape",
            f"the pixels are {1e3 * width:.4g} x {1e3 * height:.4g} um",
            "square pixels",
            "two units, or the pitch of another direction",
            "camera.pixel_pitch",
        )
    diagonal_mm = math.hypot(columns * width, rows * height)
    yield from _SENSOR.judge(diagonal_mm, "camera.resolution", more=f" ({columns} x {rows} pixels)")
    yield from _FOCAL_LENGTH.judge(camera.focal_length_mm, "camera.focal_length")
    if camera.lens is None or camera.lens.model == "radial-tangential":
        field = 2 * math.atan(diagonal_mm / 2 / camera.focal_length_mm)
        focal_px = camera.focal_length_mm / width
        yield from _FIELD.judge(field, "camera.focal_length", more=f" (focal length {focal_px:.4g} px)")
    yield from _principal_point(camera)
    yield from _focus(camera)
    yield from _edge_detector(camera)


def _lines(columns: int, rows: int) -> Iterator[Finding]:
    if min(columns, rows) < _FEWEST_LINES:
        lines = "one line" if min(columns, rows) == 1 else f"{min(columns, rows)} lines"
        yield Finding(
            "line_scan",
            f"{columns} x {rows} pixels are {lines} and no picture",
            "hundreds of rows and columns",
            "a line-scan camera, which is not modelled: its image is put together while the part moves, and the error "
            "of that movement is not in the prediction",
            "camera.resolution",
            refused=True,
        )
    elif max(columns, rows) > _SHAPE * min(columns, rows):
        yield Finding(
            "image_shape", f"the image is {columns} x {rows} px", f"at most {_SHAPE} : 1", "", "camera.resolution"
        )


def _principal_point(camera: Camera) -> Iterator[Finding]:
    if camera.principal_point_px is None:
        return
    size = np.array(camera.resolution, dtype=float)
    off = np.array(camera.principal_point_px) - (size - 1) / 2
    axis = int(np.argmax(np.abs(off) / size))
    if abs(off[axis]) > _OFF_MIDDLE * size[axis]:
        yield Finding(
            "principal_point",
            f"the principal point lies {abs(off[axis]):.0f} px ({abs(off[axis]) / size[axis]:.0%} of the "
            f"{'height' if axis else 'width'}) from the middle of the image",
            f"at most {_OFF_MIDDLE:.0%}",
            "the calibration is of images of another size, or width and height are exchanged",
            "camera.principal_point",
        )


def _focus(camera: Camera) -> Iterator[Finding]:
    if camera.f_number is not None:
        yield from _F_NUMBER.judge(camera.f_number, "camera.f_number")
    focus, focal_length = camera.focus_distance_mm, camera.focal_length_mm
    if focus is not None and focus < _LEAST_FOCUS * focal_length:
        yield Finding(
            "focus_distance",
            f"the focus distance is {focus:.4g} mm, {focus / focal_length:.3g} times the focal length: images are "
            "larger than what they show",
            f"at least {_LEAST_FOCUS:g} times the focal length",
            "a focus distance in cm or m, or measured from the front of the lens",
            "camera.focus_distance",
        )
    if camera.blur_limit_px > _LARGEST_BLUR_PX:
        yield Finding(
            "blur_limit",
            f"a circle of confusion of {camera.blur_limit_px:.4g} px counts as in focus",
            f"at most {_LARGEST_BLUR_PX:g} px",
            where="camera.blur_limit",
        )


def _edge_detector(camera: Camera) -> Iterator[Finding]:
    detector, where = camera.edge_detector, "camera.edge_detector"
    noise = camera.edge_resolution_px if detector is None else detector.noise_px
    what = "quantization step" if detector is None else "noise of an edge point"
    if noise == 0 and (detector is None or detector.bias_px == 0):
        yield Finding(
            "edge_detector",
            f"the {what} is 0: edges are located exactly",
            "0.02 to 1 px",
            "a value that was left to be filled in",
            where,
        )
    elif noise > _LARGEST_DETECTOR_PX or 0 < noise < 1e-3:
        yield Finding("edge_detector", f"the {what} is {noise:.4g} px", "0.02 to 1 px", "a length in um or mm", where)
