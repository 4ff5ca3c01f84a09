"""The rim of a hole or boss in an image, all of it, and the diameter of the ellipse that fits it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...sensors import Camera
from .edges import EdgeFinder
from .image_edge import BIAS_PX

__all__ = ["Rim", "find_rim", "rim_points"]

_MOST, _FEWEST = 400, 24  # profiles
_AGREE, _NEAR_PX = 0.5, 1.0  # share of profiles, and how near to the ellipse
_CLEAR, _LARGEST_GAP = 0.3, np.radians(120)  # of the contrast of the clearest; seen from the centre
_FAINT = 0.12  # of the clearest: fainter edge points are moved by the shading beside them, and left out
_SCALES = (60.0, 30.0, 15.0, 8.0, 4.0, 3.0, 3.0, 3.0)  # deviations from which on a point counts as another edge's


@dataclass(frozen=True)
class Rim:
    """An ellipse that was fitted, in mm on the ideal image.

    Parameters
    ----------
    ends
        ``(2, 2)`` mm: of its chord through its centre in the measurand's direction.
    variance_mm2
        Of the chord's length, by the image's noise and :data:`~viewgauge.measurement.image.image_edge.BIAS_PX`.
    width_px
        Of the edge, where it is clear (:class:`~viewgauge.measurement.image.image_edge.ImageEdge`).
    """

    ends: NDArray[np.float64]
    variance_mm2: float
    width_px: float


def rim_points(points: NDArray[np.float64], axis: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """``(count, 3)`` mm: points of the circle of which points ``(2, 3)`` are a diameter, with the axis ``(3,)``."""
    centre, arm = points.mean(axis=0), (points[1] - points[0]) / 2
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)[:, None]
    return np.asarray(centre + np.cos(angle) * arm + np.sin(angle) * np.cross(axis, arm))


def find_rim(
    finder: EdgeFinder, points: NDArray[np.float64], axis: NDArray[np.float64], camera: Camera, reach_px: float
) -> Rim | None:
    """The rim near where it is expected; None where less than most of it is found.

    Edge points along the normals of the expected image, and the ellipse that leaves the least of their distances
    (Sampson's, from its gradient), those that are off by much counting little (Geman and McClure's weights).

    Parameters
    ----------
    points, axis
        ``(2, 3)`` mm and ``(3,)``, camera frame: a diameter, and the normal of its circle.
    """
    around = _image(points, axis, camera, 200)
    count = int(np.clip(np.linalg.norm(np.diff(around, axis=0, append=around[:1]), axis=1).sum(), _FEWEST, _MOST))
    places = _image(points, axis, camera, count)
    found = _edge_points(finder, places, reach_px)
    if found is None:
        return None
    expected, px = camera.from_pixels(places), min(camera.pixel_pitch_mm)
    middle, scale = expected.mean(axis=0), float(np.abs(expected - expected.mean(axis=0)).max())
    p, deviation = (camera.from_pixels(found.places) - middle) / scale, found.deviation_px * px / scale
    conic = nominal = _fitted((expected - middle) / scale, np.ones(count))
    for factor in _SCALES:
        off = np.abs(_distance(conic, p)) / deviation
        conic = _fitted(p, 1 / (deviation * (1 + (off / factor) ** 2)) ** 2, conic)
    near = np.abs(_distance(conic, p)) <= np.maximum(4 * deviation, _NEAR_PX * px / scale)
    if near.sum() < _AGREE * count or not _is_ellipse(conic):
        return None
    clear = near & (found.contrast >= _CLEAR * found.contrast.max())
    if _gap(p[clear] - _centre(conic)) > _LARGEST_GAP:
        return None
    run = np.diff(camera.project(points), axis=0)[0]
    length = np.linalg.norm(run)
    direction = run / length
    # the image of the circle's centre is not the ellipse's: by how much its diameter is less than the chord there
    longer = scale * np.linalg.norm(np.diff(_chord(nominal, direction), axis=0)) / length
    chord = _chord(conic, direction)
    chord = chord.mean(axis=0) + (chord - chord.mean(axis=0)) / longer
    # what is the same all round does not average out, and counts at both ends
    variance = scale**2 * _chord_variance(conic, p[near], deviation[near], direction) + (2 * BIAS_PX * px) ** 2
    return Rim(middle + scale * chord, float(variance), found.width_px)


@dataclass(frozen=True)
class _EdgePoints:
    """k edge points of a rim: places ``(k, 2)`` px, contrasts ``(k,)``, and deviations across the rim ``(k,)`` px."""

    places: NDArray[np.float64]
    contrast: NDArray[np.float64]
    deviation_px: NDArray[np.float64]
    width_px: float


def _edge_points(finder: EdgeFinder, places: NDArray[np.float64], reach_px: float) -> _EdgePoints | None:
    """Edges next to places ``(n, 2)`` px of a closed curve, of the same sign; None where they are too few."""
    across, least = _normals(places), _AGREE * len(places)
    offset, slope = finder.offsets(places, across, reach_px)
    good = np.isfinite(offset)
    if good.sum() < least:
        return None
    slope = np.where(good, slope, 0.0)
    clearest = np.quantile(np.abs(slope), 0.9)
    turned = np.sign(np.median(slope[np.abs(slope) >= clearest / 2]))
    good &= slope * turned >= _FAINT * clearest
    if good.sum() < least:
        return None
    places, across, offset, slope = places[good], across[good], offset[good], slope[good]
    width = _width(finder, places + offset[:, None] * across, across, slope)
    if not np.isfinite(width):
        return None
    sharp = finder.refined(places, across, offset, width)
    kept = np.isfinite(sharp.offset) & (sharp.contrast * turned > _FAINT * np.median(np.abs(sharp.contrast)))
    if kept.sum() < least:
        return None
    contrast = np.abs(sharp.contrast[kept])
    noise = np.array([finder.point_deviation_px(value, width) for value in contrast])
    # what lies beside a faint edge moves it the more, the fainter it is
    deviation = np.hypot(noise, BIAS_PX * (contrast.max() / contrast) ** 2)
    return _EdgePoints((places + sharp.offset[:, None] * across)[kept], contrast, deviation, width)


def _width(
    finder: EdgeFinder, edge_px: NDArray[np.float64], across: NDArray[np.float64], slope: NDArray[np.float64]
) -> float:
    """Of the clearer half of an edge."""
    clear = np.abs(slope) >= np.median(np.abs(slope))
    towards = across * np.sign(slope)[:, None]  # so that all profiles rise
    return finder.width_px(edge_px[clear], towards[clear])


def _image(points: NDArray[np.float64], axis: NDArray[np.float64], camera: Camera, count: int) -> NDArray[np.float64]:
    return camera.to_pixels(camera.project(rim_points(points, axis, count)))


def _normals(places: NDArray[np.float64]) -> NDArray[np.float64]:
    run = np.roll(places, -1, axis=0) - np.roll(places, 1, axis=0)
    across = np.stack([-run[:, 1], run[:, 0]], axis=1)
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))


def _design(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the conic ``a x² + b x y + c y² + d x + e y = 1``."""
    x, y = p.T
    return np.stack([x * x, x * y, y * y, x, y], axis=1)


def _gradient(conic: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d, e = conic
    x, y = p.T
    return np.stack([2 * a * x + b * y + d, b * x + 2 * c * y + e], axis=1)


def _distance(conic: NDArray[np.float64], p: NDArray[np.float64]) -> NDArray[np.float64]:
    slope = np.linalg.norm(_gradient(conic, p), axis=1)
    return np.asarray((_design(p) @ conic - 1) / np.maximum(slope, 1e-12))


def _fitted(
    p: NDArray[np.float64], weight: NDArray[np.float64], conic: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    root = np.sqrt(weight)
    if conic is not None:
        root = root / np.maximum(np.linalg.norm(_gradient(conic, p), axis=1), 1e-6)
    return np.asarray(np.linalg.lstsq(_design(p) * root[:, None], root, rcond=None)[0])


def _is_ellipse(conic: NDArray[np.float64]) -> bool:
    a, b, c, _, _ = conic
    return bool(4 * a * c - b * b > 0 and a > 0)


def _centre(conic: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c, d, e = conic
    return np.asarray(np.linalg.solve(np.array([[2 * a, b], [b, 2 * c]]), [-d, -e]))


def _chord(conic: NDArray[np.float64], direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(2, 2)``: its ends."""
    a, b, c, d, e = conic
    middle, (u, v) = _centre(conic), direction
    level = 1 + (d * middle[0] + e * middle[1]) * -0.5  # of the conic about its centre
    half = np.sqrt(level / (a * u * u + b * u * v + c * v * v))
    return np.stack([middle - half * direction, middle + half * direction])


def _chord_variance(
    conic: NDArray[np.float64], p: NDArray[np.float64], deviation: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """For points whose distances from the conic have so large deviations ``(k,)``."""
    rows = _design(p) / (np.linalg.norm(_gradient(conic, p), axis=1) * deviation)[:, None]
    covariance = np.linalg.inv(rows.T @ rows)

    def length(conic: NDArray[np.float64]) -> float:
        return float(np.linalg.norm(np.diff(_chord(conic, direction), axis=0)))

    step = 1e-6
    slope = np.array([(length(conic + step * e) - length(conic - step * e)) / (2 * step) for e in np.eye(5)])
    return float(slope @ covariance @ slope)


def _gap(p: NDArray[np.float64]) -> float:
    angle = np.sort(np.arctan2(p[:, 1], p[:, 0]))
    return float(np.diff(angle, append=angle[0] + 2 * np.pi).max())
