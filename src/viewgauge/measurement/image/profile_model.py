"""The model of grey values across an edge: a blurred step between two straight ramps, and its fit to profiles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

__all__ = ["SHARPEST_PX", "FittedProfiles", "ProfileModel", "Refined", "half_profile_px", "profile_model", "step_basis"]

SHARPEST_PX = 0.29
"""Width of an edge without blur: the pixel's own, 1/sqrt(12)."""

_PROFILE_STEP_PX, _HALF_PROFILE_PX = 0.5, (3.5, 6.0)  # of the fit of a profile
_LEFT, _LEFT_NOISE = 0.04, 3.0  # of a mean profile that is an edge's: share of the step, times the noise
_RAMP, _RAMP_NOISE = 0.05, 3.0  # of the slope beside it, per px, likewise


@dataclass(frozen=True)
class Refined:
    """Edges that were fitted on k profiles.

    Parameters
    ----------
    offset
        ``(k,)`` px; NaN where the fit ran away.
    contrast
        ``(k,)``: step of grey values, with its sign.
    ramps
        ``(k, 2)``: slope of grey values on either side, per px.
    left
        ``(k, m)``: what the fit left of each profile.
    noise
        Standard deviation of a pixel.
    """

    offset: NDArray[np.float64]
    contrast: NDArray[np.float64]
    ramps: NDArray[np.float64]
    left: NDArray[np.float64]
    noise: float

    def crowded(self, kept: NDArray[np.bool_]) -> bool:
        """Whether the mean profile is not that of one edge: another lies so near that it moves this one."""
        sign = np.sign(self.contrast[kept])[:, None]
        left, ramps = (self.left[kept] * sign).mean(axis=0), (self.ramps[kept] * sign).mean(axis=0)
        step, chance = float(np.abs(self.contrast[kept]).mean()), self.noise / math.sqrt(kept.sum())
        rms, steepest = float(np.sqrt((left**2).mean())), float(np.abs(ramps).max())
        return rms > _LEFT * step + _LEFT_NOISE * chance or steepest > _RAMP * step + _RAMP_NOISE * chance


@dataclass(frozen=True)
class FittedProfiles:
    """One step of the fit: how far edges are off, px, and the rest as of :class:`Refined`."""

    shift: NDArray[np.float64]
    contrast: NDArray[np.float64]
    ramps: NDArray[np.float64]
    left: NDArray[np.float64]


def half_profile_px(width_px: float) -> float:
    """Half the length of the profiles that are fitted, for edges of a width, px."""
    return float(np.clip(4 * width_px, *_HALF_PROFILE_PX))


def step_basis(
    s: NDArray[np.float64], width_px: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Basis ``(n, 4)`` of grey values ``c0 + c1 s + A Phi(s/w) + c2 (s Phi(s/w) + w phi(s/w))``, s px from the edge.

    Beside it Phi, and the density of the step, per px.
    """
    w = max(width_px, SHARPEST_PX)
    z = s / w
    cdf, pdf = ndtr(z), np.exp(-(z**2) / 2) / (w * np.sqrt(2 * np.pi))
    return np.stack([np.ones_like(s), s, cdf, s * cdf + w**2 * pdf], axis=1), cdf, pdf


class ProfileModel:
    """A blurred step between two ramps, at places evenly spaced along a profile."""

    def __init__(self, width_px: float) -> None:
        half = half_profile_px(width_px)
        self.grid = np.arange(-half, half + 1e-9, _PROFILE_STEP_PX)
        basis, self._cdf, self._pdf = step_basis(self.grid, width_px)
        self._solve = np.linalg.pinv(basis)
        self._rest = np.eye(len(basis)) - basis @ self._solve

    @property
    def information(self) -> float:
        """Fisher information about where the edge is, per px², for a step of 1 in noise of 1 a pixel."""
        slope = self._rest @ self._pdf
        return float(slope @ slope) * float(_PROFILE_STEP_PX)

    def fitted(self, grey: NDArray[np.float64]) -> FittedProfiles:
        """How far from the middle of profiles ``(k, m)`` their edges are, in one step of Gauss and Newton."""
        c = grey @ self._solve.T
        left = grey @ self._rest
        moving = -(c[:, 1, None] + c[:, 2, None] * self._pdf + c[:, 3, None] * self._cdf) @ self._rest
        size = (moving**2).sum(axis=1)
        shift = np.divide((moving * left).sum(axis=1), size, out=np.zeros(len(c)), where=size > 0)
        return FittedProfiles(shift, c[:, 2], np.stack([c[:, 1], c[:, 1] + c[:, 3]], axis=1), left)


def profile_model(width_px: float) -> ProfileModel:
    """The model of a width, to a hundredth of a pixel."""
    return _rounded_model(round(100 * min(width_px, 10.0)))


@lru_cache(maxsize=512)
def _rounded_model(hundredths: int) -> ProfileModel:
    return ProfileModel(hundredths / 100)
