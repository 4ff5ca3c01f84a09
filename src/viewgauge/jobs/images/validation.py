"""What a validation has found: errors of displaced acquisitions, and how many lie where the law has them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .measure import Edges

__all__ = ["LEVELS", "Coverage", "ValidatedPair", "Validation"]

LEVELS = (0.68, 0.95, 0.99)
"""Levels of the intervals whose coverage is counted."""

_LIMITS = 0.99  # of the counts that are expected where the law is true


@dataclass(frozen=True)
class Coverage:
    """How many of so many errors lie in the interval that the law holds for ``level`` of them.

    ``low`` and ``high`` are the counts that a true law keeps with a probability of 99 % (binomial law).
    """

    level: float
    inside: int
    acquisitions: int
    low: int
    high: int

    @classmethod
    def of(cls, probabilities: NDArray[np.float64], level: float) -> Coverage:
        """From the probability, by the law, of errors less far out than each error (uniform if the law is true)."""
        from scipy.stats import binom

        n, tail = len(probabilities), (1 - _LIMITS) / 2
        low, high = (int(binom.ppf(q, n, level)) for q in (tail, 1 - tail)) if n else (0, 0)
        return cls(level, int((probabilities <= level).sum()), n, low, high)

    @property
    def holds(self) -> bool:
        """Whether the count is what is expected of a true law; without an acquisition nothing is."""
        return self.acquisitions > 0 and self.low <= self.inside <= self.high


@dataclass(frozen=True)
class ValidatedPair:
    """A characteristic as it was measured from a viewpoint.

    Parameters
    ----------
    predicted_px, location_px
        Standard deviation of the image length by all errors, and by the ends' location alone, px.
    errors_px
        ``(acquisitions,)``: measured less nominal image length, px; NaN where it was not measured.
    probability
        ``(acquisitions,)``: by the law, of an error that is less far from zero than this one.
    """

    viewpoint: str
    characteristic: str
    length_px: float
    predicted_px: float
    location_px: float
    errors_px: NDArray[np.float64]
    probability: NDArray[np.float64]


@dataclass(frozen=True)
class Validation:
    """What the acquisitions of a validation have shown.

    Parameters
    ----------
    pairs
        Those that can be measured in an image without noise and displacement.
    refused
        Pairs that cannot, with the reason: viewpoint, characteristic, reason.
    drawn
        ``(n,)``: the probabilities of one characteristic of each acquisition, drawn before it was taken: independent of
        each other.
    drawn_unmeasured
        Acquisitions in which the drawn one could not be measured.
    """

    edges: Edges
    viewpoints: int
    acquisitions: int
    pairs: tuple[ValidatedPair, ...]
    refused: tuple[tuple[str, str, str], ...]
    drawn: NDArray[np.float64]
    drawn_unmeasured: int

    def coverage(self) -> tuple[Coverage, ...]:
        """Over all acquisitions, one characteristic of each."""
        return tuple(Coverage.of(self.drawn, level) for level in LEVELS)

    def coverage_of(self, characteristic: str) -> tuple[Coverage, ...]:
        """Of one characteristic, over all acquisitions that it was measured in."""
        found = [pair.probability for pair in self.pairs if pair.characteristic == characteristic]
        values = np.concatenate(found) if found else np.zeros(0)
        values = values[np.isfinite(values)]
        return tuple(Coverage.of(values, level) for level in LEVELS)
