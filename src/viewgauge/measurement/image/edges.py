"""The finder of straight and slightly bent edges in an image, which looks for them where they are expected."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...sensors import Window
from .image_edge import BIAS_PX, ImageEdge
from .profile_model import SHARPEST_PX, Refined, half_profile_px, profile_model, step_basis

__all__ = ["SPLINE_MARGIN_PX", "EdgeFinder"]

SPLINE_MARGIN_PX = 8
"""Splines of a part of an image are those of the whole, to 1e-4, so far inside it."""

_STEP_PX, _FINE_STEP_PX = 0.25, 0.1  # along profiles
_SMOOTHED_PX = 1.0  # of the derivative of a Gaussian, beside the image's own blur
_CLEAR_PROFILE, _CLEAR_EDGE = 3.5, 6.0  # slope, and step of all profiles together, over those of the noise
_AS_STRONG = 0.6  # of the strongest edge on a profile: nearer ones are preferred if they are as strong as this
_TURNED, _TURNED_BENT = 0.008, 0.06  # of the edge's direction against the expected one, rad
_AGREE = 0.7  # share of profiles that have to agree with the fit
_NEAR_PX = 1.0  # to the fit
_COARSEST_STEP = 1 / 255  # of grey values, share of full scale
_STRAIGHT, _STRAIGHT_PX = 1.7, 0.05  # of what a fit leaves: times the noise, and by sampling
_BENDS = 3.5  # standard deviations of a curvature that is no chance
_ROUNDS, _MOVED_PX = 4, 1.0


def _agreeing(
    t: NDArray[np.float64], offset: NDArray[np.float64], good: NDArray[np.bool_], order: int
) -> NDArray[np.bool_] | None:
    """Which profiles agree with a polynomial; None where too few do."""
    least = max(_AGREE * len(t), order + 2)
    if good.sum() < least:
        return None
    kept = good.copy()
    for _ in range(4):
        fit = np.polyfit(t[kept], offset[kept], order)
        left = np.abs(np.where(good, offset, np.inf) - np.polyval(fit, t))
        again = left <= max(_NEAR_PX, 2.5 * float(np.median(left[kept])))
        if again.sum() < least:
            return None
        if (again == kept).all():
            break
        kept = again
    return kept


def _bends(t: NDArray[np.float64], offset: NDArray[np.float64], deviation_px: float) -> bool:
    """Whether points are on no straight line, beyond doubt by noise: another edge is near one end."""
    if len(t) < 6:
        return False
    middle, half = t.mean(), np.ptp(t) / 2
    design = np.vander((t - middle) / half, 3)
    curvature = np.linalg.lstsq(design, offset, rcond=None)[0][0]
    chance = deviation_px * np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    return bool(abs(curvature) > _BENDS * chance + _STRAIGHT_PX)


class EdgeFinder:
    """Finds edges in one image.

    Parameters
    ----------
    image
        ``(rows, columns)`` grey values, share of full scale.
    noise
        Standard deviation of a pixel, share of full scale; None to estimate it from the image.
    windows
        Where to look, but for a margin of :data:`SPLINE_MARGIN_PX`; elsewhere no edge is found. None for everywhere.
    """

    def __init__(
        self, image: NDArray[np.float64], noise: float | None = None, windows: Sequence[Window] | None = None
    ) -> None:
        from scipy.ndimage import spline_filter

        grey = np.asarray(image, dtype=np.float32)
        self.noise: float = _noise_of(grey) if noise is None else noise
        self._grey = grey
        if windows is None:
            self._splines = spline_filter(grey, order=3, output=np.float32, mode="nearest")
            return
        self._splines = np.full(grey.shape, np.nan, dtype=np.float32)
        for window in windows:
            # coefficients of a part are those of the whole but near its border
            splines = spline_filter(grey[window.slices], order=3, output=np.float32, mode="nearest")
            inner = window.shrunk(SPLINE_MARGIN_PX)
            top, left = inner.top - window.top, inner.left - window.left
            height, width = max(inner.bottom - inner.top, 0), max(inner.right - inner.left, 0)
            self._splines[inner.slices] = splines[top : top + height, left : left + width]

    def edge(
        self,
        point: NDArray[np.float64],
        along: NDArray[np.float64],
        places_px: NDArray[np.float64],
        reach_px: float,
        bent: bool = False,
    ) -> ImageEdge | None:
        """The edge near a point; None where no clear one is found.

        Parameters
        ----------
        point, along
            ``(2,)`` px: where it is expected, and its direction (unit).
        places_px
            ``(k,)``: where along it profiles are taken, from the point.
        reach_px
            How far off across its direction it may be.
        bent
            A parabola in place of a straight line.
        """
        t = places_px
        if len(t) < (5 if bent else 3):
            return None
        across, order = np.broadcast_to([-along[1], along[0]], (len(t), 2)), 2 if bent else 1
        places = point + t[:, None] * along
        if bent:
            guess, _ = self.offsets(places, across, reach_px)
            clear = _agreeing(t, guess, np.isfinite(guess), order)
            if clear is None:
                return None
            guess = np.asarray(np.polyval(np.polyfit(t[clear], guess[clear], order), t))
        else:  # as straight as it is, it is on all profiles together, with less noise
            place, _ = self.offsets(places[None], across[:1], reach_px)
            if np.isnan(place[0]):
                return None
            guess = np.full(len(t), place[0])
        width = self.width_px(places + guess[:, None] * across, across)
        if not math.isfinite(width):
            return None
        sharp = self.refined(places, across, guess, width)
        kept = _agreeing(t, sharp.offset, np.isfinite(sharp.offset), order)
        if kept is None or sharp.crowded(kept):
            return None
        t, offset, across = t[kept], sharp.offset[kept], across[kept]
        fit = np.polyfit(t, offset, order)
        residual = offset - np.polyval(fit, t)
        chance = 4 * residual.std() * np.sqrt(12 / len(t)) / np.ptp(t)  # what noise may turn it by
        if abs(fit[-2]) > (_TURNED_BENT if bent else _TURNED) + chance:
            return None
        contrast = float(np.median(np.abs(sharp.contrast[kept])))
        if contrast < _CLEAR_EDGE * self.noise / np.sqrt(len(places_px)):
            return None
        deviation, rms = self.point_deviation_px(contrast, width), float(np.sqrt((residual**2).mean()))
        if rms > _STRAIGHT * deviation + _STRAIGHT_PX or (not bent and _bends(t, offset, deviation)):
            return None
        if bent:
            design = np.vander(t, order + 1, increasing=True)
            coefficients, covariance = fit[::-1], deviation**2 * np.linalg.inv(design.T @ design)
        else:
            polished = self._on_pixels(point, along, t, fit[::-1], width)
            if polished is None:
                return None
            coefficients, covariance, width = polished
        covariance[0, 0] += BIAS_PX**2
        shape = np.zeros((3, 3))
        shape[: len(coefficients), : len(coefficients)] = covariance
        return ImageEdge(point, along, np.array([*coefficients, 0.0])[:3], shape, width, contrast)

    def _on_pixels(
        self,
        point: NDArray[np.float64],
        along: NDArray[np.float64],
        t: NDArray[np.float64],
        line: NDArray[np.float64],
        width_px: float,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float] | None:
        """Coefficients ``(2,)`` of a straight edge, covariance, and width, by the pixels; None if it runs away.

        Least squares of one blurred step between two ramps, its blur too, for all pixels of the strip. Nothing is
        interpolated: beside rows and columns profiles that are interpolated between pixels all err alike.
        """
        across = np.array([-along[1], along[0]])
        half = half_profile_px(width_px)
        ends = np.array([t.min() - 0.5, t.max() + 0.5])
        middle = point + ends[:, None] * along + (line[0] + line[1] * ends)[:, None] * across
        corners = np.concatenate([middle - half * across, middle + half * across])
        (left, top), (right, bottom) = (
            np.floor(corners.min(axis=0)).astype(int),
            np.ceil(corners.max(axis=0)).astype(int),
        )
        rows, columns = self._grey.shape
        if left < 0 or top < 0 or right >= columns or bottom >= rows:
            return None
        v, u = np.mgrid[top : bottom + 1, left : right + 1]
        place = (u - point[0]) * along[0] + (v - point[1]) * along[1]
        beside = (u - point[0]) * across[0] + (v - point[1]) * across[1]
        inside = (place >= ends[0]) & (place <= ends[1]) & (np.abs(beside - line[0] - line[1] * place) <= half)
        inside &= np.isfinite(self._splines[top : bottom + 1, left : right + 1])
        place, beside = place[inside], beside[inside]
        grey = self._grey[top : bottom + 1, left : right + 1][inside].astype(float)
        if len(grey) < 3 * len(t):
            return None
        fitted = np.array([*line, width_px], dtype=float)
        for _ in range(_ROUNDS):
            off, w = beside - fitted[0] - fitted[1] * place, max(fitted[2], SHARPEST_PX)
            basis, cdf, pdf = step_basis(off, w)
            Q, R = np.linalg.qr(basis)
            diagonal = np.abs(np.diagonal(R))
            if diagonal.min() < 1e-9 * diagonal.max():
                return None  # the edge has left the strip
            c = np.linalg.solve(R, Q.T @ grey)
            slope = -(c[1] + c[2] * pdf + c[3] * cdf)
            moving = np.stack([slope, slope * place, (c[3] * w - c[2] * off / w) * pdf], axis=1)
            moving -= Q @ (Q.T @ moving)
            normal = moving.T @ moving
            if not np.linalg.det(normal) > 0:
                return None
            fitted = fitted + np.clip(np.linalg.solve(normal, moving.T @ grey), -_MOVED_PX, _MOVED_PX)
        ran = np.abs(fitted[0] - line[0] + (fitted[1] - line[1]) * ends)
        if not (ran <= _MOVED_PX).all():
            return None
        return fitted[:2], self.noise**2 * np.linalg.inv(normal)[:2, :2], float(max(fitted[2], SHARPEST_PX))

    def offsets(
        self, places: NDArray[np.float64], across: NDArray[np.float64], reach_px: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far across, px, from places ``(k, 2)`` px edges are found, ``(k,)``, and how steep they are, ``(k,)``.

        NaN where none is clear. The slope is that of the smoothed grey values, per px, with its sign. Places
        ``(k, m, 2)`` are k edges, of m profiles each that are laid over each other.

        Parameters
        ----------
        across
            ``(k, 2)``: unit, along which to look from each place, to either side.
        """
        s = np.arange(-(reach_px + 4 * _SMOOTHED_PX), reach_px + 4 * _SMOOTHED_PX + 1e-9, _STEP_PX)
        bundles = places if places.ndim == 3 else places[:, None]
        grey = self._at(bundles[:, :, None] + s[:, None] * across[:, None, None]).mean(axis=1)
        slope = _slope(grey)
        inside = np.abs(s) <= reach_px
        offset, steep = np.full(len(places), np.nan), np.full(len(places), np.nan)
        # noise of the smoothed slope, per px, of interpolated samples: about that of white noise so smoothed
        threshold = _CLEAR_PROFILE * self.noise * 0.4 / _SMOOTHED_PX**1.5 / math.sqrt(bundles.shape[1])
        for k, row in enumerate(np.abs(slope)):
            peaks = np.flatnonzero((row[1:-1] >= row[:-2]) & (row[1:-1] > row[2:]) & inside[1:-1]) + 1
            peaks = peaks[row[peaks] > threshold]
            if not len(peaks):
                continue
            strong = peaks[row[peaks] >= _AS_STRONG * row[peaks].max()]
            best = strong[np.argmin(np.abs(s[strong]))]
            below, at, above = row[best - 1 : best + 2]
            shift = 0.5 * (below - above) / min(below - 2 * at + above, -1e-12)
            offset[k] = s[best] + shift * _STEP_PX
            steep[k] = slope[k, best]
        return offset, steep

    def width_px(self, places: NDArray[np.float64], across: NDArray[np.float64]) -> float:
        """Width of an edge that runs through places ``(k, 2)`` px, of all profiles laid over each other.

        Parameters
        ----------
        across
            ``(k, 2)``: unit.
        """
        beside, near = np.arange(2.0, 4.0 + 1e-9, _STEP_PX), np.arange(-1.0, 1.0 + 1e-9, _FINE_STEP_PX)
        s = np.concatenate([-beside, beside, near])
        grey = self._at(places[:, None] + s[:, None] * across[:, None]).mean(axis=0)
        n = len(beside)
        side = abs(float(grey[n : 2 * n].mean() - grey[:n].mean()))
        steepest = float(np.abs(np.diff(grey[2 * n :])).max()) / _FINE_STEP_PX
        return side / (steepest * np.sqrt(2 * np.pi)) if steepest > 0 else np.inf

    def refined(
        self, places: NDArray[np.float64], across: NDArray[np.float64], offset: NDArray[np.float64], width_px: float
    ) -> Refined:
        """Edges fitted by a blurred step between two straight ramps, from a first guess of where they are.

        Least squares over where the edge is, its step, and level and slope on either side (variable projection; Golub
        and Pereyra, *SIAM J. Numer. Anal.* 10 (1973) 413-432): shading beside an edge does not move it.

        Parameters
        ----------
        places, across
            As of :meth:`offsets`.
        offset
            ``(k,)``: of the first guess, px.
        width_px
            Standard deviation of the blur, the pixel's included.
        """
        model = profile_model(width_px)
        at = offset.copy()
        for _ in range(_ROUNDS):
            grey = self._at(places[:, None] + (at[:, None] + model.grid)[..., None] * across[:, None])
            found = model.fitted(grey)
            at = at + np.clip(found.shift, -0.5, 0.5)
        at = np.where(np.abs(at - offset) <= _MOVED_PX, at, np.nan)
        return Refined(at, found.contrast, found.ramps, found.left, self.noise)

    def point_deviation_px(self, contrast: float, width_px: float) -> float:
        """Standard deviation of one edge point (:meth:`refined`) by the image's noise, across the edge, px."""
        if self.noise <= 0 or contrast <= 0:
            return 0.0
        return self.noise / contrast / math.sqrt(profile_model(width_px).information)

    def _at(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Grey values at places ``(..., 2)`` px, by cubic splines."""
        from scipy.ndimage import map_coordinates

        rows_columns = [places[..., 1], places[..., 0]]
        return np.asarray(map_coordinates(self._splines, rows_columns, order=3, mode="nearest", prefilter=False))


def _slope(grey: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivative of a Gaussian along the last axis, per px."""
    from scipy.ndimage import gaussian_filter1d

    return np.asarray(gaussian_filter1d(grey, _SMOOTHED_PX / _STEP_PX, axis=-1, order=1) / _STEP_PX)


def _noise_of(image: NDArray[np.float32]) -> float:
    """Standard deviation of a pixel, robustly, from second differences (Immerkaer 1996): edges are rare.

    Places where all pixels around are black, clipped or never rendered, tell nothing of it. It is at least the rounding
    to whole grey values.
    """
    rows, columns = (slice(1, -1),) * 2
    inner = image[rows, columns]
    mask = (
        image[:-2, :-2] + image[:-2, 2:] + image[2:, :-2] + image[2:, 2:]
        - 2 * (image[:-2, 1:-1] + image[2:, 1:-1] + image[1:-1, :-2] + image[1:-1, 2:]) + 4 * inner
    )[::3, ::3]  # fmt: skip
    told = mask[(mask != 0) | (inner[::3, ::3] != 0)]
    values = np.unique(image[::5, ::5])
    step = min(float(np.diff(values).min()), _COARSEST_STEP) if len(values) > 1 else 0.0
    return max(float(1.4826 * np.median(np.abs(told)) / 6) if len(told) else 0.0, step / math.sqrt(12))
