"""All gauges of a part as arrays, for vectorised evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .characteristic import Dimension

__all__ = ["GaugeTable"]


@dataclass(frozen=True)
class GaugeTable:
    """The g gauges of d dimensions, those of one dimension next to each other.

    Parameters
    ----------
    points
        ``(g, 2, 3)`` mm, part frame: start and end.
    normals
        ``(g, 2, k, 3)`` outward unit normals at start and end, padded with zeros.
    whole
        ``(g,)``: the whole segment must be seen, not only its ends.
    dimension
        ``(g,)`` index of the dimension.
    first
        ``(d,)`` index of each dimension's first gauge.
    rim_axis
        ``(g, 3)``: unit normal of the circle whose whole rim can be fitted; zeros, the default, where there is none.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    whole: NDArray[np.bool_]
    dimension: NDArray[np.int64]
    first: NDArray[np.int64]
    rim_axis: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        if not len(self.rim_axis):
            object.__setattr__(self, "rim_axis", np.zeros((len(self.points), 3)))

    @classmethod
    def of(cls, dimensions: Sequence[Dimension]) -> GaugeTable:
        """Stack the gauges of dimensions, each of which has at least one."""
        gauges = [(gauge, index) for index, dimension in enumerate(dimensions) for gauge in dimension.gauges]
        most = max((max(len(g.start_normals), len(g.end_normals)) for g, _ in gauges), default=1)
        points, normals = np.zeros((len(gauges), 2, 3)), np.zeros((len(gauges), 2, most, 3))
        for row, (gauge, _) in enumerate(gauges):
            points[row] = gauge.start, gauge.end
            normals[row, 0, : len(gauge.start_normals)] = gauge.start_normals
            normals[row, 1, : len(gauge.end_normals)] = gauge.end_normals
        rim_axis = np.array([np.zeros(3) if g.rim_axis is None else g.rim_axis for g, _ in gauges]).reshape(-1, 3)
        counts = [len(dimension.gauges) for dimension in dimensions]
        return cls(
            points=points,
            normals=normals,
            whole=np.array([dimensions[index].observed == "whole" for _, index in gauges], dtype=bool),
            dimension=np.array([index for _, index in gauges], dtype=np.int64),
            first=np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64) if counts else np.zeros(0, np.int64),
            rim_axis=rim_axis,
        )

    def __len__(self) -> int:
        return len(self.points)

    @property
    def length_mm(self) -> NDArray[np.float64]:
        """``(g,)`` length of each gauge, mm."""
        return np.asarray(np.linalg.norm(self.points[:, 1] - self.points[:, 0], axis=1))
