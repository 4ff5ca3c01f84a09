"""Viewpoints to choose from, with what each measures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .dominance import maximal_rows, probability_levels
from .minimum_cover import Cover, most_probable_minimum_cover

__all__ = ["ViewpointPool"]


@dataclass(frozen=True)
class ViewpointPool:
    """Viewpoints, and the probability with which each measures each characteristic.

    Parameters
    ----------
    T_part_camera
        ``(m, 4, 4)`` mm.
    probability
        ``(m, d)``, 0 where a characteristic is not seen.
    """

    T_part_camera: NDArray[np.float64]
    probability: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.T_part_camera)

    def joined(self, other: ViewpointPool) -> ViewpointPool:
        """The viewpoints of both, those of this one first."""
        return ViewpointPool(
            np.concatenate([self.T_part_camera, other.T_part_camera]),
            np.concatenate([self.probability, other.probability]),
        )

    def taken(self, rows: NDArray[np.int64]) -> ViewpointPool:
        """Some of the viewpoints."""
        return ViewpointPool(self.T_part_camera[rows], self.probability[rows])

    def best(self) -> NDArray[np.float64]:
        """``(d,)``: of each characteristic the highest probability."""
        return np.asarray(self.probability.max(axis=0, initial=0.0))

    def reached(self, required: float) -> NDArray[np.int64]:
        """Indices of the characteristics that some viewpoint measures with the required probability."""
        return np.flatnonzero(self.best() >= required)

    def weakest(self, required: float) -> float:
        """The least probability of the characteristics that are met; 1 where there is none."""
        best = self.best()
        return float(best[best >= required].min(initial=1.0))

    def measured_from(self) -> NDArray[np.int64]:
        """``(d,)``: the row of the highest probability of each characteristic (the first of equal ones)."""
        return np.asarray(self.probability.argmax(axis=0))

    def worthwhile(self, required: float) -> NDArray[np.int64]:
        """Rows that no other makes needless, ascending."""
        return maximal_rows(probability_levels(self.probability, required))

    def most_probable_cover(self, required: float, time_limit_s: float, gap: float = 0.0) -> tuple[ViewpointPool, int]:
        """The fewest viewpoints that measure all that is reached, of those the most probable; and the lower bound."""
        level = probability_levels(self.probability[:, self.reached(required)], required)
        cover: Cover = most_probable_minimum_cover(level, time_limit_s, gap)
        return self.taken(np.array(cover.chosen, dtype=np.int64)), cover.lower_bound
