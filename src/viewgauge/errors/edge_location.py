"""How well an edge can be located in a noisy image, and what a fitted line or ellipse leaves of it.

All in px, standard deviations across the edge. White noise of the pixels, an edge whose profile is a step blurred by a
Gaussian and integrated over the pixel.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from ..exceptions import InputError
from .law import require_not_negative

__all__ = ["edge_point_deviation", "ellipse_chord_variance", "line_end_variance"]

_PHASES = np.linspace(-0.5, 0.5, 32, endpoint=False) + 1 / 64  # of the edge within its pixel
_QUARTER = 48  # nodes over a quarter of an ellipse


def edge_point_deviation(
    signal_to_noise: ArrayLike, blur_px: ArrayLike, samples: int = 1, smoothing_px: float | None = None
) -> NDArray[np.float64]:
    """Standard deviation of the place of one edge point, px.

    Without ``smoothing_px`` the Cramér-Rao bound, which the best edge detector (a fitted profile) reaches: with the
    profile ``m_i(x) = A integral of Phi((t - x)/s) over pixel i`` and noise sigma the Fisher information of x is
    ``sum_i (dm_i/dx)² / sigma²`` for each of the scan lines (Kakarala and Hero, *IEEE PAMI* 14 (1992) 777-781),
    averaged here over where in its pixel the edge lies. With it that of the steepest place of the profile smoothed by a
    Gaussian of that deviation: ``var = (3 sqrt(pi)/4) s_t⁶ / s_f⁵ (sigma/A)²``, ``s_t² = s² + 1/12 + s_f²`` (Canny,
    *IEEE PAMI* 8 (1986) 679-698, eq. 10).

    Parameters
    ----------
    signal_to_noise
        A/sigma: step of the edge over the standard deviation of a pixel's noise; any shape.
    blur_px
        Standard deviation s of the lens's blur; broadcast against it.
    samples
        Independent scan lines that make one edge point.
    smoothing_px
        Of an edge detector that looks for the steepest place; None for the best one.

    Raises
    ------
    InputError
        If a number is not positive (the blur may be 0).
    """
    ratio, blur = np.asarray(signal_to_noise, dtype=float), require_not_negative("blur_px", blur_px)
    if not (np.isfinite(ratio) & (ratio > 0)).all():
        raise InputError("must be positive", key="signal_to_noise", got=signal_to_noise)
    if samples < 1:
        raise InputError("must be at least 1", key="samples", got=samples)
    if smoothing_px is None:
        reach = math.ceil(6 * float(blur.max(initial=0.0))) + 1
        pixel = np.arange(-reach, reach + 1) - _PHASES[:, None]
        s = np.maximum(blur, 1e-9)[..., None, None]
        slope = ndtr((pixel + 0.5) / s) - ndtr((pixel - 0.5) / s)
        deviation = 1 / np.sqrt((slope**2).sum(axis=-1).mean(axis=-1))
    else:
        if not smoothing_px > 0:
            raise InputError("must be positive", key="smoothing_px", got=smoothing_px)
        total = blur**2 + 1 / 12 + smoothing_px**2
        deviation = np.sqrt(0.75 * math.sqrt(math.pi) * total**3 / smoothing_px**5)
    return np.asarray(deviation / ratio / math.sqrt(samples))


def line_end_variance(points: int, clear_px: float = 0.0) -> float:
    """Variance of where a line fitted to edge points one px apart ends, for points of variance 1.

    ``1/n + (clear + (n - 1)/2)² / (n (n² - 1)/12)``: of a straight-line fit, beyond its last point by ``clear_px``
    (Förstner and Wrobel, *Photogrammetric Computer Vision*, 2016, sec. 10.5). One point is its own end.
    """
    if points < 1:
        raise InputError("must be at least 1", key="points", got=points)
    if points == 1:
        return 1.0
    return 1 / points + 12 * (clear_px + (points - 1) / 2) ** 2 / (points * (points**2 - 1))


def ellipse_chord_variance(semi_axis_px: ArrayLike, ratio: ArrayLike, angle_rad: ArrayLike) -> NDArray[np.float64]:
    """Variance of a diameter of an ellipse fitted to its whole rim, for edge points one px apart of variance 1.

    The five parameters of the ellipse are fitted by least squares of the distances from it, linearised; face-on the
    variance is ``12 / n`` with n the number of points, against 2 of two points alone.

    Parameters
    ----------
    semi_axis_px
        The long one; any shape.
    ratio
        Of the short one to it, in (0, 1].
    angle_rad
        Of the diameter, on the circle of which the ellipse is the image: 0 is the long axis.
    """
    arrays = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (semi_axis_px, ratio, angle_rad)))
    out = np.empty(arrays[0].size)
    _chord_variances(*(np.ascontiguousarray(a.ravel()) for a in arrays), out)
    return out.reshape(arrays[0].shape)


@numba.njit(error_model="numpy")
def chord_variance(semi_axis, ratio, cosine):  # type: ignore[no-untyped-def]
    """:func:`ellipse_chord_variance` of one diameter, with the cosine of its angle (compiled).

    With ``F = p0 x² + p1 x y + p2 y² + p3 x + p4 y - 1`` a point's distance from the ellipse is ``F/|grad F|``. By
    symmetry p1, and p3 with p4, are fitted apart from p0 and p2. In units of the long axis, at
    ``(cos t, ratio sin t)``, arc length ds = w dt and ``|grad F| = 2 w / ratio`` with
    ``w² = sin² t + ratio² cos² t``.
    """
    ratio = max(ratio, 1e-3)
    i40, i22, i04 = 0.0, 0.0, 0.0
    for k in range(_QUARTER):
        t = (k + 0.5) * (0.5 * math.pi / _QUARTER)
        cc, ss = math.cos(t) ** 2, math.sin(t) ** 2
        weight = ratio * ratio / math.sqrt(ss + ratio * ratio * cc)
        yy = ratio * ratio * ss
        i40 += cc * cc * weight
        i22 += cc * yy * weight
        i04 += yy * yy * weight
    scale = 0.5 * math.pi / _QUARTER * semi_axis  # a quarter four times, over four
    i40, i22, i04 = i40 * scale, i22 * scale, i04 * scale
    cc = min(cosine * cosine, 1.0)
    x, y = math.sqrt(cc), ratio * math.sqrt(1.0 - cc)
    # diameter 2 r with r = (p0 dx² + p1 dx dy + p2 dy²)^(-1/2): its derivatives are - r³ (dx², dx dy, dy²)
    r = math.sqrt(x * x + y * y)
    j0, j1, j2 = x * x * r, x * y * r, y * y * r
    return (i04 * j0 * j0 - 2.0 * i22 * j0 * j2 + i40 * j2 * j2) / (i40 * i04 - i22 * i22) + j1 * j1 / i22


@numba.njit("void(float64[::1], float64[::1], float64[::1], float64[::1])", cache=True, nogil=True, error_model="numpy")
def _chord_variances(semi_axis, ratio, angle, out):  # type: ignore[no-untyped-def]
    for k in range(len(out)):
        out[k] = chord_variance(semi_axis[k], ratio[k], math.cos(angle[k]))
