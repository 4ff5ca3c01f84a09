"""How settings, as they stand, measure a part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import WARNINGS, Requirement, TableBlock
from ...geometry import PoseError
from ...part import Dimension, Gauge
from ...sensors import Camera
from ...visibility import REASONS

__all__ = ["Answers", "DimensionAnswer"]


@dataclass(frozen=True)
class DimensionAnswer:
    """How a dimension stands.

    Parameters
    ----------
    setting
        By which it is measured the surest; None where no setting sees it.
    gauge
        The two points from there; where it is not seen its first.
    reason
        Why it is not seen from where it fails last; empty where it is seen.
    """

    dimension: Dimension
    allowed_error_mm: float
    met: bool
    probability: float
    expected_accuracy: float
    setting: str | None
    gauge: Gauge
    reason: str
    warning: str


@dataclass(frozen=True)
class Answers:
    """How the settings, as they stand, measure the part.

    Parameters
    ----------
    settings
        ``T_part_camera`` ``(4, 4)`` mm by name.
    table
        Setting x dimension, in the order of ``settings`` and ``dimensions``.
    """

    camera: Camera
    head: PoseError
    requirement: Requirement
    settings: Mapping[str, NDArray[np.float64]]
    dimensions: tuple[DimensionAnswer, ...]
    table: TableBlock

    @property
    def met(self) -> int:
        """Number of dimensions that are met."""
        return sum(answer.met for answer in self.dimensions)

    @property
    def weakest(self) -> DimensionAnswer | None:
        """The least sure of all; None where there is none."""
        return min(self.dimensions, key=lambda answer: answer.probability, default=None)

    def of(self, name: str) -> DimensionAnswer:
        """By the dimension's id; KeyError where there is none."""
        return {answer.dimension.id: answer for answer in self.dimensions}[name]

    @classmethod
    def from_table(
        cls,
        camera: Camera,
        head: PoseError,
        requirement: Requirement,
        settings: Mapping[str, NDArray[np.float64]],
        dimensions: tuple[Dimension, ...],
        allowed_error_mm: NDArray[np.float64],
        table: TableBlock,
    ) -> Answers:
        """Of each dimension the surest setting of a table."""
        names = list(settings)
        answers = tuple(
            _answer(dimension, float(allowed_error_mm[j]), table, j, names, requirement.probability)
            for j, dimension in enumerate(dimensions)
        )
        return cls(camera, head, requirement, settings, answers, table)


def _answer(
    dimension: Dimension, allowed: float, table: TableBlock, j: int, names: list[str], required: float
) -> DimensionAnswer:
    visible = table.visible[:, j]
    if not visible.any():
        last = int(table.reason[:, j].max()) if len(names) else None
        reason = "no setting yet" if last is None else REASONS[last]
        return DimensionAnswer(dimension, allowed, False, 0.0, 0.0, None, dimension.gauges[0], reason, "")
    row = int(np.argmax(np.where(visible, table.probability[:, j], -1.0)))
    probability = float(table.probability[row, j])
    return DimensionAnswer(
        dimension,
        allowed,
        probability >= required,
        probability,
        float(table.expected_accuracy[row, j]),
        names[row],
        dimension.gauges[int(table.gauge[row, j])],
        "",
        ("", *WARNINGS)[int(table.validity[row, j])],
    )
