"""What the table says of a pair of viewpoint and measurand beside its probability, compiled.

The formulas are those of :func:`~viewgauge.evaluation.image_segment` and of :mod:`~viewgauge.evaluation.validity`,
of which this is the screen that lets all but the doubtful pairs pass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from ...errors.joint.mean_absolute_array import mean_absolute_into
from ...geometry import VIEWS, PoseError
from ...part.measurand_table import MeasurandTable
from ...sensors import Camera
from ..camera_errors import PairCameraErrors

__all__ = ["PairColumns", "PairValues"]


@dataclass(frozen=True)
class PairValues:
    """Values of p pairs; NaN where an end of the measurand is not in front of the camera.

    Parameters
    ----------
    length_px, angle_rad
        Of the image, the angle from +u.
    sigma_displacement_px, sigma_quantization_px
        Standard deviations of the length error by the pose error and by the camera (quantization or an edge detector's
        noise, and calibration), along the image of the measurand.
    expected_accuracy
        1 - E|error| / L (eq. 20), not below 0.
    neglected
        Size of what the small-error model neglects (:mod:`~viewgauge.evaluation.validity`).
    """

    length_px: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    sigma_displacement_px: NDArray[np.float64]
    sigma_quantization_px: NDArray[np.float64]
    expected_accuracy: NDArray[np.float64]
    neglected: NDArray[np.float64]


class PairColumns:
    """Computes :class:`PairValues` by the joint model."""

    def __init__(self, measurands: MeasurandTable, camera: Camera, error: PoseError) -> None:
        self._points = np.ascontiguousarray(measurands.points)
        self._covariance = np.ascontiguousarray(error.camera_covariance)
        focal = camera.principal_distance_mm
        steps = np.asarray(camera.quantization_step_mm) / focal
        self._parameters = np.array([*steps, *(focal / np.asarray(camera.pixel_pitch_mm))])
        self._camera = None if camera.is_plain else PairCameraErrors(measurands, camera)

    def of(self, views: NDArray[np.float64], viewpoint: NDArray[np.int64], measurand: NDArray[np.int64]) -> PairValues:
        """Of pairs of a block of viewpoints (:func:`~viewgauge.geometry.view_block`): indices ``(p,)``."""
        out = self._rows(views, viewpoint, measurand)
        length, sigma, a, b = out[5:]
        if self._camera is not None:
            a, b, variance = self._camera.of(views, viewpoint, measurand)
            per_unit = np.divide(out[0], length, out=np.zeros(len(length)), where=length > 0)
            out[3] = np.sqrt(variance + (a**2 + b**2) / 6) * per_unit
            sigma = np.sqrt(sigma**2 + variance)
        mean_absolute = np.empty(len(length))
        mean_absolute_into(sigma, a, b, mean_absolute)
        relative = np.divide(mean_absolute, length, out=np.ones(len(length)), where=length > 0)
        return PairValues(out[0], out[1], out[2], out[3], np.maximum(1 - relative, 0.0), out[4])

    def neglected(
        self, views: NDArray[np.float64], viewpoint: NDArray[np.int64], measurand: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Of :meth:`of` the last alone, ``(p,)``."""
        return np.asarray(self._rows(views, viewpoint, measurand)[4])

    def _rows(
        self, views: NDArray[np.float64], viewpoint: NDArray[np.int64], measurand: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        out = np.empty((9, len(viewpoint)))
        viewpoint, measurand = np.ascontiguousarray(viewpoint), np.ascontiguousarray(measurand)
        _columns(views, viewpoint, measurand, self._points, self._covariance, self._parameters, out)
        return out


@numba.njit(error_model="numpy")
def _variance(S, v0, v1, v2, v3, v4, v5):  # type: ignore[no-untyped-def]
    v = (v0, v1, v2, v3, v4, v5)
    total = 0.0
    for i in range(6):
        inner = 0.5 * S[i, i] * v[i]
        for j in range(i):
            inner += S[i, j] * v[j]
        total += 2.0 * v[i] * inner
    return max(total, 0.0)


@numba.njit(
    "void(float64[::1], int64[::1], int64[::1], float64[:,:,::1], float64[:,::1], float64[::1], float64[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _columns(views, viewpoint, measurand, points, S, parameters, out):  # type: ignore[no-untyped-def]
    step_u, step_v, scale_u, scale_v = parameters[0], parameters[1], parameters[2], parameters[3]
    for k in range(len(viewpoint)):
        s, g = viewpoint[k], measurand[k]
        p = np.empty((2, 3))
        for end in range(2):
            x, y, z = points[g, end, 0], points[g, end, 1], points[g, end, 2]
            for i in range(3):
                p[end, i] = (
                    views[3 * i * VIEWS + s] * x
                    + views[(3 * i + 1) * VIEWS + s] * y
                    + views[(3 * i + 2) * VIEWS + s] * z
                    + views[(9 + i) * VIEWS + s]
                )
        if not (p[0, 2] > 0.0 and p[1, 2] > 0.0):
            out[:, k] = math.nan
            continue
        w1, w2 = 1.0 / p[0, 2], 1.0 / p[1, 2]
        u1, v1, u2, v2 = p[0, 0] * w1, p[0, 1] * w1, p[1, 0] * w2, p[1, 1] * w2
        du, dv = u2 - u1, v2 - v1
        length = math.hypot(du, dv)
        c, n = (du / length, dv / length) if length > 0.0 else (1.0, 0.0)
        d_w, d_uw, d_vw = w2 - w1, u2 * w2 - u1 * w1, v2 * w2 - v1 * w1
        d_uu, d_uv, d_vv = (u2 + u1) * du, u2 * v2 - u1 * v1, (v2 + v1) * dv
        a, b = step_u * abs(c), step_v * abs(n)
        along = _variance(S, c * d_w, n * d_w, -c * d_uw - n * d_vw, -c * d_uv - n * d_vv, c * d_uu + n * d_uv, 0.0)
        # across the image of the measurand; a turn about the optical axis moves it there by its whole length
        across = _variance(
            S, -n * d_w, c * d_w, n * d_uw - c * d_vw, n * d_uv - c * d_vv, -n * d_uu + c * d_uv, n * dv + c * du
        )
        across += ((step_u * n) ** 2 + (step_v * c) ** 2) * (1 / 6)
        depth, displacement = 0.0, 0.0
        for end in range(2):
            x, y, z = p[end, 0], p[end, 1], p[end, 2]
            z2 = z * z
            depth = max(depth, _variance(S, 0.0, 0.0, 1.0, y, -x, 0.0) / z2)
            # of the displacement across the line of sight: of all of it, less that along it (which no turn causes)
            total = _variance(S, 1.0, 0.0, 0.0, 0.0, z, -y) + _variance(S, 0.0, 1.0, 0.0, -z, 0.0, x)
            total += _variance(S, 0.0, 0.0, 1.0, y, -x, 0.0)
            total -= _variance(S, x, y, z, 0.0, 0.0, 0.0) / (x * x + y * y + z2)
            displacement = max(displacement, max(total, 0.0) / z2)
        spread = math.sqrt(along + (a * a + b * b) * (1 / 6))
        transverse = across / (length * length) if length > 0.0 else math.inf
        largest = math.sqrt(max(max(depth, displacement), transverse))
        bias = largest * largest * length / max(spread, 1e-300) if largest > 0.0 else 0.0
        per_unit = math.hypot(scale_u * c, scale_v * n)  # px per unit of the tangent, along the image
        out[0, k] = math.hypot(scale_u * du, scale_v * dv)
        out[1, k] = math.atan2(dv, du)
        out[2, k] = math.sqrt(along) * per_unit
        out[3, k] = math.sqrt((a * a + b * b) * (1 / 6)) * per_unit
        out[4, k] = math.inf if math.isnan(bias) else math.hypot(largest, bias)
        out[5, k], out[6, k], out[7, k], out[8, k] = length, math.sqrt(along), a, b
