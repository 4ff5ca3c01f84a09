"""The plan: which settings, what each measures, how surely, and what is proven."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..drawing import Drawable
from .bounds import Certificate, SettingsBound
from .refine.refinement import Refinement

__all__ = ["Look", "Plan", "PlannedDimension", "PlannedSetting", "Status"]

Status = Literal["met", "unmet", "not_measurable"]


@dataclass(frozen=True)
class PlannedSetting:
    """A chosen sensor setting: a camera pose ``T_part_camera`` (4, 4) mm and the dimensions measured from it."""

    id: str
    T_part_camera: NDArray[np.float64]
    observes: tuple[str, ...]


@dataclass(frozen=True)
class Look:
    """One of several looks that are averaged: the setting, and the two points measured, ``(2, 3)`` mm, part frame."""

    setting: str
    gauge: NDArray[np.float64]


@dataclass(frozen=True)
class PlannedDimension:
    """What the plan achieves for one dimension.

    Parameters
    ----------
    nominal_mm, tolerance_mm
        In mm, but rad where ``kind`` is "angle" (which is never measurable).
    status
        "met"; "unmet" (no setting that was tried reaches the required probability); "not_measurable" (no gauge could
        be made, or it has no tolerance where the requirement needs one).
    allowed_error_mm
        Largest error that the requirement allows, mm; NaN where undefined.
    probability, expected_accuracy
        At ``setting`` by ``gauge``: of the plan where met, the best of all settings tried where unmet; 0 where none.
        Of the mean where there are ``looks``.
    setting
        Id of the planned setting, of the first of several looks; None unless met.
    gauge
        The two points measured from there, ``(2, 3)`` mm, part frame; None where none was visible.
    limit
        What limits the dimension, one sentence; empty where met.
    warning
        Why the small-error model is doubtful for this setting and gauge (:func:`viewgauge.evaluation.validity`);
        empty where it is not. The probability of a dimension that is met is then the exact camera's.
    T_part_camera
        ``(4, 4)`` mm: the pose that ``probability`` belongs to; None where no gauge was visible, or with ``looks``.
    looks
        The settings whose values are averaged, if no single one is sure enough; else none.
    single_probability
        Of the best single look, where there are ``looks``.
    certificate
        What is proven of a dimension that is not met, over all poses of the region; None where nothing was tried.
    proof
        The same in a sentence, or that it was only not found; empty unless not met.
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
    T_part_camera: NDArray[np.float64] | None = None
    looks: tuple[Look, ...] = ()
    single_probability: float | None = None
    certificate: Certificate | None = None
    proof: str = ""


@dataclass(frozen=True)
class Plan(Drawable):
    """The fewest settings that measure every dimension that can be met.

    Parameters
    ----------
    lower_bound
        Proven least number of settings among the candidates and what the refinement found, for the dimensions that a
        single look meets.
    refinement
        What refining changed; None where nothing was refined.
    anywhere
        Least number of settings that measure those dimensions wherever in the region they stand; None where that was
        not asked.
    interrupted
        Somebody ended a step: the plan is the best so far.
    """

    seed: int
    settings: tuple[PlannedSetting, ...]
    dimensions: tuple[PlannedDimension, ...]
    lower_bound: int
    candidate_count: int
    refinement: Refinement | None = None
    anywhere: SettingsBound | None = None
    interrupted: bool = False

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
        """The count is proven least among the settings known."""
        return self.count == self.lower_bound

    @property
    def proven_anywhere(self) -> bool:
        """The count is proven least over all poses of the region, known or not."""
        return self.anywhere is not None and self.count == self.anywhere.count

    @property
    def all_met(self) -> bool:
        """Every dimension is met."""
        return all(dimension.status == "met" for dimension in self.dimensions)
