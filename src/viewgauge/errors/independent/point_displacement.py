"""Displacement error of an image point: from a pose error to the laws of u and v (paper, eq. 4-10)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError
from ..law import require_finite
from .normal_ratio import NormalRatio

__all__ = ["PointDisplacement"]


class PointDisplacement:
    """Error of an image point whose camera is displaced: eps_u = zeta/chi, eps_v = xi/chi (eq. 7, 8, 10).

    For a point p = (X, Y, Z) that moves by ``p' - p = delta x p + d`` in the camera frame, exactly for the small-angle
    rotation I + [delta]x of eq. 6 (no linearisation of the ratio; theory section 2)::

        zeta = f (Z dx' - X dz')      xi = f (Z dy' - Y dz')      chi = Z (Z + dz')

    with dx', dy', dz' the components of p' - p. All three are normal and correlated. The paper's own form, in its image
    plane frame, is in :mod:`paper_form`; the two agree.

    Parameters
    ----------
    point_mm
        ``(..., 3)`` mm, camera (optical) frame, Z not 0.
    focal_length_mm
        Broadcasts with ``(...)``.
    covariance
        ``(..., 6, 6)`` of [x, y, z, rx, ry, rz], mm and rad, translation first, left perturbation, camera frame, acting
        at the centre of projection: what ``PoseError.camera_covariance`` gives.

    Raises
    ------
    InputError
        If a shape is wrong, a value not finite, or a point lies in the plane of the lens (Z = 0).
    """

    def __init__(self, point_mm: ArrayLike, focal_length_mm: ArrayLike, covariance: ArrayLike) -> None:
        point = require_finite("point_mm", point_mm)
        f = require_finite("focal_length_mm", focal_length_mm)
        covariance = require_finite("covariance", covariance)
        if point.shape[-1:] != (3,):
            raise InputError("must be (..., 3)", key="point_mm", got=f"shape {point.shape}")
        if covariance.shape[-2:] != (6, 6):
            raise InputError("must be (..., 6, 6)", key="covariance", got=f"shape {covariance.shape}")
        X, Y, Z = point[..., 0], point[..., 1], point[..., 2]
        if (Z == 0).any():
            raise InputError("a point in the plane of the lens has no image", key="point_mm", got=point_mm)
        self.point_mm, self.focal_length_mm, self.covariance = point, f, covariance
        zero = np.zeros(np.broadcast_shapes(X.shape, f.shape))
        self.zeta_row = _row(f * Z, zero, -f * X, -f * X * Y, f * (Z * Z + X * X), -f * Z * Y)
        self.xi_row = _row(zero, f * Z, -f * Y, -f * (Z * Z + Y * Y), f * X * Y, f * Z * X)
        self.chi_row = _row(zero, zero, Z + zero, Z * Y + zero, -Z * X + zero, zero)
        self.mean_chi = np.asarray(Z * Z + zero)
        self._rows = np.stack([self.zeta_row, self.xi_row, self.chi_row], axis=-2)
        self.moments = np.asarray(self._rows @ covariance @ np.swapaxes(self._rows, -1, -2))

    @property
    def sigma_zeta(self) -> NDArray[np.float64]:
        """Standard deviation of zeta, mm³."""
        return self._sigma(0)

    @property
    def sigma_xi(self) -> NDArray[np.float64]:
        """Standard deviation of xi, mm³ (erratum: all its lambdas are squared)."""
        return self._sigma(1)

    @property
    def sigma_chi(self) -> NDArray[np.float64]:
        """Standard deviation of chi, mm²."""
        return self._sigma(2)

    @property
    def r_zeta_chi(self) -> NDArray[np.float64]:
        """Correlation of zeta and chi; 0 where one of them does not vary."""
        return self._correlation(0)

    @property
    def r_xi_chi(self) -> NDArray[np.float64]:
        """Correlation of xi and chi; 0 where one of them does not vary."""
        return self._correlation(1)

    @property
    def u(self) -> NormalRatio:
        """Law of the error of u, mm on the image (eq. 11)."""
        return NormalRatio(self.sigma_zeta, self.sigma_chi, self.r_zeta_chi, self.mean_chi)

    @property
    def v(self) -> NormalRatio:
        """Law of the error of v, mm on the image (eq. 12)."""
        return NormalRatio(self.sigma_xi, self.sigma_chi, self.r_xi_chi, self.mean_chi)

    @property
    def jacobian(self) -> NDArray[np.float64]:
        """First order of (eps_u, eps_v) in the pose error, ``(..., 2, 6)``: mm/mm and mm/rad."""
        return np.asarray(self._rows[..., :2, :] / self.mean_chi[..., None, None])

    def _sigma(self, which: int) -> NDArray[np.float64]:
        return np.asarray(np.sqrt(np.maximum(self.moments[..., which, which], 0.0)))

    def _correlation(self, which: int) -> NDArray[np.float64]:
        product = self._sigma(which) * self._sigma(2)
        r = np.divide(self.moments[..., which, 2], product, out=np.zeros(product.shape), where=product > 0)
        return np.asarray(np.clip(r, -1.0, 1.0))


def _row(*entries: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack(entries, axis=-1)
