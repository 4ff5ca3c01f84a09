"""The length of a gauge in an image: its ends where fitted edges cross its line, or a diameter of a fitted rim.

Edges are looked for in the pixels; what is found is put where a pinhole camera would have seen it, by the calibration.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..geometry import Camera, PoseError, Window, invert, point_jacobian, transform
from .edges import SPLINE_MARGIN_PX, Edge, EdgeFinder
from .rim import find_rim, rim_points

__all__ = [
    "EndPoint",
    "ExpectedGauge",
    "GaugeImage",
    "Guide",
    "find_guide",
    "gauge_windows",
    "measure_gauge",
    "rehearsed",
]

_CROSSES = np.sin(np.radians(20))  # of the angle between an edge and the gauge
_LIES_ALONG = np.sin(np.radians(8))
_HALF_PX, _CLEAR_OF_CORNER_PX = 9.0, 5.0
_THROUGH = np.arange(-_HALF_PX, _HALF_PX + 1)
_AFTER_CORNER = np.arange(_CLEAR_OF_CORNER_PX, 2 * _HALF_PX + 1)
_AT_CORNER = (_AFTER_CORNER, -_AFTER_CORNER)
_ON_EDGE = (_THROUGH, *_AT_CORNER)  # on one side alone, where a corner or another edge is near
_PIECES, _PIECE_PX = 6, 5.0  # of an edge along which a gauge lies, and half the length of each
_FEWEST_EDGES, _FEWEST_AGREE, _AGREE_PX = 6, 0.4, 1.5
_SCALES = (80.0, 40.0, 20.0, 10.0, 5.0, 3.0, 3.0, 3.0, 3.0, 3.0)
_DISAGREE, _DISAGREE_PX = 3.5, 0.03  # standard deviations, and beyond, that edges may miss their common point by
_TRUSTED_PX = 0.08  # that an edge may miss its corner by in an image without noise
_SIGMAS = 4.0  # of the displacement of an end that an edge is looked for within
_FURTHER_PX = 2.0
_BLUNT_PX = 1.9  # width of an edge that is out of focus: of a blur of 2.5 px
_CURVATURES = 0.35  # relative difference
_SATURATED = 0.995
_TOO_SATURATED = 0.02  # share of the pixels about an end


@dataclass(frozen=True)
class ExpectedGauge:
    """A gauge, part frame.

    Parameters
    ----------
    points
        ``(2, 3)`` mm.
    normals
        Of the faces that meet at each, ``(k, 3)``.
    bent
        Its edges are curves, such as the rim of a hole.
    rim_axis
        ``(3,)``: normal of the circle of which it is a diameter, where the whole rim is seen; None for any other.
    trusted
        Of each end the edges to look for, by direction and place along it; None for all (:func:`rehearsed`).
    """

    points: NDArray[np.float64]
    normals: tuple[NDArray[np.float64], NDArray[np.float64]]
    bent: bool = False
    rim_axis: NDArray[np.float64] | None = None
    trusted: tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]] | None = None

    def directions(self, k: int, T_camera_part: NDArray[np.float64], camera: Camera) -> list[_Direction]:
        """The edges to look for at end k, in the image from a pose."""
        point = transform(T_camera_part, self.points[k])
        found = image_directions(point, T_camera_part[:3, :3], self.normals[k], camera)
        if self.trusted is None:
            return found
        kept = [tuple(s for j, s in enumerate(d.spans) if (i, j) in self.trusted[k]) for i, d in enumerate(found)]
        return [replace(d, spans=spans) for d, spans in zip(found, kept, strict=True) if spans]


@dataclass(frozen=True)
class EndPoint:
    """An end of a gauge in an image.

    Parameters
    ----------
    expected, found
        ``(2,)`` px; ``found`` None with the ``reason`` it was not.
    deviation_px
        Standard deviation of the found place along the gauge, by the image's noise.
    slide
        How far it goes along the gauge where the gauge's line goes across itself by one.
    """

    expected: NDArray[np.float64]
    found: NDArray[np.float64] | None
    edge: Edge | None
    reason: str = ""
    deviation_px: float = 0.0
    slide: float = 0.0


@dataclass(frozen=True)
class GaugeImage:
    """Both ends, and the image length, nominal and measured, mm on the ideal image; None where an end is not found.

    ``deviation_mm`` is the standard deviation that the image's noise gives it.
    """

    ends: tuple[EndPoint, EndPoint]
    nominal_mm: float
    measured_mm: float | None
    deviation_mm: float = 0.0

    def length_mm(self, camera: Camera, whole_pixels: bool) -> float | None:
        """The measured length; with ``whole_pixels`` of ends that are put to the nearest corner of pixels.

        That is the paper's locator: an end is where pixels meet, and as far from there as it may be.
        """
        start, end = (found.found for found in self.ends)
        if not whole_pixels or start is None or end is None:
            return self.measured_mm
        corners = np.floor(np.stack([start, end])) + 0.5
        return float(np.linalg.norm(np.diff(camera.from_pixels(corners), axis=0)))

    @property
    def reason(self) -> str:
        """Why there is no length; empty where there is one."""
        start, end = (found.reason for found in self.ends)
        if start == end:
            return start
        return "; ".join(f"{name}: {why}" for name, why in (("start", start), ("end", end)) if why)


@dataclass(frozen=True)
class Guide:
    """From about where an image was taken.

    Parameters
    ----------
    reach_px
        How far off edges may still be.
    covariance
        ``(6, 6)`` of the pose, as a displacement of the scene in the camera frame, mm and rad.
    """

    T_part_camera: NDArray[np.float64]
    reach_px: float
    covariance: NDArray[np.float64]


def measure_gauge(
    finder: EdgeFinder,
    image: NDArray[np.float64],
    gauge: ExpectedGauge,
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    guide: Guide,
) -> GaugeImage:
    """The length of a gauge in an image that was taken at a pose but for the head's error.

    Each end is where an edge that crosses the gauge, fitted near where the guide expects it, meets the gauge's line:
    the expected line through both, or the fitted edge along which the gauge lies. A diameter whose whole rim is seen
    is that of the ellipse which fits the rim. The guide says where to look and where the expected line is; the length
    is compared with that at the pose that was planned.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale; those of the finder.
    """
    nominal = float(np.linalg.norm(np.diff(camera.project(transform(invert(T_part_camera), gauge.points)), axis=0)))
    T_camera_part = invert(guide.T_part_camera)
    points = transform(T_camera_part, gauge.points)
    places = camera.to_pixels(camera.project(points))
    if gauge.rim_axis is not None:
        ends, deviation = _rim_ends(finder, image, points, T_camera_part[:3, :3] @ gauge.rim_axis, camera, guide)
    else:
        line = _gauge_line(finder, gauge, T_camera_part, camera, guide)
        first, second = (
            _end(finder, image, gauge, k, places[k], T_camera_part, camera, line, guide.reach_px) for k in range(2)
        )
        if gauge.bent and first.edge is not None and second.edge is not None:
            first, second = (_of_one_rim(end, first.edge, second.edge) for end in (first, second))
        ends, deviation = (first, second), 0.0
    start, end = ends
    if start.found is None or end.found is None:
        return GaugeImage(ends, nominal, None)
    found = camera.from_pixels(np.stack([start.found, end.found]))
    if gauge.rim_axis is None:
        per_px = _mm_per_px(camera, found)
        slides = np.array([start.slide, -end.slide])
        variance = ((np.array([start.deviation_px, end.deviation_px]) * per_px) ** 2).sum()
        deviation = float(np.sqrt(variance + slides @ line.covariance_mm2 @ slides))
    return GaugeImage(ends, nominal, float(np.linalg.norm(found[1] - found[0])), deviation)


def _mm_per_px(camera: Camera, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(2,)``: along the line between two ideal image points, at each."""
    run = (found[1] - found[0]) / np.linalg.norm(found[1] - found[0])
    return np.asarray(1 / np.linalg.norm(camera.pixel_jacobian(found) @ run, axis=1))


def gauge_windows(
    gauge: ExpectedGauge, T_part_camera: NDArray[np.float64], camera: Camera, error: PoseError
) -> list[Window]:
    """All of an image that is looked at to measure a gauge at a planned pose, and to find where it was taken."""
    T_camera_part = invert(T_part_camera)
    points = transform(T_camera_part, gauge.points)
    places = camera.to_pixels(camera.project(points))
    reach = max(_reach_px(point, camera, error.camera_covariance) for point in points)
    margin = reach + _AGREE_PX * 3 + _FURTHER_PX + 4 + SPLINE_MARGIN_PX
    if gauge.rim_axis is not None:
        rim = rim_points(points, T_camera_part[:3, :3] @ gauge.rim_axis, 90)
        found = [Window.around(camera.to_pixels(camera.project(rim)), margin + 2 * _HALF_PX, camera)]
    else:
        found = [Window.around(place, margin + 2 * _HALF_PX, camera) for place in places]
        if _lies_along(gauge, T_camera_part, camera):
            middles = camera.to_pixels(_pieces(camera, points))
            found += [Window.around(middle, margin + _PIECE_PX, camera) for middle in middles]
    return [window for window in found if window is not None]


def rehearsed(
    finder: EdgeFinder, gauge: ExpectedGauge, T_part_camera: NDArray[np.float64], camera: Camera
) -> ExpectedGauge:
    """The gauge with those edges trusted that are where they should be in an image without noise or displacement.

    What lies beside an edge in the image, such as the other edge of a narrow face, moves it by tenths of a pixel; a
    noisy image does not tell. Where no edge that crosses the gauge at an end is right, all of them stay.

    Parameters
    ----------
    finder
        Of a rendered image of the part from that pose.
    """
    T_camera_part = invert(T_part_camera)
    places = camera.to_pixels(camera.project(transform(T_camera_part, gauge.points)))
    run = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
    trusted = []
    for k, place in enumerate(places):
        directions = gauge.directions(k, T_camera_part, camera)
        every = [(i, j) for i, direction in enumerate(directions) for j in range(len(direction.spans))]
        right = []
        for i, j in every:
            direction = directions[i]
            edge = finder.edge(place, direction.unit, direction.spans[j], _FURTHER_PX, gauge.bent)
            if edge is not None and abs(edge.coefficients[0]) <= _TRUSTED_PX:
                right.append((i, j))
        crosses = any(_sine(directions[i].unit, run) >= _CROSSES for i, _ in right)
        trusted.append(frozenset(right if crosses else every))
    return replace(gauge, trusted=(trusted[0], trusted[1]))


def find_guide(
    finder: EdgeFinder,
    gauges: Sequence[ExpectedGauge],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
) -> Guide | None:
    """From about where an image was taken, by all edges at the ends of gauges; None where they do not agree.

    The pose error of the greatest posterior density for the head's normal law and edges that are off by their noise or
    are others altogether (Cauchy). Of a part that shows too few edges to tell whether they agree, the pose by those
    that are found, looked for once more from there.
    """
    if not gauges:
        return None
    points = [transform(invert(T_part_camera), point) for gauge in gauges for point in gauge.points]
    reaches = [_reach_px(point, camera, error.camera_covariance) for point in points]
    found = _edges_near(finder, gauges, T_part_camera, camera, error, reaches)
    looked_for = sum(
        len(image_directions(point, T_part_camera[:3, :3].T, normals, camera))
        for point, normals in zip(points, [n for gauge in gauges for n in gauge.normals], strict=True)
    )
    to_camera = error.adjoint @ error.factor
    if looked_for >= 2 * _FEWEST_EDGES:
        if len(found.offset) < _FEWEST_EDGES:
            return None
        twist, posterior = _pose_of(found, error)
        left = np.abs(found.offset - found.rows @ twist)
        agree = left < _AGREE_PX
        if agree.sum() < max(_FEWEST_EDGES, _FEWEST_AGREE * len(left)):
            return None
        reach = float(3 * np.median(left[agree]) + _FURTHER_PX)
    else:
        twist, posterior = _pose_of(found, error)
        spread = to_camera @ posterior @ to_camera.T
        nearer = [_reach_px(point, camera, spread) for point in points]
        again = _edges_near(finder, gauges, _moved(T_part_camera, twist, error), camera, error, nearer)
        twist, posterior = _pose_of(replace(again, offset=again.offset + again.rows @ twist), error)
        spread = to_camera @ posterior @ to_camera.T
        reach = max(_reach_px(point, camera, spread) for point in points)
    return Guide(_moved(T_part_camera, twist, error), reach, to_camera @ posterior @ to_camera.T)


@dataclass(frozen=True)
class _Found:
    """Of n edges how far off they are, px ``(n,)``, with variance, and by how much for each unit of pose ``(n, 6)``."""

    offset: NDArray[np.float64]
    variance: NDArray[np.float64]
    rows: NDArray[np.float64]


def _edges_near(
    finder: EdgeFinder,
    gauges: Sequence[ExpectedGauge],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    reaches: Sequence[float],
) -> _Found:
    """Edges at the ends of gauges, looked for within the reach of each end of where a pose has them."""
    T_camera_part = invert(T_part_camera)
    offsets, variances, rows = [], [], []
    ends = [(gauge, k) for gauge in gauges for k in range(2)]
    for (gauge, k), reach in zip(ends, reaches, strict=True):
        point = transform(T_camera_part, gauge.points[k])
        place = camera.to_pixels(camera.project(point))
        J = _point_jacobian_px(point, camera) @ error.adjoint
        for along in gauge.directions(k, T_camera_part, camera):
            for span in along.spans:
                edge = finder.edge(place, along.unit, span, reach, gauge.bent)
                if edge is not None:
                    middle = (span[0] + span[-1]) / 2
                    a, b, c = edge.coefficients
                    offsets.append(a + b * middle + c * middle**2)
                    variances.append(edge.variance_at(place + middle * along.unit))
                    rows.append(edge.across @ J)
                    if along.through:
                        break
    return _Found(np.array(offsets), np.array(variances), np.array(rows).reshape(-1, 6))


def _pose_of(found: _Found, error: PoseError) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The pose error ``(6,)``, head frame, and its covariance ``(6, 6)`` in units of the head's factor."""
    A, y, variance, factor = found.rows, found.offset, found.variance, error.factor
    scaled, twist = A @ factor, np.zeros(6)
    posterior: NDArray[np.float64] = np.eye(6, dtype=np.float64)
    for scale in _SCALES:  # of standard deviations, from which on an edge counts as another
        weight = 1 / (variance * (1 + (y - A @ twist) ** 2 / (scale**2 * variance)))
        posterior = np.asarray(np.linalg.inv(scaled.T @ (weight[:, None] * scaled) + np.eye(6)))
        twist = factor @ (posterior @ (scaled.T @ (weight * y)))
    return twist, posterior


def _moved(T_part_camera: NDArray[np.float64], twist: NDArray[np.float64], error: PoseError) -> NDArray[np.float64]:
    """``T_part_camera`` of a camera whose head has a pose error."""
    displacement = np.eye(4)
    displacement[:3, :3], displacement[:3, 3] = Rotation.from_rotvec(twist[3:]).as_matrix(), twist[:3]
    assert error.T_camera_head is not None  # set by PoseError
    seen = error.T_camera_head @ displacement @ invert(error.T_camera_head) @ invert(T_part_camera)
    return np.asarray(invert(seen))


def _point_jacobian_px(point: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    """``(2, 6)`` px of a displacement of a point in the camera frame."""
    return np.asarray(camera.pixel_jacobian(camera.project(point)) @ point_jacobian(point, camera.focal_length_mm))


def _reach_px(point: NDArray[np.float64], camera: Camera, covariance: NDArray[np.float64]) -> float:
    """How far an end may be from where it is expected, for a covariance ``(6, 6)`` of the pose, camera frame."""
    J = _point_jacobian_px(point, camera)
    spread = J @ covariance @ J.T
    return float(_SIGMAS * np.sqrt(np.linalg.eigvalsh(spread)[-1]) + _FURTHER_PX)


def image_directions(
    point: NDArray[np.float64], R_camera_part: NDArray[np.float64], normals: NDArray[np.float64], camera: Camera
) -> list[_Direction]:
    """The edges in which the faces at a point meet, two and two, as directions in the image.

    Where only two faces meet the edge goes through the point. At a corner it is on one side alone: of a convex corner
    on that side from which the other faces fall away, which is tried first.
    """
    found = []
    turned = normals @ R_camera_part.T
    for i, j in itertools.combinations(range(len(turned)), 2):
        edge = np.cross(turned[i], turned[j])
        if np.linalg.norm(edge) < 1e-6:
            continue
        others = [float(edge @ turned[k]) for k in range(len(turned)) if k not in (i, j)]
        leaning = next((value for value in others if abs(value) > 1e-6), 0.0)
        edge *= -np.sign(leaning) if leaning else 1.0
        step = 1e-3 * edge / np.linalg.norm(edge)
        image = camera.to_pixels(camera.project(np.stack([point - step, point + step])))
        run = image[1] - image[0]
        if np.linalg.norm(run) > 0:
            spans = _AT_CORNER if leaning else _ON_EDGE
            found.append(_Direction(run / np.linalg.norm(run), spans, through=not leaning))
    return found


@dataclass(frozen=True)
class _Direction:
    """Of an edge in the image, ``(2,)`` unit, and where along it to look, px, in this order.

    ``through``: it goes on to both sides of the point.
    """

    unit: NDArray[np.float64]
    spans: tuple[NDArray[np.float64], ...]
    through: bool


@dataclass(frozen=True)
class _Line:
    """Of a gauge, mm on the ideal image: two points ``(2, 2)``, and their covariance ``(2, 2)`` across it, mm²."""

    points: NDArray[np.float64]
    covariance_mm2: NDArray[np.float64]

    def near(self, end: int, camera: Camera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A point and the direction, unit, in the pixels, next to one of its points."""
        run = (self.points[1] - self.points[0]) * (1e-3 if end == 0 else -1e-3)
        start, beyond = camera.to_pixels(np.stack([self.points[end], self.points[end] + run]))
        direction = (beyond - start) * (1 if end == 0 else -1)
        return start, direction / np.linalg.norm(direction)


def _sine(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(abs(a[0] * b[1] - a[1] * b[0]))


def _of_one_rim(end: EndPoint, first: Edge, second: Edge) -> EndPoint:
    """An end, without what was found if the curvatures at the ends of a diameter, equal on an ellipse, differ."""
    a, b = first.coefficients[2], second.coefficients[2]
    if abs(a - b) <= _CURVATURES * max(abs(a), abs(b)):
        return end
    return EndPoint(end.expected, None, end.edge, "what is found is not the rim at both ends: it is bent differently")


def _rim_ends(
    finder: EdgeFinder,
    image: NDArray[np.float64],
    points: NDArray[np.float64],
    axis: NDArray[np.float64],
    camera: Camera,
    guide: Guide,
) -> tuple[tuple[EndPoint, EndPoint], float]:
    """The ends of the diameter of a fitted rim, and the standard deviation of its length, mm."""
    places = camera.to_pixels(camera.project(points))

    def not_found(reason: str) -> tuple[tuple[EndPoint, EndPoint], float]:
        return (EndPoint(places[0], None, None, reason), EndPoint(places[1], None, None, reason)), 0.0

    around = camera.to_pixels(camera.project(rim_points(points, axis, 90)))
    window = Window.around(around, guide.reach_px, camera)
    rows, columns = image.shape
    reach = guide.reach_px
    if window is None or (around < reach).any() or (around > np.array([columns, rows]) - 1 - reach).any():
        return not_found("too near the image's border")
    if (image[window.slices] >= _SATURATED).mean() > _TOO_SATURATED:
        return not_found("saturated")
    rim = find_rim(finder, points, axis, camera, guide.reach_px)
    if rim is None:
        return not_found("no clear rim")
    if rim.width_px > _BLUNT_PX:
        return not_found(_out_of_focus(rim.width_px))
    found = camera.to_pixels(rim.ends)
    return (EndPoint(places[0], found[0], None), EndPoint(places[1], found[1], None)), float(np.sqrt(rim.variance_mm2))


def _out_of_focus(width_px: float) -> str:
    return f"out of focus: the edge is {width_px:.1f} px wide"


def _lies_along(gauge: ExpectedGauge, T_camera_part: NDArray[np.float64], camera: Camera) -> bool:
    """Whether a gauge lies along an edge, from end to end."""
    points = transform(T_camera_part, gauge.points)
    places = camera.to_pixels(camera.project(points))
    length = float(np.linalg.norm(places[1] - places[0]))
    if length < 2 * (2 * _CLEAR_OF_CORNER_PX + _PIECE_PX):
        return False
    line = _Line(camera.project(points), np.zeros((2, 2)))
    return all(
        any(
            _sine(d.unit, line.near(k, camera)[1]) < _LIES_ALONG
            for d in image_directions(points[k], T_camera_part[:3, :3], gauge.normals[k], camera)
        )
        for k in range(2)
    )


def _pieces(camera: Camera, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(k, 2)`` mm on the ideal image: places along a gauge's image, clear of its ends."""
    start, end = camera.project(points)
    length = float(np.linalg.norm(np.diff(camera.to_pixels(np.stack([start, end])), axis=0)))
    clear = (2 * _CLEAR_OF_CORNER_PX + _PIECE_PX) / length
    return np.asarray(start + np.linspace(clear, 1 - clear, _PIECES)[:, None] * (end - start))


def _gauge_line(
    finder: EdgeFinder, gauge: ExpectedGauge, T_camera_part: NDArray[np.float64], camera: Camera, guide: Guide
) -> _Line:
    """The ends' line: of the edge along which the gauge lies, if it does, else through the ends as expected."""
    points = transform(T_camera_part, gauge.points)
    image = camera.project(points)
    run = (image[1] - image[0]) / np.linalg.norm(image[1] - image[0])
    across = np.array([-run[1], run[0]])
    moved = across @ point_jacobian(points, camera.focal_length_mm)  # (2, 6): of the ends across the line
    expected = _Line(image, moved @ guide.covariance @ moved.T)
    if not _lies_along(gauge, T_camera_part, camera):
        return expected
    pieces = _pieces(camera, points)
    places, offsets, variances = [], [], []
    for middle in pieces:
        place, ahead = camera.to_pixels(np.stack([middle, middle + 1e-3 * (image[1] - image[0])]))
        unit = (ahead - place) / np.linalg.norm(ahead - place)
        edge = finder.edge(place, unit, np.arange(-_PIECE_PX, _PIECE_PX + 1), guide.reach_px)
        if edge is not None:
            found = camera.from_pixels(place + edge.coefficients[0] * edge.across)
            per_px = 1 / np.linalg.norm(camera.pixel_jacobian(middle) @ across)
            places.append(float((found - image[0]) @ run))
            offsets.append(float((found - image[0]) @ across))
            variances.append(edge.variance_at(place) * per_px**2)
    if len(offsets) < _PIECES / 2:
        return expected
    t, y = np.array(places), np.array(offsets)
    px = min(camera.pixel_pitch_mm)
    kept = np.abs(y - np.median(y)) < np.inf
    for _ in range(3):  # as straight as its pieces agree within half a pixel
        fit = np.polyfit(t[kept], y[kept], 1)
        left = np.abs(y - np.polyval(fit, t))
        kept = left <= max(0.5 * px, 2.5 * float(np.median(left)))
        if kept.sum() < _PIECES / 2:
            return expected
    along = np.array([0.0, float(np.linalg.norm(image[1] - image[0]))])
    ends = image[0] + along[:, None] * run + np.polyval(fit, along)[:, None] * across
    design = np.vander(t[kept], 2)
    at_ends = np.vander(along, 2) @ np.linalg.inv(design.T @ design) @ np.vander(along, 2).T
    return _Line(ends, float(np.mean(variances)) * at_ends)


def _end(
    finder: EdgeFinder,
    image: NDArray[np.float64],
    gauge: ExpectedGauge,
    k: int,
    place: NDArray[np.float64],
    T_camera_part: NDArray[np.float64],
    camera: Camera,
    line: _Line,
    reach: float,
) -> EndPoint:
    rows, columns = image.shape
    if not (reach <= place[0] <= columns - 1 - reach and reach <= place[1] <= rows - 1 - reach):
        return EndPoint(place, None, None, "too near the image's border")
    window = Window.around(place, reach + _HALF_PX, camera)
    if window is None or (image[window.slices] >= _SATURATED).mean() > _TOO_SATURATED:
        return EndPoint(place, None, None, "saturated")
    start, run = line.near(k, camera)
    directions = gauge.directions(k, T_camera_part, camera)
    crossing = [d for d in directions if _sine(d.unit, run) >= _CROSSES]
    if not crossing:
        return EndPoint(place, None, None, "no edge is known that crosses the gauge")
    edges = []
    for direction in crossing:
        tried = (finder.edge(place, direction.unit, span, reach, gauge.bent) for span in direction.spans)
        edges += list(itertools.islice((edge for edge in tried if edge is not None), 1))
    if not edges:
        return EndPoint(place, None, None, "no clear edge")
    clear = [edge for edge in edges if edge.width_px <= _BLUNT_PX]
    if not clear:
        return EndPoint(place, None, edges[0], _out_of_focus(edges[0].width_px))
    met = [(edge, edge.meets(start, run)) for edge in clear]
    near = [(edge, at) for edge, at in met if at is not None and np.linalg.norm(at - place) <= 2 * reach]
    if not near:
        return EndPoint(place, None, clear[0], "the edge does not meet the gauge near its end")
    along = np.array([(at - start) @ run for _, at in near])
    deviation = np.array([np.sqrt(edge.variance_at(at)) / _sine(edge.along, run) for edge, at in near])
    weight = deviation**-2 / (deviation**-2).sum()
    middle = float(weight @ along)
    total = float((deviation**-2).sum() ** -0.5)
    chance = np.sqrt(np.maximum(deviation**2 - total**2, 0.0))
    if (np.abs(along - middle) > _DISAGREE * chance + _DISAGREE_PX).any():
        return EndPoint(place, None, near[0][0], f"the edges there do not meet in a point: by {np.ptp(along):.1f} px")
    slide = [float(e.along @ run) / float(run[0] * e.along[1] - run[1] * e.along[0]) for e, _ in near]
    best = near[int(np.argmin(deviation))][0]
    found = start + middle * run
    return EndPoint(place, found, best, deviation_px=total, slide=float(weight @ np.array(slide)))
