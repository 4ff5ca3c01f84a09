"""The length of a measurand in an image: its ends where fitted edges cross its line, or a diameter of a fitted rim.

Edges are looked for in the pixels; what is found is put where a pinhole camera would have seen it, by the calibration.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import PoseError, invert, point_jacobian, transform
from ...sensors import Camera, Window
from .edges import SPLINE_MARGIN_PX, Edge, EdgeFinder
from .expected_edges import CLEAR_OF_CORNER_PX, HALF_PX, ExpectedMeasurand, image_directions
from .image_pose import AGREE_PX, FURTHER_PX, Guide, reach_px
from .rim import find_rim, rim_points

__all__ = ["EndPoint", "MeasurandImage", "measurand_windows", "measure_in_image", "rehearsed"]

_CROSSES = np.sin(np.radians(20))  # of the angle between an edge and the measurand
_LIES_ALONG = np.sin(np.radians(8))
_PIECES, _PIECE_PX = 6, 5.0  # of an edge along which a measurand lies, and half the length of each
_DISAGREE, _DISAGREE_PX = 3.5, 0.03  # standard deviations, and beyond, that edges may miss their common point by
_TRUSTED_PX = 0.08  # that an edge may miss its corner by in an image without noise
_BLUNT_PX = 1.9  # width of an edge that is out of focus: of a blur of 2.5 px
_CURVATURES = 0.35  # relative difference
_SATURATED = 0.995
_TOO_SATURATED = 0.02  # share of the pixels about an end


@dataclass(frozen=True)
class EndPoint:
    """An end of a measurand in an image.

    Parameters
    ----------
    expected, found
        ``(2,)`` px; ``found`` None with the ``reason`` it was not.
    deviation_px
        Standard deviation of the found place along the measurand, by the image's noise.
    slide
        How far it goes along the measurand where the measurand's line goes across itself by one.
    """

    expected: NDArray[np.float64]
    found: NDArray[np.float64] | None
    edge: Edge | None
    reason: str = ""
    deviation_px: float = 0.0
    slide: float = 0.0


@dataclass(frozen=True)
class MeasurandImage:
    """Both ends, and the image length, nominal and measured, mm on the ideal image; None where an end is not found.

    ``deviation_mm`` is the standard deviation that the image's noise gives it.
    """

    ends: tuple[EndPoint, EndPoint]
    nominal_mm: float
    measured_mm: float | None
    deviation_mm: float = 0.0

    def length_mm(self, camera: Camera, whole_pixels: bool) -> float | None:
        """The measured length; with ``whole_pixels`` of ends that are put to the nearest corner of pixels.

        That is the paper's edge_detector: an end is where pixels meet, and as far from there as it may be.
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


def measure_in_image(
    finder: EdgeFinder,
    image: NDArray[np.float64],
    measurand: ExpectedMeasurand,
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    guide: Guide,
) -> MeasurandImage:
    """The length of a measurand in an image that was taken at a pose but for the pose error.

    Each end is where an edge that crosses the measurand, fitted near where the guide expects it, meets the measurand's
    line: the expected line through both, or the fitted edge along which the measurand lies. A diameter whose whole rim
    is seen is that of the ellipse which fits the rim. The guide says where to look and where the expected line is; the
    length is compared with that at the pose that was planned.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale; those of the finder.
    """
    nominal = float(np.linalg.norm(np.diff(camera.project(transform(invert(T_part_camera), measurand.points)), axis=0)))
    T_camera_part = invert(guide.T_part_camera)
    points = transform(T_camera_part, measurand.points)
    places = camera.to_pixels(camera.project(points))
    if measurand.rim_axis is not None:
        ends, deviation = _rim_ends(finder, image, points, T_camera_part[:3, :3] @ measurand.rim_axis, camera, guide)
    else:
        line = _measurand_line(finder, measurand, T_camera_part, camera, guide)
        first, second = (
            _end(finder, image, measurand, k, places[k], T_camera_part, camera, line, guide.reach_px) for k in range(2)
        )
        if measurand.bent and first.edge is not None and second.edge is not None:
            first, second = (_of_one_rim(end, first.edge, second.edge) for end in (first, second))
        ends, deviation = (first, second), 0.0
    start, end = ends
    if start.found is None or end.found is None:
        return MeasurandImage(ends, nominal, None)
    found = camera.from_pixels(np.stack([start.found, end.found]))
    if measurand.rim_axis is None:
        per_px = _mm_per_px(camera, found)
        slides = np.array([start.slide, -end.slide])
        variance = ((np.array([start.deviation_px, end.deviation_px]) * per_px) ** 2).sum()
        deviation = float(np.sqrt(variance + slides @ line.covariance_mm2 @ slides))
    return MeasurandImage(ends, nominal, float(np.linalg.norm(found[1] - found[0])), deviation)


def _mm_per_px(camera: Camera, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(2,)``: along the line between two ideal image points, at each."""
    run = (found[1] - found[0]) / np.linalg.norm(found[1] - found[0])
    return np.asarray(1 / np.linalg.norm(camera.pixel_jacobian(found) @ run, axis=1))


def measurand_windows(
    measurand: ExpectedMeasurand, T_part_camera: NDArray[np.float64], camera: Camera, error: PoseError
) -> list[Window]:
    """All of an image that is looked at to measure a measurand at a planned pose, and to find where it was taken."""
    T_camera_part = invert(T_part_camera)
    points = transform(T_camera_part, measurand.points)
    places = camera.to_pixels(camera.project(points))
    reach = max(reach_px(point, camera, error.camera_covariance) for point in points)
    margin = reach + AGREE_PX * 3 + FURTHER_PX + 4 + SPLINE_MARGIN_PX
    if measurand.rim_axis is not None:
        rim = rim_points(points, T_camera_part[:3, :3] @ measurand.rim_axis, 90)
        found = [Window.around(camera.to_pixels(camera.project(rim)), margin + 2 * HALF_PX, camera)]
    else:
        found = [Window.around(place, margin + 2 * HALF_PX, camera) for place in places]
        if _lies_along(measurand, T_camera_part, camera):
            middles = camera.to_pixels(_pieces(camera, points))
            found += [Window.around(middle, margin + _PIECE_PX, camera) for middle in middles]
    return [window for window in found if window is not None]


def rehearsed(
    finder: EdgeFinder, measurand: ExpectedMeasurand, T_part_camera: NDArray[np.float64], camera: Camera
) -> ExpectedMeasurand:
    """The measurand with those edges trusted that are where they should be in an image without noise or displacement.

    What lies beside an edge in the image, such as the other edge of a narrow face, moves it by tenths of a pixel; a
    noisy image does not tell. Where no edge that crosses the measurand at an end is right, all of them stay.

    Parameters
    ----------
    finder
        Of a rendered image of the part from that pose.
    """
    T_camera_part = invert(T_part_camera)
    places = camera.to_pixels(camera.project(transform(T_camera_part, measurand.points)))
    run = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
    trusted = []
    for k, place in enumerate(places):
        directions = measurand.directions(k, T_camera_part, camera)
        every = [(i, j) for i, direction in enumerate(directions) for j in range(len(direction.spans))]
        right = []
        for i, j in every:
            direction = directions[i]
            edge = finder.edge(place, direction.unit, direction.spans[j], FURTHER_PX, measurand.bent)
            if edge is not None and abs(edge.coefficients[0]) <= _TRUSTED_PX:
                right.append((i, j))
        crosses = any(_sine(directions[i].unit, run) >= _CROSSES for i, _ in right)
        trusted.append(frozenset(right if crosses else every))
    return replace(measurand, trusted=(trusted[0], trusted[1]))


@dataclass(frozen=True)
class _Line:
    """Of a measurand, mm on the ideal image: two points ``(2, 2)``, and their covariance ``(2, 2)`` across it, mm²."""

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


def _lies_along(measurand: ExpectedMeasurand, T_camera_part: NDArray[np.float64], camera: Camera) -> bool:
    """Whether a measurand lies along an edge, from end to end."""
    points = transform(T_camera_part, measurand.points)
    places = camera.to_pixels(camera.project(points))
    length = float(np.linalg.norm(places[1] - places[0]))
    if length < 2 * (2 * CLEAR_OF_CORNER_PX + _PIECE_PX):
        return False
    line = _Line(camera.project(points), np.zeros((2, 2)))
    return all(
        any(
            _sine(d.unit, line.near(k, camera)[1]) < _LIES_ALONG
            for d in image_directions(points[k], T_camera_part[:3, :3], measurand.normals[k], camera)
        )
        for k in range(2)
    )


def _pieces(camera: Camera, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(k, 2)`` mm on the ideal image: places along a measurand's image, clear of its ends."""
    start, end = camera.project(points)
    length = float(np.linalg.norm(np.diff(camera.to_pixels(np.stack([start, end])), axis=0)))
    clear = (2 * CLEAR_OF_CORNER_PX + _PIECE_PX) / length
    return np.asarray(start + np.linspace(clear, 1 - clear, _PIECES)[:, None] * (end - start))


def _measurand_line(
    finder: EdgeFinder, measurand: ExpectedMeasurand, T_camera_part: NDArray[np.float64], camera: Camera, guide: Guide
) -> _Line:
    """The ends' line: of the edge along which the measurand lies, if it does, else through the ends as expected."""
    points = transform(T_camera_part, measurand.points)
    image = camera.project(points)
    run = (image[1] - image[0]) / np.linalg.norm(image[1] - image[0])
    across = np.array([-run[1], run[0]])
    moved = across @ point_jacobian(points, camera.focal_length_mm)  # (2, 6): of the ends across the line
    expected = _Line(image, moved @ guide.covariance @ moved.T)
    if not _lies_along(measurand, T_camera_part, camera):
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
    measurand: ExpectedMeasurand,
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
    window = Window.around(place, reach + HALF_PX, camera)
    if window is None or (image[window.slices] >= _SATURATED).mean() > _TOO_SATURATED:
        return EndPoint(place, None, None, "saturated")
    start, run = line.near(k, camera)
    directions = measurand.directions(k, T_camera_part, camera)
    crossing = [d for d in directions if _sine(d.unit, run) >= _CROSSES]
    if not crossing:
        return EndPoint(place, None, None, "no edge is known that crosses the measurand")
    edges = []
    for direction in crossing:
        tried = (finder.edge(place, direction.unit, span, reach, measurand.bent) for span in direction.spans)
        edges += list(itertools.islice((edge for edge in tried if edge is not None), 1))
    if not edges:
        return EndPoint(place, None, None, "no clear edge")
    clear = [edge for edge in edges if edge.width_px <= _BLUNT_PX]
    if not clear:
        return EndPoint(place, None, edges[0], _out_of_focus(edges[0].width_px))
    met = [(edge, edge.meets(start, run)) for edge in clear]
    near = [(edge, at) for edge, at in met if at is not None and np.linalg.norm(at - place) <= 2 * reach]
    if not near:
        return EndPoint(place, None, clear[0], "the edge does not meet the measurand near its end")
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
