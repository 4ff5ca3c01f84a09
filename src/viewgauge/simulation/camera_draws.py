"""Errors of a camera that is more than the paper's, drawn: edge location, a common offset, the calibration.

Only geometry is shared with the laws: what a fitted line or ellipse leaves of the noise of its points is found by least
squares here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ..geometry import Lens
from ..geometry.lens import distort_each
from ..sensors import Camera

__all__ = ["CameraDraws", "covariance_factor", "end_deviation_px", "measured_images"]

_PINHOLE = Lens("radial-tangential", (0.0, 0.0, 0.0, 0.0))


@dataclass(frozen=True)
class CameraDraws:
    """n draws of a camera's errors.

    Parameters
    ----------
    quantization
        ``(n, 2, 2)``: of start and end along u and v, in quantization steps, within half a step.
    noise
        ``(n, 2, 2)`` unit normals, of start and end along u and v.
    offset
        ``(n,)`` unit normals.
    intrinsics
        ``(n, k)`` unit normals, k the size of the covariance.
    """

    quantization: NDArray[np.float64]
    noise: NDArray[np.float64]
    offset: NDArray[np.float64]
    intrinsics: NDArray[np.float64]

    @staticmethod
    def width(camera: Camera) -> int:
        """How many uniform numbers make a draw."""
        return sum(_widths(camera))

    @classmethod
    def of(cls, camera: Camera, uniform: NDArray[np.float64]) -> CameraDraws:
        """Draws from uniform numbers ``(n, width)`` between 0 and 1, neither included."""
        n, places = len(uniform), np.cumsum([0, *_widths(camera)])
        parts = [uniform[:, places[k] : places[k + 1]] for k in range(4)]
        quantization = parts[0].reshape(n, 2, 2) - 0.5 if parts[0].size else np.zeros((n, 2, 2))
        noise = ndtri(parts[1]).reshape(n, 2, 2) if parts[1].size else np.zeros((n, 2, 2))
        offset = ndtri(parts[2])[:, 0] if parts[2].size else np.zeros(n)
        return cls(quantization, noise, offset, ndtri(parts[3]))

    def with_common(self, other: CameraDraws) -> CameraDraws:
        """These, with what is common to all acquisitions, offset and calibration, from another draw."""
        return replace(self, offset=other.offset, intrinsics=other.intrinsics)


def _widths(camera: Camera) -> tuple[int, int, int, int]:
    edge_detector, covariance = camera.edge_detector, camera.intrinsics_covariance
    return (
        4 * (max(camera.quantization_step_mm) > 0),
        4 * (edge_detector is not None and edge_detector.noise_px > 0),
        int(edge_detector is not None and edge_detector.bias_px > 0),
        0 if covariance is None else len(covariance),
    )


def measured_images(
    images: NDArray[np.float64], nominal: NDArray[np.float64], camera: Camera, draws: CameraDraws, noise_px: float
) -> NDArray[np.float64]:
    """``(n, 2, 2)`` mm: where, by its calibration, a camera has seen the ends whose ideal images are ``(n, 2, 2)`` mm.

    The true camera, of drawn intrinsics, puts them in its pixels; there they are located with an error; and the nominal
    camera says from where that is seen.

    Parameters
    ----------
    nominal
        ``(2, 2)`` mm: ideal images without errors, which give the direction in which the offset acts.
    noise_px
        Standard deviation of an end's location along u and along v.
    """
    lens = camera.lens or _PINHOLE
    n, pitch = len(images), np.asarray(camera.pixel_pitch_mm)
    focal = np.broadcast_to(camera.focal_length_mm / pitch, (n, 2))  # px
    centre = np.broadcast_to(np.asarray(camera.principal_point), (n, 2))
    parameters = np.broadcast_to(lens.parameters, (n, 13))
    if camera.intrinsics_covariance is not None:
        deviations = draws.intrinsics @ covariance_factor(np.array(camera.intrinsics_covariance)).T
        focal, centre = focal + deviations[:, :2], centre + deviations[:, 2:4]
        parameters = parameters.copy()
        parameters[:, 1 : 1 + deviations.shape[1] - 4] += deviations[:, 4:]
    px = np.empty_like(images)
    for end in range(2):
        shown = distort_each(parameters, images[:, end] / camera.focal_length_mm)
        px[:, end] = focal * shown + centre
    px = px + draws.noise * noise_px
    if camera.edge_detector is None:
        px = px + draws.quantization * camera.edge_resolution_px
    else:
        outwards = camera.pixel_jacobian(nominal) @ (nominal[1] - nominal[0]) * [[-1], [1]]  # of start and end
        outwards = outwards / np.linalg.norm(outwards, axis=1, keepdims=True)
        px = px + camera.edge_detector.bias_px * draws.offset[:, None, None] * outwards
    return camera.from_pixels(px)


def end_deviation_px(points: NDArray[np.float64], camera: Camera, rim_axis: NDArray[np.float64] | None) -> float:
    """Standard deviation of an end's location along u and along v, px, by a sub-pixel edge detector; 0 without one.

    Of a whole rim that is fitted it is that of either end which gives the fitted diameter's.

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
    """Of the fitted diameter for rim points one px apart of deviation 1, by least squares on the projected circle."""
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
    """Chord of a conic through its centre, in the direction of the ends."""
    a, b, c, d, e = conic
    middle = np.linalg.solve(np.array([[2 * a, b], [b, 2 * c]]), [-d, -e])
    u, v = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    level = 1 - (a * middle[0] ** 2 + b * middle[0] * middle[1] + c * middle[1] ** 2 + d * middle[0] + e * middle[1])
    return float(2 * np.sqrt(level / (a * u * u + b * u * v + c * v * v)))


def covariance_factor(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, n)``: what unit normals are multiplied by to have a covariance, whatever the units of each."""
    deviation = np.sqrt(covariance.diagonal())
    scale = np.where(deviation > 0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(deviation[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
