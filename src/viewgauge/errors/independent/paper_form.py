"""The coefficients of eq. 7-10 and the covariances of eq. 13-14 as the paper writes them, with its errata marked.

The paper's camera frame has its origin in the image plane and the lens centre at z = f; its pose error acts about
that origin, and its image is the inverted one: with (X, Y, Z) in the optical frame C1 = X, C2 = Y, C3 = Z + f, the
error pivots at (0, 0, -f), and (u, v) of the paper is (-u, -v) here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..law import require_finite, require_not_negative

__all__ = ["covariance_numerator_denominator", "lambdas"]


def lambdas(c1: ArrayLike, c2: ArrayLike, c3: ArrayLike, f: ArrayLike, *, printed: bool = False) -> NDArray[np.float64]:
    """lambda_1 … lambda_21 of eq. 7 and 8, ``(..., 21)``; lambda_n is ``[..., n - 1]``.

    zeta = lambda_1..7 · e, xi = lambda_8..14 · e, chi = lambda_15..21 · e with
    ``e = [delta_x, delta_y, delta_z, d_x, d_y, d_z, 1]``: the paper puts rotations first.

    Erratum: lambda_20 is ``-(f - C3)``, printed ``f - C3``: the denominator of u' falls with d_z.

    Parameters
    ----------
    c1, c2, c3
        Point in the paper's camera frame, mm.
    f
        Focal length, mm.
    printed
        As printed, with the error: for comparison only.
    """
    names = ("c1", "c2", "c3", "f")
    C1, C2, C3, F = np.broadcast_arrays(*(require_finite(n, v) for n, v in zip(names, (c1, c2, c3, f), strict=True)))
    g, zero = F - C3, np.zeros(C1.shape)
    zeta = [F * C1 * C2, F * (g * C3 - C1**2), -F * C2 * g, F * g, zero, F * C1, zero]
    xi = [F * (C2**2 - g * C3), -F * C1 * C2, F * C1 * g, zero, F * g, F * C2, zero]
    chi = [-C2 * g, C1 * g, zero, zero, zero, g if printed else -g, g**2]
    return np.stack([*zeta, *xi, *chi], axis=-1)


def covariance_numerator_denominator(
    c1: ArrayLike,
    c2: ArrayLike,
    c3: ArrayLike,
    f: ArrayLike,
    sigma_rotation_rad: ArrayLike,
    sigma_translation_mm: ArrayLike,
    *,
    printed: bool = False,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cov(zeta, chi) and Cov(xi, chi), mm⁵, for equal rotations' and equal translations' sigmas (eq. 13, 14).

    ``Cov(zeta, chi) = f C1 (f - C3) ((f C3 - C1² - C2² - C3²) sigma_i² - sigma_j²)``, and C2 for C1 in the other.

    Erratum: printed ``+ sigma_j²``, which follows from the wrong lambda_20. With the right sign the last factor is
    negative wherever C3 > f, and the paper's proviso on it is always met: the correlation has the sign of C1.

    Parameters
    ----------
    c1, c2, c3, f
        As in :func:`lambdas`.
    sigma_rotation_rad, sigma_translation_mm
        sigma_i and sigma_j.
    printed
        As printed, with the error: for comparison only.
    """
    names = ("c1", "c2", "c3", "f")
    C1, C2, C3, F = (require_finite(n, v) for n, v in zip(names, (c1, c2, c3, f), strict=True))
    rotation = require_not_negative("sigma_rotation_rad", sigma_rotation_rad) ** 2
    translation = require_not_negative("sigma_translation_mm", sigma_translation_mm) ** 2
    factor = (F * C3 - C1**2 - C2**2 - C3**2) * rotation + (translation if printed else -translation)
    common = F * (F - C3) * factor
    return np.asarray(C1 * common), np.asarray(C2 * common)
