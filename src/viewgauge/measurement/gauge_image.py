"""The length of a gauge in an image: its ends where fitted edges cross its line."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..geometry import Camera, PoseError, invert, point_jacobian, transform
from .edges import Edge, EdgeFinder

__all__ = ["EndPoint", "ExpectedGauge", "GaugeImage", "Guide", "find_guide", "measure_gauge"]

_CROSSES = np.sin(np.radians(20))  # of the angle between an edge and the gauge
_LIES_ALONG = np.sin(np.radians(8))
_HALF_PX, _CLEAR_OF_CORNER_PX = 9.0, 5.0
_THROUGH = (-_HALF_PX, _HALF_PX)
_AT_CORNER = ((_CLEAR_OF_CORNER_PX, 2 * _HALF_PX), (-2 * _HALF_PX, -_CLEAR_OF_CORNER_PX))
_FEWEST_EDGES, _FEWEST_AGREE, _AGREE_PX = 6, 0.4, 1.5
_SIGMAS = 4.0  # of the displacement of an end that an edge is looked for within
_BLUNT_PX = 1.9  # width of an edge that is out of focus: of a blur of 2.5 px
_CURVATURES = 0.35  # relative difference
_SATURATED = 0.995
_TOO_SATURATED = 0.02  # share of the pixels about an end


@dataclass(frozen=True)
class ExpectedGauge:
    """A gauge, part frame, mm: its two points, and the normals of the faces that meet at each, ``(k, 3)``.

    ``bent``: its edges are curves, such as the rim of a hole.
    """

    points: NDArray[np.float64]
    normals: tuple[NDArray[np.float64], NDArray[np.float64]]
    bent: bool = False


@dataclass(frozen=True)
class EndPoint:
    """Where an end was expected and found, px; ``found`` None with the ``reason`` it was not."""

    expected: NDArray[np.float64]
    found: NDArray[np.float64] | None
    edge: Edge | None
    reason: str = ""


@dataclass(frozen=True)
class GaugeImage:
    """Both ends, and the image length, nominal and measured, mm on the image; None where an end is not found."""

    ends: tuple[EndPoint, EndPoint]
    nominal_mm: float
    measured_mm: float | None

    @property
    def reason(self) -> str:
        """Why there is no length; empty where there is one."""
        return "; ".join(
            f"{name}: {end.reason}" for name, end in zip(("start", "end"), self.ends, strict=True) if end.reason
        )


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
    the expected line through both, or the fitted edge along which the gauge lies. The guide says where to look and
    where the expected line is; the length is compared with that at the pose that was planned.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale; those of the finder.
    """
    nominal = float(np.linalg.norm(np.diff(camera.project(transform(invert(T_part_camera), gauge.points)), axis=0)))
    T_camera_part = invert(guide.T_part_camera)
    points = transform(T_camera_part, gauge.points)
    places = camera.to_pixels(camera.project(points))
    line = (places[1] - places[0]) / np.linalg.norm(places[1] - places[0])
    directions = [
        image_directions(point, T_camera_part[:3, :3], normals, camera)
        for point, normals in zip(points, gauge.normals, strict=True)
    ]
    start, run = _gauge_line(finder, places, line, directions, guide.reach_px)
    first, second = (
        _end(finder, image, places[k], directions[k], guide.reach_px, start, run, gauge.bent) for k in range(2)
    )
    if gauge.bent and first.edge is not None and second.edge is not None:
        first, second = (_of_one_rim(end, first.edge, second.edge) for end in (first, second))
    measured = None
    if first.found is not None and second.found is not None:
        measured = float(np.linalg.norm((second.found - first.found) * np.asarray(camera.pixel_pitch_mm)))
    return GaugeImage((first, second), nominal, measured)


@dataclass(frozen=True)
class Guide:
    """Where to look: from about which pose the image was taken, and how far off edges may still be, px."""

    T_part_camera: NDArray[np.float64]
    reach_px: float


def find_guide(
    finder: EdgeFinder,
    gauges: Sequence[ExpectedGauge],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
) -> Guide | None:
    """From about where an image was taken, by all edges at the ends of gauges; None where they do not agree.

    The pose error of the greatest posterior density for the head's normal law and edges that are off by a pixel or are
    others altogether (Cauchy).
    """
    T_camera_part = invert(T_part_camera)
    rows, offsets = [], []
    for gauge in gauges:
        for point, normals in zip(transform(T_camera_part, gauge.points), gauge.normals, strict=True):
            place = camera.to_pixels(camera.project(point))
            J = point_jacobian(point, camera.focal_length_mm) @ error.adjoint
            J = J / np.asarray(camera.pixel_pitch_mm)[:, None]
            reach = _reach_px(point, camera, error)
            for along in image_directions(point, T_camera_part[:3, :3], normals, camera):
                for span in along.spans:
                    edge = finder.edge(place, along.unit, span, reach, gauge.bent)
                    if edge is not None:
                        middle = (span[0] + span[1]) / 2
                        a, b, c = edge.coefficients
                        offsets.append(a + b * middle + c * middle**2)
                        rows.append(edge.across @ J)
    if len(offsets) < _FEWEST_EDGES:
        return None
    A, y = np.array(rows), np.array(offsets)
    factor = error.factor
    twist, weight = np.zeros(6), np.ones(len(y))
    for scale in (8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0):
        weight = 1 / (1 + ((y - A @ twist) / scale) ** 2)
        scaled = A @ factor
        z = np.linalg.solve(scaled.T @ (weight[:, None] * scaled) + np.eye(6), scaled.T @ (weight * y))
        twist = factor @ z
    left = np.abs(y - A @ twist)
    agree = left < _AGREE_PX
    if agree.sum() < max(_FEWEST_EDGES, _FEWEST_AGREE * len(y)):
        return None
    displacement = np.eye(4)
    displacement[:3, :3], displacement[:3, 3] = Rotation.from_rotvec(twist[3:]).as_matrix(), twist[:3]
    assert error.T_camera_head is not None  # set by PoseError
    moved = error.T_camera_head @ displacement @ invert(error.T_camera_head) @ T_camera_part
    return Guide(invert(moved), float(3 * np.median(left[agree]) + 2.0))


def _reach_px(point: NDArray[np.float64], camera: Camera, error: PoseError) -> float:
    """How far an end may be from where it is expected."""
    J = point_jacobian(point, camera.focal_length_mm) / np.asarray(camera.pixel_pitch_mm)[:, None]
    spread = J @ error.camera_covariance @ J.T
    return float(_SIGMAS * np.sqrt(np.linalg.eigvalsh(spread)[-1]) + 2.0)


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
            found.append(_Direction(run / np.linalg.norm(run), _AT_CORNER if leaning else (_THROUGH,)))
    return found


@dataclass(frozen=True)
class _Direction:
    """Of an edge in the image, ``(2,)`` unit, and where along it to look, in this order."""

    unit: NDArray[np.float64]
    spans: tuple[tuple[float, float], ...]


def _sine(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(abs(a[0] * b[1] - a[1] * b[0]))


def _of_one_rim(end: EndPoint, first: Edge, second: Edge) -> EndPoint:
    """An end, without what was found if the curvatures at the ends of a diameter, equal on an ellipse, differ."""
    a, b = first.coefficients[2], second.coefficients[2]
    if abs(a - b) <= _CURVATURES * max(abs(a), abs(b)):
        return end
    return EndPoint(end.expected, None, end.edge, "what is found is not the rim at both ends: it is bent differently")


def _gauge_line(
    finder: EdgeFinder,
    places: NDArray[np.float64],
    line: NDArray[np.float64],
    directions: list[list[_Direction]],
    reach: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A point and the direction of the ends' line: of the edge along which the gauge lies, if it does."""
    if all(any(_sine(d.unit, line) < _LIES_ALONG for d in at_end) for at_end in directions):
        length = float(np.linalg.norm(places[1] - places[0]))
        edge = finder.edge(places[0], line, (2 * _CLEAR_OF_CORNER_PX, length - 2 * _CLEAR_OF_CORNER_PX), reach)
        if edge is not None:
            a, b, _ = edge.coefficients
            run = line + b * edge.across
            return places[0] + a * edge.across, run / np.linalg.norm(run)
    return places[0], line


def _end(
    finder: EdgeFinder,
    image: NDArray[np.float64],
    place: NDArray[np.float64],
    directions: list[_Direction],
    reach: float,
    start: NDArray[np.float64],
    run: NDArray[np.float64],
    bent: bool,
) -> EndPoint:
    rows, columns = image.shape
    if not (reach <= place[0] <= columns - 1 - reach and reach <= place[1] <= rows - 1 - reach):
        return EndPoint(place, None, None, "too near the image's border")
    top, left = (int(max(c - reach - _HALF_PX, 0)) for c in (place[1], place[0]))
    about = image[top : int(place[1] + reach + _HALF_PX) + 1, left : int(place[0] + reach + _HALF_PX) + 1]
    if (about >= _SATURATED).mean() > _TOO_SATURATED:
        return EndPoint(place, None, None, "saturated")
    crossing = [d for d in directions if _sine(d.unit, run) >= _CROSSES]
    if not crossing:
        return EndPoint(place, None, None, "no edge is known that crosses the gauge")
    best: Edge | None = None  # the straightest: the most nearly square one located the ends of a corner worse
    for direction in crossing:
        tried = (finder.edge(place, direction.unit, span, reach, bent) for span in direction.spans)
        edge = next((edge for edge in tried if edge is not None), None)
        if edge is not None and (best is None or edge.residual_px < best.residual_px):
            best = edge
    if best is None:
        return EndPoint(place, None, None, "no clear edge")
    if best.width_px > _BLUNT_PX:
        return EndPoint(place, None, best, f"out of focus: the edge is {best.width_px:.1f} px wide")
    met = best.meets(start, run)
    if met is None or np.linalg.norm(met - place) > 2 * reach:
        return EndPoint(place, None, best, "the edge does not meet the gauge near its end")
    return EndPoint(place, met, best)
