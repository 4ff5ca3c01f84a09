"""Of very many settings a few for each dimension, from which it may be worth averaging."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Looks
from ...geometry.pose_error import covariance_factor

__all__ = ["LookShortlist", "look_scores"]

_KEPT = 24
"""Looks at a dimension that are kept by each score."""


def look_scores(looks: Looks) -> NDArray[np.float64]:
    """``(n, 13)``: reasons to keep a look; the higher, the better, and comparable between looks at one dimension.

    First the look by itself: less its variance. Then what it can offset in a mean: the common part of its error along
    each principal axis of the common covariance, with either sign, over its variance.
    """
    common = looks.gradient @ covariance_factor(looks.common_covariance)
    variance = (common**2).sum(axis=1) + looks.own_variance_mm2
    share = common / np.maximum(variance, np.finfo(float).tiny)[:, None]
    return np.column_stack([-variance, share, -share])


@dataclass(frozen=True)
class LookShortlist:
    """For each dimension the best looks by each of several scores; merging is associative and commutative.

    Parameters
    ----------
    setting, dimension
        ``(m,)``: the looks, sorted by dimension, then setting.
    score
        ``(m, s)``: of :func:`look_scores`.
    """

    setting: NDArray[np.int64]
    dimension: NDArray[np.int64]
    score: NDArray[np.float64]

    @classmethod
    def of(cls, setting: NDArray[np.int64], dimension: NDArray[np.int64], score: NDArray[np.float64]) -> LookShortlist:
        """The shortlist of some looks, each pair of setting and dimension once."""
        keep = np.zeros(len(setting), dtype=bool)
        for s in range(score.shape[1]):
            order = np.lexsort((setting, -score[:, s], dimension))
            # place of each look among those of its dimension
            place = np.arange(len(order)) - np.searchsorted(dimension[order], dimension[order])
            keep[order[place < _KEPT]] = True
        kept = np.flatnonzero(keep)
        kept = kept[np.lexsort((setting[kept], dimension[kept]))]
        return cls(setting[kept], dimension[kept], score[kept])

    def merged(self, other: LookShortlist) -> LookShortlist:
        """Of the looks of both."""
        joined = {name: np.concatenate([a, other.arrays()[name]]) for name, a in self.arrays().items()}
        return LookShortlist.of(**joined)

    def of_dimensions(self, kept: Sequence[int]) -> LookShortlist:
        """Only of some dimensions, ascending, which are numbered anew."""
        rows = np.isin(self.dimension, kept)
        place = np.searchsorted(kept, self.dimension[rows])
        return LookShortlist(self.setting[rows], place.astype(np.int64), self.score[rows])

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """As plain arrays, to be stored; they are the arguments of :meth:`of` again."""
        return {"setting": self.setting, "dimension": self.dimension, "score": self.score}
