"""Image length of a segment from its pose before the camera (paper, eq. 21-22)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .law import require_finite, require_not_negative

__all__ = ["projected_length", "projected_length_on_axis"]


def projected_length(
    length_mm: ArrayLike,
    beta_rad: ArrayLike,
    t_x_mm: ArrayLike,
    t_y_mm: ArrayLike,
    t_z_mm: ArrayLike,
    focal_length_mm: ArrayLike,
) -> NDArray[np.float64]:
    """Image length of a segment, mm (eq. 21); all arguments broadcast.

    With D = f + t_z and h = (L_w/2) cos(beta)::

        L = L_w f sqrt( t_x² cos² beta + (D sin beta - t_y cos beta)² ) / (D² - h²)

    Parameters
    ----------
    length_mm
        L_w, length of the segment in space, mm.
    beta_rad
        Angle between the segment and the viewing direction, rad; the segment's direction is (0, sin beta, cos beta).
    t_x_mm, t_y_mm
        Centre of the segment, mm, camera frame.
    t_z_mm
        Depth of the centre from the paper's image plane side: its depth from the centre of projection is f + t_z.
    focal_length_mm
        f, mm.

    Returns
    -------
    mm on the image; NaN where an end is not in front of the lens (D <= |h|).
    """
    Lw = require_not_negative("length_mm", length_mm)
    beta, f = require_finite("beta_rad", beta_rad), require_not_negative("focal_length_mm", focal_length_mm)
    x, y = require_finite("t_x_mm", t_x_mm), require_finite("t_y_mm", t_y_mm)
    D = f + require_finite("t_z_mm", t_z_mm)
    h = np.abs(Lw * np.cos(beta) / 2)
    across = np.hypot(x * np.cos(beta), D * np.sin(beta) - y * np.cos(beta))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(h < D, Lw * f * across / ((D - h) * (D + h)), np.nan)


def projected_length_on_axis(
    length_mm: ArrayLike, beta_rad: ArrayLike, distance_mm: ArrayLike, focal_length_mm: ArrayLike
) -> NDArray[np.float64]:
    """Image length of a segment whose centre the camera points at, mm (eq. 22).

    ``L = L_w f |sin beta| (d + f) / ((d + f)² - L_w² cos² beta / 4)``: eq. 21 with t_x = t_y = 0 and t_z = d.

    Erratum: the denominator is printed with ``+ L_w² cos² beta / 4``, which contradicts eq. 21. A length is not
    negative: of sin beta the absolute value is taken.

    Parameters
    ----------
    length_mm, beta_rad, focal_length_mm
        As in :func:`projected_length`.
    distance_mm
        d, mm.
    """
    return projected_length(length_mm, beta_rad, 0.0, 0.0, distance_mm, focal_length_mm)
