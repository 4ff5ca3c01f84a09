"""The length of a measurand in an image: its ends where fitted edges cross its line, or a diameter of a fitted rim.

Edges are looked for in the pixels; what is found is put where a pinhole camera would have seen it, by the calibration.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import PoseError, invert, transform
from ...sensors import Camera, Window
from .edges import SPLINE_MARGIN_PX, EdgeFinder
from .expected_edges import HALF_PX, ExpectedMeasurand
from .image_edge import ImageEdge
from .image_pose import AGREE_PX, FURTHER_PX, ImagePose, reach_px
from .measurand_line import PIECE_PX, MeasurandLine, lies_along, measurand_line, pieces, sine
from .rim import find_rim, rim_points

__all__ = ["EndPoint", "MeasurandImage", "measurand_windows", "measure_in_image", "rehearsed"]

_CROSSES = np.sin(np.radians(20))  # of the angle between an edge and the measurand
_DISAGREE, _DISAGREE_PX = 3.5, 0.03  # standard deviations, and beyond, that edges may miss their common point by
_TRUSTED_PX = 0.08  # that an edge may miss its corner by in an image without noise
_BLUNT_PX = 1.9  # width of an edge that is out of focus: of a blur of 2.5 px
_CURVATURES = 0.35  # relative difference
_SATURATED = 0.995
_TOO_SATURATED = 0.02  # share of the pixels about an end


@dataclass(frozen=True)
class _Search:
    """Where the edges of a measurand are looked for.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale; those of the finder.
    T_camera_part
        ``(4, 4)`` mm: the pose from which the image was taken.
    reach_px
        How far off edges may be.
    """

    finder: EdgeFinder
    image: NDArray[np.float64]
    camera: Camera
    T_camera_part: NDArray[np.float64]
    reach_px: float

    def unfit(self, around: NDArray[np.float64], margin_px: float) -> str:
        """Why nothing can be measured around places ``(n, 2)`` px; empty where it can."""
        rows, columns = self.image.shape
        inside = (around >= self.reach_px) & (around <= np.array([columns, rows]) - 1 - self.reach_px)
        if not inside.all():
            return "too near the image's border"
        window = Window.around(around, self.reach_px + margin_px, self.camera)
        if window is None or (self.image[window.slices] >= _SATURATED).mean() > _TOO_SATURATED:
            return "saturated"
        return ""


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
    edge: ImageEdge | None
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

        The paper's edge detector does so: an end is where pixels meet, and may be half a pixel from there.
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
    pose: ImagePose,
) -> MeasurandImage:
    """The length of a measurand in an image that was taken at a pose but for the pose error.

    Each end is where an edge that crosses the measurand, fitted near where the image's pose has it, meets the
    measurand's line: the expected line through both, or the fitted edge along which the measurand lies. A diameter
    whose whole rim is seen is that of the ellipse which fits the rim. The image's pose says where to look and where the
    expected line is; the length is compared with that at the pose that was planned.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale; those of the finder.
    """
    nominal = float(np.linalg.norm(np.diff(camera.project(transform(invert(T_part_camera), measurand.points)), axis=0)))
    search = _Search(finder, image, camera, invert(pose.T_part_camera), pose.reach_px)
    points = transform(search.T_camera_part, measurand.points)
    if measurand.rim_axis is not None:
        ends, deviation = _rim_ends(search, points, search.T_camera_part[:3, :3] @ measurand.rim_axis)
    else:
        places = camera.to_pixels(camera.project(points))
        line = measurand_line(finder, measurand, search.T_camera_part, camera, pose)
        first, second = (_end(search, measurand, k, places[k], line) for k in range(2))
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
        if lies_along(measurand, T_camera_part, camera):
            middles = camera.to_pixels(pieces(camera, points))
            found += [Window.around(middle, margin + PIECE_PX, camera) for middle in middles]
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
        crosses = any(sine(directions[i].unit, run) >= _CROSSES for i, _ in right)
        trusted.append(frozenset(right if crosses else every))
    return replace(measurand, trusted=(trusted[0], trusted[1]))


def _of_one_rim(end: EndPoint, first: ImageEdge, second: ImageEdge) -> EndPoint:
    """An end, without what was found if the curvatures at the ends of a diameter, equal on an ellipse, differ."""
    a, b = first.coefficients[2], second.coefficients[2]
    if abs(a - b) <= _CURVATURES * max(abs(a), abs(b)):
        return end
    return EndPoint(end.expected, None, end.edge, "what is found is not the rim at both ends: it is bent differently")


def _rim_ends(
    search: _Search, points: NDArray[np.float64], axis: NDArray[np.float64]
) -> tuple[tuple[EndPoint, EndPoint], float]:
    """The ends of the diameter of a fitted rim, and the standard deviation of its length, mm."""
    camera = search.camera
    places = camera.to_pixels(camera.project(points))

    def not_found(reason: str) -> tuple[tuple[EndPoint, EndPoint], float]:
        return (EndPoint(places[0], None, None, reason), EndPoint(places[1], None, None, reason)), 0.0

    why = search.unfit(camera.to_pixels(camera.project(rim_points(points, axis, 90))), 0.0)
    if why:
        return not_found(why)
    rim = find_rim(search.finder, points, axis, camera, search.reach_px)
    if rim is None:
        return not_found("no clear rim")
    if rim.width_px > _BLUNT_PX:
        return not_found(_out_of_focus(rim.width_px))
    found = camera.to_pixels(rim.ends)
    return (EndPoint(places[0], found[0], None), EndPoint(places[1], found[1], None)), float(np.sqrt(rim.variance_mm2))


def _out_of_focus(width_px: float) -> str:
    return f"out of focus: the edge is {width_px:.1f} px wide"


def _end(
    search: _Search, measurand: ExpectedMeasurand, k: int, place: NDArray[np.float64], line: MeasurandLine
) -> EndPoint:
    """End k of a measurand, expected at ``(2,)`` px: where an edge that crosses the measurand meets its line."""
    why = search.unfit(place[None], HALF_PX)
    if why:
        return EndPoint(place, None, None, why)
    camera, reach = search.camera, search.reach_px
    start, run = line.near(k, camera)
    directions = measurand.directions(k, search.T_camera_part, camera)
    crossing = [d for d in directions if sine(d.unit, run) >= _CROSSES]
    if not crossing:
        return EndPoint(place, None, None, "no edge is known that crosses the measurand")
    edges = []
    for direction in crossing:
        tried = (search.finder.edge(place, direction.unit, span, reach, measurand.bent) for span in direction.spans)
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
    deviation = np.array([np.sqrt(edge.variance_at(at)) / sine(edge.along, run) for edge, at in near])
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
