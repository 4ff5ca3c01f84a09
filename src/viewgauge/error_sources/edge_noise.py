"""Noise of the edge points that a sub-pixel edge detector locates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind

__all__ = ["EdgeNoise", "end_deviation_px"]


class EdgeNoise(ErrorSource):
    """Normal errors of located or fitted edge points, drawn anew at each acquisition.

    What a fitted line or ellipse leaves of the noise is found by least squares here, for the draws, and in closed form
    in :mod:`viewgauge.errors.edge_location`, for the linear law: they share no formula.
    """

    name = "edge_noise"
    kind = SourceKind.ANEW
    components = (Component("edge_noise", "edges", "edge location"),)
    groups = ("camera",)
    knobs = ("pixel",)

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """Standard deviation of one edge point, px."""
        return 0.0 if camera.edge_detector is None else camera.edge_detector.noise_px

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """An edge detector with the noise multiplied."""
        detector = camera.edge_detector
        if detector is None:
            return camera, pose_error
        return replace(camera, edge_detector=replace(detector, noise_px=detector.noise_px * factor)), pose_error

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:
        """``(1,)`` px."""
        return np.array([self.size(camera, pose_error)])

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:
        """``(..., 1)``: mm of image length per px of an edge point."""
        noise = 0.0 if camera.edge_detector is None else camera.edge_detector.noise_px
        return np.asarray(np.sqrt(terms.anew_mm2[self.name]) / (noise or 1.0))[..., None]

    def draw_width(self, camera: Camera) -> int:
        """Four: start and end along u and v."""
        return 4 * (camera.edge_detector is not None and camera.edge_detector.noise_px > 0)

    def drawn(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, 2, 2)`` unit normals, of start and end along u and v."""
        return np.asarray(ndtri(uniform).reshape(len(uniform), 2, 2))

    def prepared(self, view: DrawnView) -> float:
        """Standard deviation of an end's location along u and along v, px."""
        return end_deviation_px(view.points, view.camera, view.rim_axis)

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:
        """Ends that are off by the drawn noise."""
        return np.asarray(px + drawn * view.prepared[self.name])


def end_deviation_px(points: NDArray[np.float64], camera: Camera, rim_axis: NDArray[np.float64] | None) -> float:
    """Standard deviation of an end's location along u and along v, px, by a sub-pixel edge detector; 0 without one.

    Of a whole rim that is fitted it is that of both ends which gives the deviation of the fitted diameter.

    Parameters
    ----------
    points
        ``(2, 3)`` mm, camera frame.
    rim_axis
        ``(3,)``, camera frame; None or zeros for two ends that are located each by itself.
    """
    edge_detector = camera.edge_detector
    if edge_detector is None:
        return 0.0
    if edge_detector.edge_points is None:
        return edge_detector.noise_px
    if rim_axis is not None and np.any(rim_axis):
        return float(edge_detector.noise_px * _rim_deviation(points, camera, np.asarray(rim_axis)) / np.sqrt(2))
    t = edge_detector.clear_of_corner_px + np.arange(edge_detector.edge_points)
    design = np.stack([np.ones_like(t), t], axis=1)
    return float(edge_detector.noise_px * np.sqrt(np.linalg.inv(design.T @ design)[0, 0]))


def _rim_deviation(points: NDArray[np.float64], camera: Camera, axis: NDArray[np.float64]) -> float:
    """Deviation of the fitted diameter for rim points one px apart of deviation 1, by least squares on the projected
    circle.
    """
    centre, radius = points.mean(axis=0), np.linalg.norm(points[1] - points[0]) / 2
    x = (points[1] - points[0]) / (2 * radius)
    y = np.cross(axis, x)
    angle = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    rim = centre + radius * (np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y)
    pitch = np.asarray(camera.pixel_pitch_mm)
    places = camera.project(rim) / pitch
    middle = places.mean(axis=0)
    p = places - middle
    size = float(np.abs(p).max())
    p = p / size
    arc = np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1)
    # ellipse a x² + b x y + c y² + d x + e y = 1
    design = np.stack([p[:, 0] ** 2, p[:, 0] * p[:, 1], p[:, 1] ** 2, p[:, 0], p[:, 1]], axis=1)
    a, b, c, d, e = np.linalg.lstsq(design, np.ones(len(p)), rcond=None)[0]
    slope = np.stack([2 * a * p[:, 0] + b * p[:, 1] + d, b * p[:, 0] + 2 * c * p[:, 1] + e], axis=1)
    rows = design / np.linalg.norm(slope, axis=1)[:, None]
    covariance = np.linalg.inv((rows * (arc * size)[:, None]).T @ rows)  # points one px apart; in units of size
    ends = (camera.project(points) / pitch - middle) / size
    diameter = _diameter(np.array([a, b, c, d, e]), ends)
    step = 1e-6
    gradient = [(_diameter(np.array([a, b, c, d, e]) + step * unit, ends) - diameter) / step for unit in np.eye(5)]
    return float(np.sqrt(np.array(gradient) @ covariance @ np.array(gradient)))


def _diameter(conic: NDArray[np.float64], ends: NDArray[np.float64]) -> float:
    """The chord of a conic through its centre, in the direction of the ends."""
    a, b, c, d, e = conic
    middle = np.linalg.solve(np.array([[2 * a, b], [b, 2 * c]]), [-d, -e])
    u, v = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    level = 1 - (a * middle[0] ** 2 + b * middle[0] * middle[1] + c * middle[1] ** 2 + d * middle[0] + e * middle[1])
    return float(2 * np.sqrt(level / (a * u * u + b * u * v + c * v * v)))
