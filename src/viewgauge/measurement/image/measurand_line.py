"""The line of a measurand in an image: that through both ends as expected, or the edge along which it lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry import point_jacobian, transform
from ...sensors import Camera
from .edges import EdgeFinder
from .expected_edges import CLEAR_OF_CORNER_PX, ExpectedMeasurand, image_directions
from .image_pose import ImagePose

__all__ = ["PIECE_PX", "MeasurandLine", "lies_along", "measurand_line", "pieces", "sine"]

PIECE_PX = 5.0
"""Half the length of each piece of an edge along which a measurand lies."""

_PIECES = 6
_LIES_ALONG = np.sin(np.radians(8))  # of the angle between an edge and the measurand


@dataclass(frozen=True)
class MeasurandLine:
    """The line through a measurand's ends, mm on the ideal image.

    Parameters
    ----------
    points
        ``(2, 2)`` mm: where it passes both ends.
    covariance_mm2
        ``(2, 2)`` mm²: of the two points across the line.
    """

    points: NDArray[np.float64]
    covariance_mm2: NDArray[np.float64]

    def near(self, end: int, camera: Camera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """A point and the direction, unit, in the pixels, next to one of its points."""
        run = (self.points[1] - self.points[0]) * (1e-3 if end == 0 else -1e-3)
        start, beyond = camera.to_pixels(np.stack([self.points[end], self.points[end] + run]))
        direction = (beyond - start) * (1 if end == 0 else -1)
        return start, direction / np.linalg.norm(direction)


def sine(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Of the angle between two directions in the image, without its sign."""
    return float(abs(a[0] * b[1] - a[1] * b[0]))


def lies_along(measurand: ExpectedMeasurand, T_camera_part: NDArray[np.float64], camera: Camera) -> bool:
    """Whether a measurand lies along an edge, from end to end."""
    points = transform(T_camera_part, measurand.points)
    places = camera.to_pixels(camera.project(points))
    length = float(np.linalg.norm(places[1] - places[0]))
    if length < 2 * (2 * CLEAR_OF_CORNER_PX + PIECE_PX):
        return False
    line = MeasurandLine(camera.project(points), np.zeros((2, 2)))
    return all(
        any(
            sine(d.unit, line.near(k, camera)[1]) < _LIES_ALONG
            for d in image_directions(points[k], T_camera_part[:3, :3], measurand.normals[k], camera)
        )
        for k in range(2)
    )


def pieces(camera: Camera, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(k, 2)`` mm on the ideal image: places along a measurand's image, clear of its ends."""
    start, end = camera.project(points)
    length = float(np.linalg.norm(np.diff(camera.to_pixels(np.stack([start, end])), axis=0)))
    clear = (2 * CLEAR_OF_CORNER_PX + PIECE_PX) / length
    return np.asarray(start + np.linspace(clear, 1 - clear, _PIECES)[:, None] * (end - start))


def measurand_line(
    finder: EdgeFinder,
    measurand: ExpectedMeasurand,
    T_camera_part: NDArray[np.float64],
    camera: Camera,
    pose: ImagePose,
) -> MeasurandLine:
    """The ends' line: of the edge along which the measurand lies, if it does, else through the ends as expected."""
    points = transform(T_camera_part, measurand.points)
    image = camera.project(points)
    run = (image[1] - image[0]) / np.linalg.norm(image[1] - image[0])
    across = np.array([-run[1], run[0]])
    moved = across @ point_jacobian(points, camera.principal_distance_mm)  # (2, 6): of the ends across the line
    expected = MeasurandLine(image, moved @ pose.covariance @ moved.T)
    if not lies_along(measurand, T_camera_part, camera):
        return expected
    middles = pieces(camera, points)
    places, offsets, variances = [], [], []
    for middle in middles:
        place, ahead = camera.to_pixels(np.stack([middle, middle + 1e-3 * (image[1] - image[0])]))
        unit = (ahead - place) / np.linalg.norm(ahead - place)
        edge = finder.edge(place, unit, np.arange(-PIECE_PX, PIECE_PX + 1), pose.reach_px)
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
    return MeasurandLine(ends, float(np.mean(variances)) * at_ends)
