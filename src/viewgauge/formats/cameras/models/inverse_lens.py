"""Lens models that lead from the pixel to the ray, or otherwise than here, replaced by a radial-tangential lens.

The replacement is fitted over the whole image and a little beyond; what remains is found on a denser grid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....geometry import Lens

__all__ = [
    "LARGEST_RESIDUAL_PX",
    "ImageFrame",
    "ReplacedLens",
    "brown_conrady_rays",
    "division_rays",
    "modified_brown_conrady_rays",
    "replaced_lens",
]

LARGEST_RESIDUAL_PX = 0.01
"""The most that a replacement may differ anywhere in the image."""

_COUNTS = (5, 8)  # coefficients: the fewest that are close enough
_GRID, _DENSER = 41, 97
_BEYOND = 0.01  # of the image's size, so that the corner pixels' edges are within
_ENOUGH_PX = 1e-3

Rays = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""From places in the image ``(n, 2)``, as tangents from the principal point, to tangents of the rays ``(n, 2)``."""


@dataclass(frozen=True)
class ImageFrame:
    """Where the image lies around the principal point.

    Parameters
    ----------
    focal_length_px, principal_point_px
        fx and fy, cx and cy.
    resolution
        Columns and rows.
    """

    focal_length_px: tuple[float, float]
    principal_point_px: tuple[float, float]
    resolution: tuple[int, int]

    def grid(self, count: int, beyond: float = 0.0) -> NDArray[np.float64]:
        """``(count², 2)``: places over the image, as tangents from the principal point."""
        axes = [
            (np.linspace(-0.5 - beyond * n, n - 0.5 + beyond * n, count) - c) / f
            for n, c, f in zip(self.resolution, self.principal_point_px, self.focal_length_px, strict=True)
        ]
        return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)


@dataclass(frozen=True)
class ReplacedLens:
    """A radial-tangential lens in place of another model.

    Parameters
    ----------
    residual_px
        The largest distance between the two anywhere in the image.
    """

    lens: Lens
    residual_px: float


def replaced_lens(rays: Rays, frame: ImageFrame) -> ReplacedLens | None:
    """The radial-tangential lens that shows the rays most nearly in the same places; None where there is none.

    Parameters
    ----------
    rays
        The other model: the ray of each place in the image.
    """
    best: ReplacedLens | None = None
    for count in _COUNTS:
        lens = _fitted(rays, frame, count)
        if lens is None:
            continue
        residual = _residual_px(lens, rays, frame)
        if best is None or residual < best.residual_px:
            best = ReplacedLens(lens, residual)
        if best.residual_px <= _ENOUGH_PX:
            break
    return best


def division_rays(kappa: float) -> Rays:
    """The division model: a place x is that of the ray ``x / (1 + kappa |x|²)`` (tangents).

    References
    ----------
    Fitzgibbon, *Simultaneous linear estimation of multiple view geometry and lens distortion*, CVPR 2001.
    """

    def rays(places: NDArray[np.float64]) -> NDArray[np.float64]:
        square = (places**2).sum(axis=1, keepdims=True)
        return np.asarray(places / (1 + kappa * square))

    return rays


def brown_conrady_rays(coefficients: tuple[float, ...]) -> Rays:
    """The radial-tangential model from the place to the ray: k1, k2, p1, p2, k3 (tangents)."""
    return Lens("radial-tangential", coefficients).distort


def _fitted(rays: Rays, frame: ImageFrame, count: int) -> Lens | None:
    """By linear least squares: of polynomials at once, of quotients with the weights of the step before."""
    places = frame.grid(_GRID, _BEYOND)
    points = rays(places)
    if not np.isfinite(points).all():
        return None
    x, y = points.T
    square = x**2 + y**2
    zero = np.zeros_like(x)
    below = np.ones_like(x)
    values = np.zeros(count)
    for _ in range(1 if count == 5 else 8):
        columns = [(x * square, y * square), (x * square**2, y * square**2)]
        columns += [(2 * x * y * below, (square + 2 * y**2) * below), ((square + 2 * x**2) * below, 2 * x * y * below)]
        columns += [(x * square**3, y * square**3)]
        if count == 8:
            columns += [tuple(-places.T * square**power) for power in (1, 2, 3)]
        weight = np.concatenate([np.full_like(x, frame.focal_length_px[0]), zero + frame.focal_length_px[1]])
        weight /= np.concatenate([below, below])
        A = np.stack([np.concatenate(column) for column in columns], axis=1) * weight[:, None]
        b = np.concatenate(places.T - points.T) * weight
        scale = np.linalg.norm(A, axis=0)
        scale[scale == 0] = 1.0
        values = np.linalg.lstsq(A / scale, b, rcond=1e-10)[0] / scale
        if count == 8:
            below = 1 + square * (values[5] + square * (values[6] + square * values[7]))
            if not (below > 0).all():
                return None
    return Lens("radial-tangential", tuple(float(value) for value in values))


def _residual_px(lens: Lens, rays: Rays, frame: ImageFrame) -> float:
    places = frame.grid(_DENSER)
    difference = (lens.distort(rays(places)) - places) * np.asarray(frame.focal_length_px)
    back = lens.undistort(places)
    return float(np.linalg.norm(difference, axis=1).max()) if np.isfinite(back).all() else np.inf


def modified_brown_conrady_rays(coefficients: tuple[float, ...]) -> Rays:
    """The model whose tangential part acts on what the radial part gives, as some depth cameras have it."""
    usual = Lens("radial-tangential", coefficients)
    k1, k2, p1, p2, k3 = coefficients

    def places_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
        square = (points**2).sum(axis=1)
        x, y = points.T * (1 + square * (k1 + square * (k2 + square * k3)))
        return np.stack([x + 2 * p1 * x * y + p2 * (square + 2 * x**2),
                         y + 2 * p2 * x * y + p1 * (square + 2 * y**2)], axis=1)  # fmt: skip

    def rays(places: NDArray[np.float64]) -> NDArray[np.float64]:
        points = usual.undistort(places)
        for _ in range(20):
            points = usual.undistort(places - (places_of(points) - usual.distort(points)))
        return points

    return rays
