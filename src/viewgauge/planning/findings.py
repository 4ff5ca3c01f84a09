"""What a plan is composed of: the chosen viewpoints, what is known of what they do not measure, and what is proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..evaluation import BestRows, TableBlock
from .bounds import Certificate, ViewpointsBound
from .cover.travel import shortest_tour
from .refine.refinement import Refinement

__all__ = ["Averaged", "ChosenViewpoints", "NotMetFindings", "PlanRecord"]


@dataclass(frozen=True)
class ChosenViewpoints:
    """K viewpoints that a plan consists of.

    Parameters
    ----------
    table
        ``(K, d)``: of these viewpoints and all characteristics.
    T_part_camera
        ``(K, 4, 4)`` mm.
    names
        K names.
    names_stay
        A name belongs to its viewpoint; else names are given in the order of the tour.
    """

    table: TableBlock
    T_part_camera: NDArray[np.float64]
    names: tuple[str, ...]
    names_stay: bool = False

    def toured(self) -> tuple[ChosenViewpoints, dict[int, int]]:
        """The same in the order of the shortest tour, and the place in it of each row of before."""
        order = list(shortest_tour(self.T_part_camera[:, :3, 3])[0])
        names = tuple(self.names[k] for k in order) if self.names_stay else self.names
        table = TableBlock(*(getattr(self.table, f.name)[order] for f in fields(self.table)))
        place = {row: n for n, row in enumerate(order)}
        return replace(self, table=table, T_part_camera=self.T_part_camera[order], names=names), place


@dataclass(frozen=True)
class Averaged:
    """A characteristic that the mean of k acquisitions meets.

    Parameters
    ----------
    rows
        The rows of their viewpoints among the chosen ones.
    measurands
        ``(k, 2, 3)`` mm, part frame: what is measured in each.
    probability, expected_accuracy
        Of the mean.
    single_probability
        Of the best single acquisition.
    """

    rows: tuple[int, ...]
    measurands: NDArray[np.float64]
    probability: float
    expected_accuracy: float
    single_probability: float


@dataclass(frozen=True)
class NotMetFindings:
    """What is known of the characteristics that no single viewpoint meets, by their index.

    Parameters
    ----------
    best
        The best rows of all viewpoints tried, and the characteristic's place in them.
    T_part_camera
        ``(4, 4)`` mm: the pose that the best row belongs to, where the characteristic is seen at all.
    averaged
        Those that the mean of several acquisitions meets.
    certificates
        What is proven of the others.
    """

    best: Mapping[int, tuple[BestRows, int]]
    T_part_camera: Mapping[int, NDArray[np.float64]] = field(default_factory=dict)
    averaged: Mapping[int, Averaged] = field(default_factory=dict)
    certificates: Mapping[int, Certificate] = field(default_factory=dict)


@dataclass(frozen=True)
class PlanRecord:
    """Where a plan comes from and what is proven of the number of its viewpoints; as in :class:`~viewgauge.Plan`."""

    lower_bound: int
    candidate_count: int
    seed: int
    refinement: Refinement | None = None
    anywhere: ViewpointsBound | None = None
    interrupted: bool = False
