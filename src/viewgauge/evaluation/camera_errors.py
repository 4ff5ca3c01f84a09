"""What the camera itself adds to the error of an image length: quantization, edge location, calibration.

An image length is that of the ideal image: a point found in the pixels is put where a pinhole camera would have seen
it, by the calibration. So with ``D_i`` the derivative of the distortion at end i (identity for a pinhole), n the
direction of the image of the measurand and ``(alpha_i, beta_i) = n D_i^-1``:

- a location error of one pixel of end i along u counts ``alpha_i``, along v ``beta_i``. Quantization of the two ends
  differs by the lens only; the half-widths of the triangular errors are those of the two ends' mean square, which keeps
  the variance;
- the noise of fitted or picked edge points has variance ``sigma² (alpha_i² + beta_i²)`` at each end; of a rim that is
  fitted by an ellipse, what the fit leaves of it (:func:`~viewgauge.errors.ellipse_chord_variance`), as seen by square
  pixels along the line of sight;
- an offset common to all edges moves both ends outwards, and counts twice;
- an error of the calibration moves what is read from a pixel, ``D_i^-1 d(fx x_d + cx, fy y_d + cy)/d theta``, at both
  ends and at every acquisition by the same error of theta.

In tangents of image directions; the gradients are per px of fx, fy, cx, cy, per unit of each coefficient of the lens
and per px of the offset, in this order, and per standard deviation of each further error that is common.

These are the sources that compiled code knows, for its speed; what else a source says of itself is in
:mod:`viewgauge.error_sources`. A camera's ``further_errors`` are added in NumPy, and cost nothing where there are none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numba
import numpy as np
from numpy.typing import NDArray

from ..error_sources import LengthError, SourceKind, sources_of
from ..errors import line_end_variance
from ..errors.edge_location import chord_variance
from ..geometry import VIEWS, Lens
from ..geometry.lens import coefficient_derivatives, distorted
from ..part.measurand_table import MeasurandTable
from ..sensors import Camera

__all__ = ["CameraErrors", "PairCameraErrors", "camera_errors"]

_A, _B, _OWN, _GRADIENT = 0, 1, 2, 3  # places in a row of terms
_MOST = 4 + 12 + 1


@dataclass(frozen=True)
class CameraErrors:
    """The camera's errors of the lengths of segments ``(...)``, mm on the ideal image, along the image of each.

    Parameters
    ----------
    half_widths_mm
        ``(..., 2)``: of the triangular errors of quantization, along u and v.
    own_variance_mm2
        ``(...)``: of what is drawn anew at each acquisition, quantization apart: edge location above all.
    gradient
        ``(..., q)``: change of the image length per unit of each error that is common to all acquisitions.
    covariance
        ``(q, q)`` of those errors; q is 0 where there are none.
    anew_mm2
        By source the parts of ``own_variance_mm2``.
    places
        By source where its errors are among the q.
    """

    half_widths_mm: NDArray[np.float64]
    own_variance_mm2: NDArray[np.float64]
    gradient: NDArray[np.float64]
    covariance: NDArray[np.float64]
    anew_mm2: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    places: dict[str, slice] = field(default_factory=dict)

    @property
    def common_variance_mm2(self) -> NDArray[np.float64]:
        """``(...)``: of what is common to all acquisitions."""
        return np.asarray(np.einsum("...p,pq,...q->...", self.gradient, self.covariance, self.gradient))

    @property
    def normal_variance_mm2(self) -> NDArray[np.float64]:
        """``(...)``: of all but quantization."""
        return np.asarray(self.own_variance_mm2 + self.common_variance_mm2)


class _Parameters:
    """A camera as compiled code takes it."""

    def __init__(self, camera: Camera) -> None:
        edge_detector = camera.edge_detector
        self.lens = (camera.lens or Lens("radial-tangential", (0.0, 0.0, 0.0, 0.0))).parameters
        steps = np.asarray(camera.quantization_step_mm) / camera.principal_distance_mm
        point = end = fits = bias = 0.0
        if edge_detector is not None:
            point = edge_detector.noise_px**2
            end = point
            if edge_detector.edge_points is not None:
                end, fits = point * line_end_variance(edge_detector.edge_points, edge_detector.clear_of_corner_px), 1.0
            bias = edge_detector.bias_px
        self.values = np.array([*steps, *camera.pitch_tangents, point, end, fits])
        calibration = (
            np.zeros((0, 0)) if camera.intrinsics_covariance is None else np.array(camera.intrinsics_covariance)
        )
        self.calibrated = len(calibration)
        self.places = {"calibration": slice(0, self.calibrated)} if self.calibrated else {}
        self.covariance = np.zeros((self.calibrated + (bias > 0),) * 2)
        self.covariance[: self.calibrated, : self.calibrated] = calibration
        if bias > 0:
            self.covariance[-1, -1] = bias**2
            self.places["edge_offset"] = slice(self.calibrated, self.calibrated + 1)


def camera_errors(
    points: NDArray[np.float64], camera: Camera, rim_axis: NDArray[np.float64] | None = None
) -> CameraErrors:
    """What the camera adds to the error of segments.

    Parameters
    ----------
    points
        ``(..., 2, 3)`` mm, camera frame, in front of the camera.
    rim_axis
        ``(..., 3)``, camera frame: unit normal of the circle of which the segment is a diameter and whose whole rim is
        seen; zeros where it is none.
    """
    parameters = _Parameters(camera)
    flat = np.ascontiguousarray(points, dtype=float).reshape(-1, 2, 3)
    shape = points.shape[:-2]
    axes = np.zeros((len(flat), 3))
    if rim_axis is not None:
        axes[:] = np.broadcast_to(rim_axis, (*shape, 3)).reshape(-1, 3)
    terms = np.zeros((len(flat), _GRADIENT + _MOST))
    _segment_terms(flat, axes, parameters.values, parameters.lens, parameters.calibrated, terms)
    f, q = camera.principal_distance_mm, len(parameters.covariance)
    own = f**2 * terms[:, _OWN].reshape(shape)
    known = CameraErrors(
        f * terms[:, :_OWN].reshape(*shape, 2),
        own,
        f * terms[:, _GRADIENT : _GRADIENT + q].reshape(*shape, q),
        parameters.covariance,
        {"edge_noise": own},
        parameters.places,
    )
    for error in _further_errors(camera):
        known = _with_further(known, error, np.asarray(error.deviation_mm(points, camera)))
    return known


def _further_errors(camera: Camera) -> list[LengthError]:
    return [source for source in sources_of(camera) if isinstance(source, LengthError)]


def _with_further(known: CameraErrors, error: LengthError, deviation_mm: NDArray[np.float64]) -> CameraErrors:
    """Camera errors and one more, of which a standard deviation changes lengths by ``(...)`` mm."""
    if error.kind is SourceKind.ANEW:
        own = known.own_variance_mm2 + deviation_mm**2
        anew = known.anew_mm2 | {error.name: deviation_mm**2}
        return replace(known, own_variance_mm2=own, anew_mm2=anew)
    q = len(known.covariance)
    covariance = np.eye(q + 1)
    covariance[:q, :q] = known.covariance
    gradient = np.concatenate([known.gradient, deviation_mm[..., None]], axis=-1)
    places = known.places | {error.name: slice(q, q + 1)}
    return replace(known, gradient=gradient, covariance=covariance, places=places)


class PairCameraErrors:
    """What the camera adds for pairs of a block of viewpoints and a table of measurands, compiled; in tangents."""

    def __init__(self, measurands: MeasurandTable, camera: Camera) -> None:
        self._points, self._axes = np.ascontiguousarray(measurands.points), np.ascontiguousarray(measurands.rim_axis)
        self._parameters = _Parameters(camera)
        self._camera, self._further = camera, _further_errors(camera)

    def of(
        self, views: NDArray[np.float64], viewpoint: NDArray[np.int64], measurand: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """``(3, p)``: the two half-widths, and the variance of all but quantization, of pairs ``(p,)``."""
        parameters = self._parameters
        out = np.empty((3, len(viewpoint)))
        _pair_terms(
            views,
            np.ascontiguousarray(viewpoint),
            np.ascontiguousarray(measurand),
            self._points,
            self._axes,
            parameters.values,
            parameters.lens,
            parameters.calibrated,
            parameters.covariance,
            out,
        )
        if self._further:
            seen = np.isfinite(out[2])
            points = _points_of_pairs(views, viewpoint[seen], self._points[measurand[seen]])
            for error in self._further:
                out[2, seen] += (
                    np.asarray(error.deviation_mm(points, self._camera)) / self._camera.principal_distance_mm
                ) ** 2
        return out


def _points_of_pairs(
    views: NDArray[np.float64], viewpoint: NDArray[np.int64], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """``(p, 2, 3)`` mm, camera frame: points ``(p, 2, 3)`` of the part, each in the view of its viewpoint ``(p,)``."""
    rows = views[: 12 * VIEWS].reshape(12, VIEWS)[:, viewpoint]
    rotation, shift = rows[:9].reshape(3, 3, -1), rows[9:]
    return np.asarray(np.einsum("ijp,pej->pei", rotation, points) + shift.T[:, None])


@numba.njit(error_model="numpy")
def _terms(p, axis, values, lens, calibrated, work, out):  # type: ignore[no-untyped-def]
    """One segment: p ``(2, 3)`` and the rim's axis, camera frame; work ``(4, 12)``; out ``(20,)``."""
    step_u, step_v, pitch_u, pitch_v = values[0], values[1], values[2], values[3]
    x1, y1, x2, y2 = p[0, 0] / p[0, 2], p[0, 1] / p[0, 2], p[1, 0] / p[1, 2], p[1, 1] / p[1, 2]
    dx, dy = x2 - x1, y2 - y1
    length = math.hypot(dx, dy)
    c, s = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    xd1, yd1, a, b, d, e = distorted(lens, x1, y1)
    turned = a * e - b * d
    outwards = 1.0 / math.hypot((a * c + b * s) / pitch_u, (d * c + e * s) / pitch_v)  # of a px along the image
    alpha1, beta1 = (c * e - s * d) / turned, (s * a - c * b) / turned  # (c, s) D^-1
    xd2, yd2, a, b, d, e = distorted(lens, x2, y2)
    turned = a * e - b * d
    outwards += 1.0 / math.hypot((a * c + b * s) / pitch_u, (d * c + e * s) / pitch_v)
    alpha2, beta2 = (c * e - s * d) / turned, (s * a - c * b) / turned
    out[_A] = step_u * math.sqrt(0.5 * (alpha1 * alpha1 + alpha2 * alpha2))
    out[_B] = step_v * math.sqrt(0.5 * (beta1 * beta1 + beta2 * beta2))
    both = (alpha1**2 + alpha2**2) * pitch_u**2 + (beta1**2 + beta2**2) * pitch_v**2  # of one px² at each end
    own = values[5] * both
    if values[6] > 0.0 and axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] > 0.5:
        mx, my, mz = p[0, 0] + p[1, 0], p[0, 1] + p[1, 1], p[0, 2] + p[1, 2]
        wx, wy, wz = p[1, 0] - p[0, 0], p[1, 1] - p[0, 1], p[1, 2] - p[0, 2]
        per_sight = 1.0 / math.sqrt(mx * mx + my * my + mz * mz)
        ratio = abs(axis[0] * mx + axis[1] * my + axis[2] * mz) * per_sight
        # the long axis of the ellipse is across the sight, in the plane of the circle
        lx, ly, lz = axis[1] * mz - axis[2] * my, axis[2] * mx - axis[0] * mz, axis[0] * my - axis[1] * mx
        size = math.sqrt((lx * lx + ly * ly + lz * lz) * (wx * wx + wy * wy + wz * wz))
        cosine = min(abs(lx * wx + ly * wy + lz * wz) / size, 1.0) if ratio < 0.9999 and size > 0.0 else 1.0
        px = math.sqrt(0.5 * both)  # tangent per px along the chord
        shortened = math.sqrt(cosine * cosine + ratio * ratio * (1.0 - cosine * cosine))
        semi_axis = 0.5 * length / px / max(shortened, 1e-3)
        own = values[4] * chord_variance(semi_axis, ratio, cosine) * px * px if semi_axis > 0.0 else math.inf
    out[_OWN] = own
    for j in range(calibrated):
        out[_GRADIENT + j] = 0.0
    if calibrated > 0:
        out[_GRADIENT] = (alpha2 * xd2 - alpha1 * xd1) * pitch_u
        out[_GRADIENT + 1] = (beta2 * yd2 - beta1 * yd1) * pitch_v
        out[_GRADIENT + 2] = (alpha2 - alpha1) * pitch_u
        out[_GRADIENT + 3] = (beta2 - beta1) * pitch_v
        coefficient_derivatives(lens, x1, y1, work[:2])
        coefficient_derivatives(lens, x2, y2, work[2:])
        for j in range(calibrated - 4):
            out[_GRADIENT + 4 + j] = alpha2 * work[2, j] + beta2 * work[3, j] - alpha1 * work[0, j] - beta1 * work[1, j]
    out[_GRADIENT + calibrated] = outwards


@numba.njit(
    "void(float64[:,:,::1], float64[:,::1], float64[::1], float64[::1], int64, float64[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _segment_terms(points, axes, values, lens, calibrated, out):  # type: ignore[no-untyped-def]
    work = np.zeros((4, 12))
    for k in range(len(points)):
        _terms(points[k], axes[k], values, lens, calibrated, work, out[k])


@numba.njit(
    "void(float64[::1], int64[::1], int64[::1], float64[:,:,::1], float64[:,::1], float64[::1], float64[::1], int64, "
    "float64[:,::1], float64[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _pair_terms(views, viewpoint, measurand, points, axes, values, lens, calibrated, covariance, out):  # type: ignore[no-untyped-def]
    work, row, p, axis = np.zeros((4, 12)), np.zeros(_GRADIENT + _MOST), np.empty((2, 3)), np.empty(3)
    common = len(covariance)
    for k in range(len(viewpoint)):
        s, g = viewpoint[k], measurand[k]
        for i in range(3):
            r0, r1 = views[3 * i * VIEWS + s], views[(3 * i + 1) * VIEWS + s]
            r2, shift = views[(3 * i + 2) * VIEWS + s], views[(9 + i) * VIEWS + s]
            axis[i] = r0 * axes[g, 0] + r1 * axes[g, 1] + r2 * axes[g, 2]
            for end in range(2):
                p[end, i] = r0 * points[g, end, 0] + r1 * points[g, end, 1] + r2 * points[g, end, 2] + shift
        if not (p[0, 2] > 0.0 and p[1, 2] > 0.0):
            out[:, k] = math.nan
            continue
        _terms(p, axis, values, lens, calibrated, work, row)
        variance = row[_OWN]
        for i in range(common):
            inner = 0.5 * covariance[i, i] * row[_GRADIENT + i]
            for j in range(i):
                inner += covariance[i, j] * row[_GRADIENT + j]
            variance += 2.0 * row[_GRADIENT + i] * inner
        out[0, k], out[1, k], out[2, k] = row[_A], row[_B], max(variance, 0.0)
