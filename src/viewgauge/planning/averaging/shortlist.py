"""Of very many viewpoints a few for each characteristic, from which it may be worth averaging."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Acquisitions
from ...geometry.pose_error import covariance_factor

__all__ = ["AcquisitionShortlist", "acquisition_scores"]

_KEPT = 24
"""Acquisitions of a characteristic that are kept by each score."""


def acquisition_scores(acquisitions: Acquisitions) -> NDArray[np.float64]:
    """``(n, 13)``: reasons to keep an acquisition; the higher, the better, and comparable between acquisitions of
    one characteristic.

    First the acquisition by itself: less its variance. Then what it can offset in a mean: the common part of its error
    along each principal axis of the common covariance, with either sign, over its variance.
    """
    common = acquisitions.gradient @ covariance_factor(acquisitions.common_covariance)
    variance = (common**2).sum(axis=1) + acquisitions.own_variance_mm2
    share = common / np.maximum(variance, np.finfo(float).tiny)[:, None]
    return np.column_stack([-variance, share, -share])


@dataclass(frozen=True)
class AcquisitionShortlist:
    """For each characteristic the best acquisitions by each of several scores; merging is associative and commutative.

    Parameters
    ----------
    viewpoint, characteristic
        ``(m,)``: the acquisitions, sorted by characteristic, then viewpoint.
    score
        ``(m, s)``: of :func:`acquisition_scores`.
    """

    viewpoint: NDArray[np.int64]
    characteristic: NDArray[np.int64]
    score: NDArray[np.float64]

    @classmethod
    def of(
        cls, viewpoint: NDArray[np.int64], characteristic: NDArray[np.int64], score: NDArray[np.float64]
    ) -> AcquisitionShortlist:
        """The shortlist of some acquisitions, each pair of viewpoint and characteristic once."""
        keep = np.zeros(len(viewpoint), dtype=bool)
        for s in range(score.shape[1]):
            order = np.lexsort((viewpoint, -score[:, s], characteristic))
            # place of each acquisition among those of its characteristic
            place = np.arange(len(order)) - np.searchsorted(characteristic[order], characteristic[order])
            keep[order[place < _KEPT]] = True
        kept = np.flatnonzero(keep)
        kept = kept[np.lexsort((viewpoint[kept], characteristic[kept]))]
        return cls(viewpoint[kept], characteristic[kept], score[kept])

    def merged(self, other: AcquisitionShortlist) -> AcquisitionShortlist:
        """Of the acquisitions of both."""
        joined = {name: np.concatenate([a, other.arrays()[name]]) for name, a in self.arrays().items()}
        return AcquisitionShortlist.of(**joined)

    def of_characteristics(self, kept: Sequence[int]) -> AcquisitionShortlist:
        """Only of some characteristics, ascending, which are numbered anew."""
        rows = np.isin(self.characteristic, kept)
        place = np.searchsorted(kept, self.characteristic[rows])
        return AcquisitionShortlist(self.viewpoint[rows], place.astype(np.int64), self.score[rows])

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """As plain arrays, to be stored; they are the arguments of :meth:`of` again."""
        return {"viewpoint": self.viewpoint, "characteristic": self.characteristic, "score": self.score}
