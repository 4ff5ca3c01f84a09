"""First-order effect of a camera's pose error on image points (paper, eq. 7-8; theory section 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["point_jacobian"]


def point_jacobian(points: ArrayLike, focal_length_mm: float) -> NDArray[np.float64]:
    """Derivative of the image point (u, v) with respect to [dx, dy, dz, rx, ry, rz].

    For a displacement p' = p + delta x p + d of a point p = (X, Y, Z)::

        J_u = (f/Z) [1, 0, -X/Z, -X Y/Z,      Z + X²/Z, -Y]
        J_v = (f/Z) [0, 1, -Y/Z, -Z - Y²/Z,   X Y/Z,     X]

    The error acts at the centre of projection; one that acts in another frame is brought there by
    :attr:`PoseError.adjoint` and :attr:`PoseError.camera_covariance`. These are the derivatives of eq. (7) and (8) with
    the sign of the paper's lambda_20 corrected.

    Parameters
    ----------
    points
        ``(..., 3)`` mm, camera frame, Z > 0.
    focal_length_mm
        Focal length, mm.

    Returns
    -------
    ``(..., 2, 6)``: mm/mm for translations, mm/rad for rotations.
    """
    p = np.asarray(points, dtype=float)
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    scale, xz, yz = focal_length_mm / z, x / z, y / z
    J = np.zeros((*p.shape[:-1], 2, 6))
    J[..., 0, 0] = J[..., 1, 1] = scale
    J[..., 0, 2], J[..., 1, 2] = -scale * xz, -scale * yz
    J[..., 0, 3], J[..., 1, 3] = -scale * xz * y, -scale * (z + yz * y)
    J[..., 0, 4], J[..., 1, 4] = scale * (z + xz * x), scale * xz * y
    J[..., 0, 5], J[..., 1, 5] = -scale * y, scale * x
    return J
