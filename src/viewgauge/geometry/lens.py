"""Lens distortion: where a lens shows a point that a pinhole camera would show elsewhere.

Points are tangents of image directions, ``(x, y) = (X, Y)/Z``. There are two models, with their coefficients in the
order of OpenCV:

``radial-tangential`` (Brown 1971 with the rational radial part and the thin prism of Weng 1992): k1, k2, p1, p2, k3,
k4, k5, k6, s1, s2, s3, s4, of which the first 4, 5, 8 or 12 are given; ROS calls it plumb_bob and rational_polynomial,
Kalibr radtan. ``equidistant`` (Kannala and Brandt 2006): k1, k2, k3, k4 of ``theta + k1 theta³ + k2 theta^5 ...``;
OpenCV calls it fisheye, Kalibr equi.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError

__all__ = ["COEFFICIENTS", "WIDEST_TANGENT", "Lens", "coefficient_derivatives", "distort_each", "distorted"]

COEFFICIENTS = {
    "radial-tangential": ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"),
    "equidistant": ("k1", "k2", "k3", "k4"),
}
"""Names of each model's coefficients, in order."""

WIDEST_TANGENT = math.tan(math.radians(89.0))
"""Of the angle from the optical axis up to which a lens is used: at 90 deg a point in front has no ideal image."""

_COUNTS = {"radial-tangential": (4, 5, 8, 12), "equidistant": (4,)}
_MOST = 12
_STEPS = 4  # from the centre to the point, so that the branch is that of the centre
_ROUNDS = 30
_CLOSE = 1e-13  # of the tangent: 1e-9 px


@dataclass(frozen=True)
class Lens:
    """A lens that distorts.

    Parameters
    ----------
    model
        "radial-tangential" or "equidistant".
    coefficients
        4, 5, 8 or 12 numbers for the former model, 4 for the latter; without unit.

    Raises
    ------
    InputError
        For an unknown model, another number of coefficients, or one that is not finite.
    """

    model: str
    coefficients: tuple[float, ...]

    def __post_init__(self) -> None:
        if self.model not in COEFFICIENTS:
            raise InputError("unknown lens model", key="model", got=self.model, expected=" or ".join(COEFFICIENTS))
        values = np.asarray(self.coefficients)
        counts = _COUNTS[self.model]
        if values.ndim != 1 or values.dtype.kind not in "iuf" or not np.isfinite(values).all():
            raise InputError("must be finite numbers", key="coefficients", got=self.coefficients)
        if len(values) not in counts:
            expected = " or ".join(map(str, counts)) + " numbers: " + ", ".join(COEFFICIENTS[self.model])
            got = f"{len(values)} numbers"
            raise InputError("another number of coefficients", key="coefficients", got=got, expected=expected)
        object.__setattr__(self, "coefficients", tuple(float(value) for value in values))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coefficients, in order."""
        return COEFFICIENTS[self.model][: len(self.coefficients)]

    @property
    def parameters(self) -> NDArray[np.float64]:
        """``(13,)``, for compiled code: the model (0 or 1), then its coefficients, padded with zeros."""
        parameters = np.zeros(1 + _MOST)
        parameters[0] = list(COEFFICIENTS).index(self.model)
        parameters[1 : 1 + len(self.coefficients)] = self.coefficients
        return parameters

    @property
    def field_tangent(self) -> float:
        """Tangent of the angle from the optical axis up to which the lens shows each direction in a place of its own.

        It is at most that of 89 deg, and the least of all directions around the axis.
        """
        return _field_tangent(self)

    def distort(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2)``: where the lens puts points ``(..., 2)``."""
        return self._each(points)[..., :2]

    def jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 2)``: derivative of :meth:`distort` with respect to the point."""
        values = self._each(points)[..., 2:]
        return values.reshape(*values.shape[:-1], 2, 2)

    def coefficient_jacobian(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, k)``: derivative of :meth:`distort` with respect to the coefficients."""
        p = np.asarray(points, dtype=float)
        out = np.zeros((p.size // 2, 2, _MOST))
        _coefficient_derivatives(self.parameters, np.ascontiguousarray(p.reshape(-1, 2)), out)
        return out[..., : len(self.coefficients)].reshape(*p.shape[:-1], 2, len(self.coefficients))

    def undistort(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2)``: the points that the lens puts there, to 1e-13; NaN where the lens puts none there.

        Newton's method goes from the centre outwards, so that of several such points the one is found that is joined to
        the centre.
        """
        p = np.asarray(points, dtype=float)
        out = np.empty((p.size // 2, 2))
        _undistorted(self.parameters, np.ascontiguousarray(p.reshape(-1, 2)), out)
        return out.reshape(p.shape)

    def _each(self, points: ArrayLike) -> NDArray[np.float64]:
        p = np.asarray(points, dtype=float)
        out = np.empty((p.size // 2, 6))
        _distorted(self.parameters, np.ascontiguousarray(p.reshape(-1, 2)), out)
        return out.reshape(*p.shape[:-1], 6)


@lru_cache(maxsize=64)
def _field_tangent(lens: Lens) -> float:
    around = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)
    direction = np.stack([np.cos(around), np.sin(around)], axis=-1)
    widest = math.atan(WIDEST_TANGENT)

    def grows(angle: NDArray[np.float64]) -> NDArray[np.bool_]:
        J = lens.jacobian(np.tan(angle)[..., None] * direction)
        return np.asarray((np.linalg.det(J) > 0) & (np.trace(J, axis1=-2, axis2=-1) > 0))

    angles = np.linspace(0.0, widest, 891)
    ok = np.array([grows(np.full(len(around), angle)) for angle in angles])  # (891, 72)
    turns = ~ok.all(axis=0)
    if not turns.any():
        return WIDEST_TANGENT
    first = np.where(turns, (~ok).argmax(axis=0), len(angles) - 1)
    inner, outer = angles[np.maximum(first - 1, 0)], angles[first]
    for _ in range(40):
        middle = (inner + outer) / 2
        shown = grows(middle)
        inner, outer = np.where(shown, middle, inner), np.where(shown, outer, middle)
    return math.tan(float(np.where(turns, inner, widest).min()))


def distort_each(parameters: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 2)``: where n lenses, by their parameters ``(n, 13)`` (:attr:`Lens.parameters`), put a point each."""
    out = np.empty((len(points), 2))
    _distorted_each(np.ascontiguousarray(parameters), np.ascontiguousarray(points), out)
    return out


@numba.njit(error_model="numpy")
def distorted(lens, x, y):  # type: ignore[no-untyped-def]
    """The place of one point, and its derivatives dx/dx, dx/dy, dy/dx, dy/dy (compiled; see :class:`Lens`)."""
    rr = x * x + y * y
    if lens[0] == 1.0:
        k1, k2, k3, k4 = lens[1], lens[2], lens[3], lens[4]
        if rr < 1e-8:
            g, slope = 1.0 + (k1 - 1.0 / 3.0) * rr, k1 - 1.0 / 3.0
        else:
            r = math.sqrt(rr)
            theta = math.atan(r)
            t = theta * theta
            g = theta * (1.0 + t * (k1 + t * (k2 + t * (k3 + t * k4)))) / r
            rise = (1.0 + t * (3.0 * k1 + t * (5.0 * k2 + t * (7.0 * k3 + t * 9.0 * k4)))) / (1.0 + rr)
            slope = (rise - g) / (2.0 * rr)
        return x * g, y * g, g + 2.0 * x * x * slope, 2.0 * x * y * slope, 2.0 * x * y * slope, g + 2.0 * y * y * slope
    k1, k2, p1, p2, k3, k4 = lens[1], lens[2], lens[3], lens[4], lens[5], lens[6]
    k5, k6, s1, s2, s3, s4 = lens[7], lens[8], lens[9], lens[10], lens[11], lens[12]
    above, below = 1.0 + rr * (k1 + rr * (k2 + rr * k3)), 1.0 + rr * (k4 + rr * (k5 + rr * k6))
    g = above / below
    slope = (k1 + rr * (2.0 * k2 + rr * 3.0 * k3) - g * (k4 + rr * (2.0 * k5 + rr * 3.0 * k6))) / below
    cross = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
    prism_u, prism_v = s1 + 2.0 * s2 * rr, s3 + 2.0 * s4 * rr
    return (
        x * g + 2.0 * p1 * x * y + p2 * (rr + 2.0 * x * x) + rr * (s1 + s2 * rr),
        y * g + p1 * (rr + 2.0 * y * y) + 2.0 * p2 * x * y + rr * (s3 + s4 * rr),
        g + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x + 2.0 * x * prism_u,
        cross + 2.0 * y * prism_u,
        cross + 2.0 * x * prism_v,
        g + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x + 2.0 * y * prism_v,
    )


@numba.njit(error_model="numpy")
def coefficient_derivatives(lens, x, y, out):  # type: ignore[no-untyped-def]
    """Write the derivatives of one point's place with respect to each coefficient into ``(2, 12)`` (compiled)."""
    rr = x * x + y * y
    if lens[0] == 1.0:
        r = math.sqrt(rr)
        theta = math.atan(r)
        power = theta * theta * (theta / r if r > 0.0 else 1.0)
        for j in range(4):
            out[0, j], out[1, j] = x * power, y * power
            power *= theta * theta
        return
    below = 1.0 + rr * (lens[6] + rr * (lens[7] + rr * lens[8]))
    g = (1.0 + rr * (lens[1] + rr * (lens[2] + rr * lens[5]))) / below
    power = rr / below
    for j in (0, 1, 4):
        out[0, j], out[1, j] = x * power, y * power
        power *= rr
    out[0, 2], out[1, 2] = 2.0 * x * y, rr + 2.0 * y * y
    out[0, 3], out[1, 3] = rr + 2.0 * x * x, 2.0 * x * y
    power = -g * rr / below
    for j in (5, 6, 7):
        out[0, j], out[1, j] = x * power, y * power
        power *= rr
    out[0, 8], out[1, 8], out[0, 9], out[1, 9] = rr, 0.0, rr * rr, 0.0
    out[0, 10], out[1, 10], out[0, 11], out[1, 11] = 0.0, rr, 0.0, rr * rr


@numba.njit("void(float64[::1], float64[:,::1], float64[:,::1])", cache=True, nogil=True, error_model="numpy")
def _distorted(lens, points, out):  # type: ignore[no-untyped-def]
    for k in range(len(points)):
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4], out[k, 5] = distorted(lens, points[k, 0], points[k, 1])


@numba.njit("void(float64[:,::1], float64[:,::1], float64[:,::1])", cache=True, nogil=True, error_model="numpy")
def _distorted_each(lenses, points, out):  # type: ignore[no-untyped-def]
    for k in range(len(points)):
        out[k, 0], out[k, 1], _, _, _, _ = distorted(lenses[k], points[k, 0], points[k, 1])


@numba.njit("void(float64[::1], float64[:,::1], float64[:,:,::1])", cache=True, nogil=True, error_model="numpy")
def _coefficient_derivatives(lens, points, out):  # type: ignore[no-untyped-def]
    for k in range(len(points)):
        coefficient_derivatives(lens, points[k, 0], points[k, 1], out[k])


@numba.njit("void(float64[::1], float64[:,::1], float64[:,::1])", cache=True, nogil=True, error_model="numpy")
def _undistorted(lens, points, out):  # type: ignore[no-untyped-def]
    for k in range(len(points)):
        x, y, found = 0.0, 0.0, True
        for step in range(1, _STEPS + 1):
            u, v = points[k, 0] * step / _STEPS, points[k, 1] * step / _STEPS
            miss = math.inf
            for _ in range(_ROUNDS):
                xd, yd, a, b, c, d = distorted(lens, x, y)
                turned = a * d - b * c
                miss = abs(u - xd) + abs(v - yd)
                if not (turned > 0.0 and a + d > 0.0):
                    miss = math.inf
                    break
                if miss <= _CLOSE * (1.0 + abs(u) + abs(v)):
                    break
                x, y = x + (d * (u - xd) - b * (v - yd)) / turned, y + (a * (v - yd) - c * (u - xd)) / turned
            found = found and miss <= 100 * _CLOSE * (1.0 + abs(u) + abs(v))
        out[k, 0], out[k, 1] = (x, y) if found else (math.nan, math.nan)
