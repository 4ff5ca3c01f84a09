"""The plan: which settings, what each measures, how surely, and what is proven."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .refinement import Refinement

__all__ = ["Plan", "PlannedDimension", "PlannedSetting", "Status"]

Status = Literal["met", "unmet", "not_measurable"]


@dataclass(frozen=True)
class PlannedSetting:
    """A chosen sensor setting: a camera pose ``T_part_camera`` (4, 4) mm and the dimensions measured from it."""

    id: str
    T_part_camera: NDArray[np.float64]
    observes: tuple[str, ...]


@dataclass(frozen=True)
class PlannedDimension:
    """What the plan achieves for one dimension.

    Parameters
    ----------
    nominal_mm, tolerance_mm
        In mm, but rad where ``kind`` is "angle" (which is never measurable).
    status
        "met"; "unmet" (no candidate reaches the required probability); "not_measurable" (no gauge could be
        made, or it has no tolerance where the requirement needs one).
    allowed_error_mm
        Largest error that the requirement allows, mm; NaN where undefined.
    probability, expected_accuracy
        At ``setting`` by ``gauge``: of the plan where met, the best of all candidates where unmet; 0 where none.
    setting
        Id of the planned setting; None unless met.
    gauge
        The two points measured, ``(2, 3)`` mm, part frame; None where none was visible.
    limit
        What limits the dimension, one sentence; empty where met.
    warning
        Why the small-error model is doubtful for this setting and gauge (:func:`viewgauge.evaluation.validity`);
        empty where it is not. The probability of a dimension that is met is then the exact camera's.
    """

    id: str
    kind: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    allowed_error_mm: float
    status: Status
    probability: float
    expected_accuracy: float
    setting: str | None
    gauge: NDArray[np.float64] | None
    limit: str = ""
    warning: str = ""


@dataclass(frozen=True)
class Plan:
    """The fewest settings that measure every dimension that can be met.

    ``lower_bound`` is the proven least number of settings among the candidates and what the refinement found, ``gap``
    the relative gap (count - lower_bound) / count, and ``proven`` says that it is zero. ``refinement`` says what
    refining changed; None where nothing was refined.
    """

    seed: int
    settings: tuple[PlannedSetting, ...]
    dimensions: tuple[PlannedDimension, ...]
    lower_bound: int
    candidate_count: int
    refinement: Refinement | None = None

    @property
    def count(self) -> int:
        """Number of settings."""
        return len(self.settings)

    @property
    def gap(self) -> float:
        """Relative distance between the count and its proven lower bound."""
        return (self.count - self.lower_bound) / self.count if self.count else 0.0

    @property
    def proven(self) -> bool:
        """The count is proven least among the candidates."""
        return self.count == self.lower_bound

    @property
    def all_met(self) -> bool:
        """Every dimension is met."""
        return all(dimension.status == "met" for dimension in self.dimensions)
