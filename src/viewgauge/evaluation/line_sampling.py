"""How much probability lies on lines through the space of the errors, with the full camera model.

The errors are eight independent unit normals: six of the pose and two of quantization, a normal of the same variance
standing for the triangular difference of two uniforms. It serves to judge the small-error model, not to replace the
full camera model of :mod:`viewgauge.simulation`, with which it shares geometry alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..geometry import PoseError, invert, transform
from ..sensors import Camera
from .camera_errors import camera_errors

__all__ = ["NODES", "WEIGHTS", "line_probabilities", "location_deviations"]

_FAR = 9.0  # standard deviations beyond which nothing happens
NODES, _RAW_WEIGHTS = np.polynomial.hermite_e.hermegauss(7)
WEIGHTS = _RAW_WEIGHTS / _RAW_WEIGHTS.sum()


def line_probabilities(
    points: NDArray[np.float64],
    allowed_mm: NDArray[np.float64],
    gradients: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
) -> NDArray[np.float64]:
    """Probability held by the lines along z1 at the nodes of the seven other axes, ``(m, 7, nodes)``.

    Parameters
    ----------
    points
        ``(m, 2, 3)`` mm, camera frame, in front of the camera.
    allowed_mm
        ``(m,)``: largest error of the image length that is right, mm.
    gradients
        ``(m, k, 8)`` per unit normal: of the length, mm, which gives z1; then of what the next axes are to follow.
    """
    allowed, size = allowed_mm[:, None, None], np.linalg.norm(gradients, axis=-1, keepdims=True)
    sigma, scaled = np.maximum(size[:, :1], 1e-12), gradients / np.maximum(size, 1e-300)
    seeds = np.concatenate([scaled, np.broadcast_to(np.eye(8), (len(points), 8, 8))], axis=1)
    axes = np.swapaxes(np.linalg.qr(np.swapaxes(seeds, -1, -2))[0], -1, -2)  # (m, 8, 8), an axis a row
    axes[:, 0] *= np.where(np.einsum("mp,mp->m", axes[:, 0], scaled[:, 0]) < 0, -1.0, 1.0)[:, None]
    offset = axes[:, 1:, None] * NODES[:, None]  # (m, 7, nodes, 8)
    camera_error = _ExactLength(points, camera, error)

    def border(sign: float) -> NDArray[np.float64]:
        """z1 where the length error is sign T L: one Newton step, then secants."""
        z = np.clip(sign * allowed / sigma, -_FAR, _FAR) + np.zeros(offset.shape[:-1])
        miss = camera_error(offset + z[..., None] * axes[:, None, None, 0]) - sign * allowed
        slope = np.broadcast_to(sigma, z.shape)
        for _ in range(2):
            step = np.clip(-miss / slope, -_FAR, _FAR)
            moved = np.clip(z + step, -_FAR, _FAR)
            again = camera_error(offset + moved[..., None] * axes[:, None, None, 0]) - sign * allowed
            secant = np.divide(again - miss, moved - z, out=slope.copy(), where=np.abs(moved - z) > 1e-6)
            slope = np.where(secant > 0.1 * sigma, secant, sigma)
            z, miss = moved, again
        return np.asarray(z - miss / slope)

    held = ndtr(border(1.0)) - ndtr(border(-1.0))
    return np.asarray(np.where(held > 0, held, 0.0))  # also where a line passes behind the camera


def location_deviations(points: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    """Standard deviations along u and v of what the camera adds to the difference of the ends' images, ``(m, 2)`` mm.

    Of a camera that is not plain what it adds along the image of a segment stands for either.
    """
    if camera.is_plain:
        steps = np.asarray(camera.quantization_step_mm) / np.sqrt(6)  # of the difference of two uniforms
        return np.asarray(np.broadcast_to(steps, (len(points), 2)))
    own = camera_errors(points, camera)
    deviation = np.sqrt(own.normal_variance_mm2 + (own.half_widths_mm**2).sum(axis=-1) / 6)
    return np.stack([deviation, deviation], axis=-1)


class _ExactLength:
    """Length errors of m segments for unit normals ``(m, ..., 8)``, with true rotations and the euclidean length."""

    def __init__(self, points: NDArray[np.float64], camera: Camera, error: PoseError) -> None:
        assert error.T_camera_frame is not None  # set by PoseError
        self.pose, self.factor = error.T_camera_frame, error.factor
        self.length_mm = np.linalg.norm(np.diff(camera.project(points), axis=-2)[:, 0], axis=-1)[:, None, None]
        self.ends = transform(invert(self.pose), points)  # pose error frame
        self.focal, self.steps = camera.principal_distance_mm, location_deviations(points, camera)[:, None, None]

    def __call__(self, normals: NDArray[np.float64]) -> NDArray[np.float64]:
        twist = normals[..., :6] @ self.factor.T
        (sx, sy, sz), (cx, cy, cz) = (np.moveaxis(g(twist[..., 3:]), -1, 0) for g in (np.sin, np.cos))
        images = []
        for end in (0, 1):
            x, y, z = self.ends[:, end].T[..., None, None]
            x, y = cz * x - sz * y, sz * x + cz * y
            z, x = cy * z - sy * x, sy * z + cy * x
            y, z = cx * y - sx * z, sx * y + cx * z
            moved = np.stack([x, y, z], axis=-1) + twist[..., :3]
            p = moved @ self.pose[:3, :3].T + self.pose[:3, 3]
            depth = np.where(p[..., 2] > 0, p[..., 2], np.nan)
            images.append(self.focal * p[..., :2] / depth[..., None])
        delta = images[1] - images[0] + normals[..., 6:] * self.steps
        return np.asarray(np.hypot(delta[..., 0], delta[..., 1]) - self.length_mm)
