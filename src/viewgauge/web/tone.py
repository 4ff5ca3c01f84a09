"""Colours that are still themselves after viser's page has drawn them.

three.js draws lines through a filmic tone curve, and takes the colours of their vertices for linear: both make them
pale. What is asked for here is what the curve
turns into the colour that is meant, as far as there is such a colour.

References
----------
``ACESFilmicToneMapping`` of three.js; the fit is by S. Hill, "Self Shadow: BakingLab, ACES.hlsl", 2016.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["before_tone_curve"]

_IN = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_OUT = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
_EXPOSURE = 1 / 0.6
_A, _B, _C, _D, _E = 0.0245786, -0.000090537, 0.983729, 0.4329510, 0.238081


def before_tone_curve(colours: NDArray[np.uint8], *, of_vertices: bool) -> NDArray[np.uint8]:
    """What is to be sent for sRGB ``(..., 3)`` to be drawn.

    Parameters
    ----------
    of_vertices
        Colours of single vertices, which the page takes for linear, and not one for all.
    """
    linear = _linear(np.asarray(colours, dtype=float) / 255)
    curved = np.clip(linear @ np.linalg.inv(_OUT).T, 0.0, 0.98)
    # v (v + A) + B = y (v (C v + D) + E), solved for v
    a, b, c = 1 - _C * curved, _A - _D * curved, _B - _E * curved
    v = (-b + np.sqrt(b**2 - 4 * a * c)) / (2 * a)
    meant = np.clip(v @ np.linalg.inv(_IN).T / _EXPOSURE, 0.0, 1.0)
    return np.rint(255 * (meant if of_vertices else _encoded(meant))).astype(np.uint8)


def _linear(value: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4))


def _encoded(value: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055))
