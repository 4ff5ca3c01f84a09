"""From viewpoints and measurands to probabilities: the compiled joint model (theory sections 5 and 6).

The same mathematics as :func:`~viewgauge.evaluation.image_segment` with "joint", for all pairs of a block of viewpoints
and some measurands. Two compiled passes over a tile of pairs that stays in the second-level cache: projection,
Jacobian, variance and quantization here; the law of the total error in :mod:`viewgauge.errors.joint.closed_form_array`.

Everything is in units of the focal length (tangents of image directions), in which the probability does not depend on
it. With ``(x_i, y_i) = (X_i, Y_i)/Z_i``, l the length of their difference and (c, s) its direction, the Jacobian of the
length (``cos g (J_u2 - J_u1) + sin g (J_v2 - J_v1)`` with J from :func:`~viewgauge.geometry.point_jacobian`) is ::

    [c d(1/Z),  s d(1/Z),  -c d(x/Z) - s d(y/Z),  -c d(xy) - s d(y²),  c d(x²) + s d(xy),  0]

where d is end minus start: a turn about the optical axis changes no length. Its variance is ``|R J|²`` with R the
triangular factor of the covariance of the other five.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ...errors.joint.closed_form_array import central_probability_into
from ...geometry import VIEWS, PoseError
from ...part.measurand_table import MeasurandTable
from ...sensors import Camera
from ...visibility import VISIBLE
from ..camera_errors import PairCameraErrors

__all__ = ["ProbabilityKernel"]

_MEASURANDS = 32
"""Measurands in a tile: with 256 viewpoints 8192 pairs, whose values fill a third of a typical second-level cache."""
_PAIRS = _MEASURANDS * VIEWS


class ProbabilityKernel:
    """The joint model's probability of every pair of a block of viewpoints and a table of measurands.

    Parameters
    ----------
    tolerance
        ``(g,)``: relative tolerance T of each measurand.
    """

    def __init__(
        self, measurands: MeasurandTable, tolerance: NDArray[np.float64], camera: Camera, error: PoseError
    ) -> None:
        self._points = np.ascontiguousarray(measurands.points)
        self._tolerance = np.ascontiguousarray(tolerance, dtype=float)
        factor = (error.adjoint @ error.factor)[:5]
        R = np.asarray(np.linalg.qr(factor.T, mode="r"))
        steps = np.asarray(camera.quantization_step_mm) / camera.principal_distance_mm
        self._parameters = np.array([*R[np.triu_indices(5)], *steps])
        self._camera = None if camera.is_plain else PairCameraErrors(measurands, camera)

    def probabilities(
        self, views: NDArray[np.float64], count: int, reason: NDArray[np.int8]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """``(g, 256)`` probabilities Pr{|error| <= T L}, and the margin that ranks equal ones.

        Parameters
        ----------
        views
            From :func:`~viewgauge.geometry.view_block`; the first ``count`` of them are evaluated.
        reason
            ``(g, 256)`` from :class:`~viewgauge.visibility.Culling`: pairs that are not visible get 0 and 0.

        Returns
        -------
        The probabilities, to 1e-11, and T L in units of the standard deviation of the total error, squared.
        """
        measurands = len(self._points)
        probability, margin = np.zeros((measurands, VIEWS)), np.zeros((measurands, VIEWS))
        values, place = np.empty(6 * _PAIRS), np.empty(_PAIRS, np.int64)
        x, sigma, a, b, ratio, law = values.reshape(6, _PAIRS)
        for first in range(0, measurands, _MEASURANDS):
            tile = slice(first, first + _MEASURANDS)
            n = _lengths(
                views, count, self._points[tile], self._tolerance[tile], self._parameters, reason[tile], values, place
            )
            if self._camera is not None:
                self._add_camera(self._camera, views, place[:n], first, values.reshape(6, _PAIRS)[:, :n])
            central_probability_into(x[:n], sigma[:n], a[:n], b[:n], law[:n])
            _scatter(place[:n], law, ratio, probability[tile].reshape(-1), margin[tile].reshape(-1))
        return probability, margin

    @staticmethod
    def _add_camera(
        camera: PairCameraErrors,
        views: NDArray[np.float64],
        place: NDArray[np.int64],
        first: int,
        values: NDArray[np.float64],
    ) -> None:
        """What a camera that is not plain adds to the errors of a tile, which have its quantization as if it were."""
        measurand, viewpoint = np.divmod(place, VIEWS)
        a, b, variance = camera.of(views, viewpoint, first + measurand)
        total = values[1] ** 2 + variance
        values[1], values[2], values[3] = np.sqrt(total), a, b
        values[4] = values[0] ** 2 / np.maximum(total + (a**2 + b**2) / 6, 1e-300)


@numba.njit("void(int64[::1], float64[::1], float64[::1], float64[::1], float64[::1])", cache=True, nogil=True)
def _scatter(place, law, ratio, probability, margin):  # type: ignore[no-untyped-def]
    for k in range(len(place)):
        probability[place[k]], margin[place[k]] = law[k], ratio[k]


@numba.njit(error_model="numpy", fastmath={"contract", "nsz"}, forceinline=True)
def _length(views, s, x1, y1, z1, x2, y2, z2, T, R):  # type: ignore[no-untyped-def]
    """Allowed error, variance, two half-widths, squared margin of the pair with viewpoint s."""
    r0, r1, r2 = views[s], views[VIEWS + s], views[2 * VIEWS + s]
    r3, r4, r5 = views[3 * VIEWS + s], views[4 * VIEWS + s], views[5 * VIEWS + s]
    r6, r7, r8 = views[6 * VIEWS + s], views[7 * VIEWS + s], views[8 * VIEWS + s]
    cx, cy, cz = views[9 * VIEWS + s], views[10 * VIEWS + s], views[11 * VIEWS + s]
    w1 = 1.0 / (r6 * x1 + r7 * y1 + r8 * z1 + cz)
    w2 = 1.0 / (r6 * x2 + r7 * y2 + r8 * z2 + cz)
    u1, v1 = (r0 * x1 + r1 * y1 + r2 * z1 + cx) * w1, (r3 * x1 + r4 * y1 + r5 * z1 + cy) * w1
    u2, v2 = (r0 * x2 + r1 * y2 + r2 * z2 + cx) * w2, (r3 * x2 + r4 * y2 + r5 * z2 + cy) * w2
    du, dv = u2 - u1, v2 - v1
    length = math.sqrt(du * du + dv * dv)
    per_length = 1.0 / length
    c = du * per_length if length > 0.0 else 1.0
    n = dv * per_length if length > 0.0 else 0.0
    d_w, d_uv = w2 - w1, u2 * v2 - u1 * v1
    j0, j1 = c * d_w, n * d_w
    j2 = -c * (u2 * w2 - u1 * w1) - n * (v2 * w2 - v1 * w1)
    j3 = -c * d_uv - n * (v2 + v1) * dv
    j4 = c * (u2 + u1) * du + n * d_uv
    e0 = R[0] * j0 + R[1] * j1 + R[2] * j2 + R[3] * j3 + R[4] * j4
    e1 = R[5] * j1 + R[6] * j2 + R[7] * j3 + R[8] * j4
    e2 = R[9] * j2 + R[10] * j3 + R[11] * j4
    e3 = R[12] * j3 + R[13] * j4
    e4 = R[14] * j4
    variance = e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3 + e4 * e4
    a, b = R[15] * abs(c), R[16] * abs(n)
    allowed = T * length
    return allowed, variance, a, b, allowed * allowed / max(variance + (a * a + b * b) * (1 / 6), 1e-300)


@numba.njit(
    "int64(float64[::1], int64, float64[:,:,::1], float64[::1], float64[::1], int8[:,::1], float64[::1], int64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
    fastmath={"contract", "nsz"},
)
def _lengths(views, count, points, tolerance, R, reason, values, place):  # type: ignore[no-untyped-def]
    """Rows of 8192 values of the visible pairs: allowed error, sigma, two half-widths, margin; and their places."""
    row = np.empty(5 * VIEWS)
    n = 0
    for g in range(len(points)):
        first = n
        for s in range(count):
            place[n] = g * VIEWS + s
            n += reason[g, s] == VISIBLE
        x1, y1, z1 = points[g, 0, 0], points[g, 0, 1], points[g, 0, 2]
        x2, y2, z2 = points[g, 1, 0], points[g, 1, 1], points[g, 1, 2]
        T = tolerance[g]
        if 2 * (n - first) > count:  # most are visible: all are computed, in order, which is faster than picking
            for s in range(count):
                allowed, variance, a, b, margin = _length(views, s, x1, y1, z1, x2, y2, z2, T, R)
                row[s], row[VIEWS + s], row[2 * VIEWS + s] = allowed, math.sqrt(variance), a
                row[3 * VIEWS + s], row[4 * VIEWS + s] = b, margin
            for k in range(first, n):
                s = place[k] - g * VIEWS
                for r in range(5):
                    values[r * _PAIRS + k] = row[r * VIEWS + s]
        else:
            for k in range(first, n):
                s = place[k] - g * VIEWS
                allowed, variance, a, b, margin = _length(views, s, x1, y1, z1, x2, y2, z2, T, R)
                values[k], values[_PAIRS + k], values[2 * _PAIRS + k] = allowed, math.sqrt(variance), a
                values[3 * _PAIRS + k], values[4 * _PAIRS + k] = b, margin
    return n
