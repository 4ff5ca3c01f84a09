"""Total error of a segment's length in the paper's own, independent model (paper, eq. 15-19)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError
from ..law import Law, require_finite
from ..quantization import SpatialQuantization
from .normal_ratio import NormalRatio
from .ratio_sum import CDF, CENTRAL, DENOMINATOR, MEAN_ABSOLUTE, PDF, REACH, SERIES, evaluate_laws

__all__ = ["IndependentTotalError"]

_MOST_RATIOS = 4
_REASONS = {DENOMINATOR: "denominator_near_zero", SERIES: "series_not_converged"}


class IndependentTotalError(Law):
    """Weighted sum of independent ratios of normals plus spatial quantization error.

    ``eps = sum_k w_k W_k + eps_q`` (eq. 15, 16, 18): the four end-point errors, taken as independent, differenced and
    projected on the segment's direction. Probabilities are right to 1e-9; the density to 1e-9 of its scale. Where a
    denominator is too near zero for that (mean below 7.1 standard deviations: a depth known to worse than 14 %) or the
    series does not converge, all values are NaN and :attr:`reason` names why.

    Parameters
    ----------
    ratios
        Up to four laws, mm on the image.
    weights
        As many weights.
    pixel_pitch_mm
        Quantization step: one number, or ``(..., 2)`` for width and height, mm; 0 for the displacement alone.
    angle_rad
        Direction gamma of the imaged segment from +u, rad.

    Raises
    ------
    InputError
        If there are no, or more than four, ratios, or not as many weights; or a parameter is not usable.
    """

    def __init__(
        self,
        ratios: Sequence[NormalRatio],
        weights: Sequence[ArrayLike],
        pixel_pitch_mm: ArrayLike,
        angle_rad: ArrayLike,
    ) -> None:
        if not 0 < len(ratios) <= _MOST_RATIOS or len(ratios) != len(weights):
            raise InputError("give one to four ratios, and a weight for each", got=f"{len(ratios)}, {len(weights)}")
        self.ratios = tuple(ratios)
        self.weights = tuple(require_finite("weights", weight) for weight in weights)
        self.quantization = SpatialQuantization(pixel_pitch_mm, angle_rad)
        self._shape = np.broadcast_shapes(
            self.quantization.mean().shape,
            *(ratio.sigma_numerator.shape for ratio in ratios),
            *(weight.shape for weight in self.weights),
        )
        scaled = [ratio.scaled_to_mean_one() for ratio in ratios]
        amplitudes = [w * amplitude for w, (amplitude, _, _) in zip(self.weights, scaled, strict=True)]
        self._amplitude = self._stacked(amplitudes)
        self._spread = self._stacked([spread for _, spread, _ in scaled])
        self._correlation = self._stacked([correlation for _, _, correlation in scaled])

    def _stacked(self, values: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        """One value for each ratio, ``(n, k)``."""
        return np.stack([np.broadcast_to(value, self._shape).ravel() for value in values], axis=-1)

    def _evaluate(self, kind: int, x: ArrayLike = 0.0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Values at x, and the status of each law; each law's series is set up once however many x it is asked for."""
        x = np.asarray(x, dtype=float)
        count = len(self._amplitude)
        law = np.broadcast_to(np.arange(count).reshape(self._shape), np.broadcast_shapes(x.shape, self._shape))
        order = np.argsort(law, axis=None, kind="stable")
        first = np.concatenate([[0], np.cumsum(np.bincount(law.ravel(), minlength=count))])
        points = np.broadcast_to(x, law.shape).ravel()[order]
        widths = (np.broadcast_to(w, self._shape).ravel() for w in self._half_widths)
        values, status = np.empty(points.shape), np.zeros(count, dtype=np.int64)
        evaluate_laws(
            kind,
            points,
            first,
            self._amplitude,
            self._spread,
            self._correlation,
            *map(np.array, widths),
            values,
            status,
        )
        out = np.empty(points.shape)
        out[order] = values
        return out.reshape(law.shape), status.reshape(self._shape)

    @property
    def _half_widths(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self.quantization.half_width_u, self.quantization.half_width_v

    @property
    def reason(self) -> NDArray[np.str_]:
        """Why values are NaN: ``denominator_near_zero`` or ``series_not_converged``; empty where they are numbers."""
        _, status = self._evaluate(REACH)
        return np.select([status == code for code in _REASONS], list(_REASONS.values()), default="")

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x (eq. 17, 19); 0 beyond the interval that holds the error but for 1e-11."""
        return self._evaluate(PDF, x)[0]

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x), to 1e-9."""
        return self._evaluate(CDF, x)[0]

    def central_probability(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(|error| <= x), to 1e-9: with x = T L it is Pr{Accuracy >= 1 - T} (eq. 20)."""
        return self._evaluate(CENTRAL, x)[0]

    def mean_absolute(self) -> NDArray[np.float64]:
        """E|error|, practical as :meth:`NormalRatio.mean` is: of denominators that keep their sign."""
        return self._evaluate(MEAN_ABSOLUTE)[0]

    def mean(self) -> NDArray[np.float64]:
        """Practical mean: the weighted sum of the ratios' (:meth:`NormalRatio.mean`)."""
        terms = [w * ratio.mean() for w, ratio in zip(self.weights, self.ratios, strict=True)]
        return np.asarray(np.broadcast_to(sum(terms, start=np.zeros(())), self._shape))

    def var(self) -> NDArray[np.float64]:
        """Practical variance: the sum of the ratios' (:meth:`NormalRatio.var`) and the quantization's."""
        terms = [w**2 * ratio.var() for w, ratio in zip(self.weights, self.ratios, strict=True)]
        return np.asarray(np.broadcast_to(sum(terms, start=self.quantization.var()), self._shape))

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line, or the quantization's range where there is no displacement."""
        low, high = self.quantization.support()
        unbounded = (self._amplitude != 0).any(axis=-1).reshape(self._shape)
        return np.where(unbounded, -np.inf, low), np.where(unbounded, np.inf, high)

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Draws of the ratios and of the four uniform errors."""
        rng = np.random.default_rng(random_state)
        shape = self._shape if size is None else size
        draws = [w * ratio.rvs(shape, rng) for w, ratio in zip(self.weights, self.ratios, strict=True)]
        return np.asarray(sum(draws, start=self.quantization.rvs(shape, rng)))

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        reach, _ = self._evaluate(REACH)
        return np.asarray(0 * q - reach), np.asarray(0 * q + reach)
