"""What hardly any calibration has: a principal point far off, a field of view of other units, a lens turning back."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ....findings import Finding
from ....geometry import Lens
from .lens_reach import corner_distance, lens_reach

__all__ = ["implausible_calibration"]

_OFF_MIDDLE = 0.1  # of the width or the height
_AT_THE_EDGE = 0.4
_SHAPE = 0.05  # how far fx and fy may differ
_WIDEST_PINHOLE_RAD, _WIDEST_FISHEYE_RAD = math.radians(150.0), math.radians(240.0)
_NARROWEST_RAD = math.radians(0.5)
_LEAST_SHARE = 0.7  # of the distance to the corner that a lens must be usable for
_LARGEST_TANGENTIAL = 0.01
_SENSOR_MM = 60.0  # no principal point in mm is farther from the sensor's corner

_STANDARD_SIZES = (
    *((320, 240), (640, 480), (752, 480), (800, 600), (1024, 768), (1280, 720), (1280, 800), (1280, 960), (1280, 1024)),
    *((1440, 1080), (1600, 1200), (1920, 1080), (1920, 1200), (2048, 1536), (2048, 2048), (2448, 2048), (2560, 1440)),
    *((2592, 1944), (3840, 2160), (4000, 3000), (4096, 3000), (4096, 2160), (5472, 3648), (3088, 2064), (4024, 3036)),
)


def implausible_calibration(
    focal_length_px: tuple[float, float],
    principal_point_px: tuple[float, float],
    lens: Lens | None,
    resolution: tuple[int, int] | None,
    where: str,
) -> Iterator[Finding]:
    """Every finding of a calibration, of the whole image.

    Parameters
    ----------
    resolution
        Columns and rows; None where they are not known, and the image is taken to lie around the principal point.
    where
        File and camera, for messages.
    """
    size = resolution or _around(principal_point_px)
    if size is None:
        yield _far_off(principal_point_px, where)
        return
    field = list(_field(focal_length_px, principal_point_px, lens, size, where))
    yield from field
    if not field:  # else the principal point follows from the same cause
        if resolution is not None:
            yield from _principal_point(principal_point_px, resolution, where)
        yield from _turns_back(focal_length_px, principal_point_px, lens, size, where)
    yield from _shape(focal_length_px, where)
    yield from _tangential(lens, where)


def _around(centre: tuple[float, float]) -> tuple[int, int] | None:
    columns, rows = (round(2 * c + 1) for c in centre)
    return (columns, rows) if columns >= 1 and rows >= 1 else None


def _far_off(centre: tuple[float, float], where: str) -> Finding:
    return Finding(
        "principal_point",
        f"the principal point ({centre[0]:.4g}, {centre[1]:.4g}) lies at the first pixel or outside the image",
        "near the middle of the image",
        "the matrix is transposed, or the principal point is counted from the middle of the image",
        where,
        refused=True,
    )


def _principal_point(centre: tuple[float, float], size: tuple[int, int], where: str) -> Iterator[Finding]:
    off = [(c - (n - 1) / 2) / n for c, n in zip(centre, size, strict=True)]
    axis = 0 if abs(off[0]) >= abs(off[1]) else 1
    if abs(off[axis]) <= _OFF_MIDDLE:
        return
    side = ("width", "height")[axis]
    yield Finding(
        "principal_point",
        f"the principal point ({centre[0]:.1f}, {centre[1]:.1f}) lies {abs(off[axis]) * size[axis]:.0f} px "
        f"({abs(off[axis]):.0%} of the {side}) from the middle of the image of {size[0]} x {size[1]} px",
        f"at most {_OFF_MIDDLE:.0%}",
        _cause_of_centre(centre, size),
        where,
        refused=abs(off[axis]) > _AT_THE_EDGE,
    )


def _cause_of_centre(centre: tuple[float, float], size: tuple[int, int]) -> str:
    columns, rows = size
    if columns != rows and _fits(centre, (rows, columns)):
        return f"width and height are exchanged: it fits an image of {rows} x {columns} px"
    if max(abs(centre[0]), abs(centre[1])) < 0.02 * min(size) or (
        abs(centre[0]) < 0.1 * columns and abs(centre[1]) < 0.1 * rows
    ):
        return "it is counted from the middle of the image, or in mm"
    factors = [(2 * c + 1) / n for c, n in zip(centre, size, strict=True)]
    if min(factors) > 0 and abs(factors[0] / factors[1] - 1) < 0.15:
        near = min(_STANDARD_SIZES, key=lambda s: _distance(centre, s))
        likely = near if _fits(centre, near, 0.06) else (round(2 * centre[0] + 1), round(2 * centre[1] + 1))
        return f"the calibration is of images of another size, such as {likely[0]} x {likely[1]} px"
    return "a region of a larger image, or a calibration that did not succeed"


def _distance(centre: tuple[float, float], size: tuple[int, int]) -> float:
    return max(abs(c - (n - 1) / 2) / n for c, n in zip(centre, size, strict=True))


def _fits(centre: tuple[float, float], size: tuple[int, int], share: float = _OFF_MIDDLE) -> bool:
    return _distance(centre, size) <= share


def _field(
    focal: tuple[float, float],
    centre: tuple[float, float],
    lens: Lens | None,
    size: tuple[int, int],
    where: str,
) -> Iterator[Finding]:
    fisheye = lens is not None and lens.model == "equidistant"
    share = max(n / 2 / f for n, f in zip(size, focal, strict=True))
    angle = 2 * share if fisheye else 2 * math.atan(share)
    widest = _WIDEST_FISHEYE_RAD if fisheye else _WIDEST_PINHOLE_RAD
    if _NARROWEST_RAD <= angle <= widest:
        return
    degrees = math.degrees(angle)
    if angle > widest:
        in_mm = max(abs(c) for c in centre) < _SENSOR_MM and min(size) > 4 * _SENSOR_MM
        cause = "the matrix is in mm, not in px" if in_mm or focal[0] < _SENSOR_MM else "fx is of a smaller image"
        if not fisheye and not in_mm and focal[0] >= _SENSOR_MM:
            cause += ", or the lens is a fisheye"
    else:
        cause = "fx is in another unit than px, or of a larger image"
    yield Finding(
        "field_of_view",
        f"fx {focal[0]:.4g} px and an image of {size[0]} x {size[1]} px are a field of view of {degrees:.4g} deg",
        f"{math.degrees(_NARROWEST_RAD):g} to {math.degrees(widest):.0f} deg",
        cause,
        where,
        refused=True,
    )


def _turns_back(
    focal: tuple[float, float],
    centre: tuple[float, float],
    lens: Lens | None,
    size: tuple[int, int],
    where: str,
) -> Iterator[Finding]:
    reach = lens_reach(lens, corner_distance(focal, centre, size))
    if reach.share == 1:
        return
    radius_px = reach.turns_back_at * sum(focal) / 2
    yield Finding(
        "lens_turns_back",
        f"the lens turns back {radius_px:.0f} px from the principal point, {reach.share:.1%} of the distance to the "
        "farthest corner: beyond, the image cannot be used",
        "a lens that reaches the corners",
        "coefficients of another model or in another order"
        if reach.share < _LEAST_SHARE and lens is not None and lens.model != "equidistant"
        else "the calibration's points did not reach the corners",
        where,
        refused=reach.share < _LEAST_SHARE and lens is not None and lens.model != "equidistant",
    )


def _shape(focal: tuple[float, float], where: str) -> Iterator[Finding]:
    ratio = focal[0] / focal[1]
    if abs(math.log(ratio)) <= _SHAPE:
        return
    aspects = {"4:3": 4 / 3, "16:9": 16 / 9, "16:10": 1.6, "2:1": 2.0, "3:2": 1.5}
    near = next((name for name, a in aspects.items() if min(abs(ratio * a - 1), abs(ratio / a - 1)) < 0.03), None)
    cause = f"the image was stretched, or a value is in parts of sides of {near}" if near else "the image was stretched"
    if not 0.2 < ratio < 5:
        cause = "the numbers are in another order than fx, fy, cx, cy"
    yield Finding(
        "focal_length_ratio",
        f"fx {focal[0]:.5g} px and fy {focal[1]:.5g} px differ by {abs(ratio - 1):.0%}",
        f"at most {_SHAPE:.0%}, of square pixels",
        cause,
        where,
    )


def _tangential(lens: Lens | None, where: str) -> Iterator[Finding]:
    if lens is None or lens.model != "radial-tangential":
        return
    largest = max(abs(lens.coefficients[2]), abs(lens.coefficients[3]))
    if largest >= _LARGEST_TANGENTIAL:
        yield Finding(
            "tangential_distortion",
            f"the tangential coefficients are {lens.coefficients[2]:.3g} and {lens.coefficients[3]:.3g}",
            f"below {_LARGEST_TANGENTIAL:g}",
            "the coefficients are in another order (k1, k2, k3, p1, p2), or of a fisheye",
            where,
        )
