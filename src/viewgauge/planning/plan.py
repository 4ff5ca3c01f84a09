"""The plan: which viewpoints, what each measures and with which probability, and what is proven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from ..drawing import Drawable
from ..part.indication import Indication
from .bounds import Certificate, ViewpointsBound
from .refine.refinement import Refinement

__all__ = ["Acquisition", "Plan", "PlannedCharacteristic", "PlannedViewpoint", "Status"]


class Status(StrEnum):
    """What becomes of a characteristic in a plan; the values are those of ``plan.json``."""

    MET = "met"
    """Some planned viewpoint, or the mean of several, reaches the required probability."""
    NOT_MET = "not_met"
    """No viewpoint that was tried reaches the required probability."""
    NOT_MEASURABLE = "not_measurable"
    """No measurand could be made, or the requirement cannot judge it."""
    PARTIAL = "partial"
    """Only some of what it demands is met."""
    OUT_OF_SCOPE = "out_of_scope"
    """Nothing that a camera sees at edges can measure it."""

    @property
    def is_judged(self) -> bool:
        """Whether viewpoints were tried for it."""
        return self in (Status.MET, Status.NOT_MET, Status.PARTIAL)


@dataclass(frozen=True)
class PlannedViewpoint:
    """A chosen viewpoint: a camera pose ``T_part_camera`` (4, 4) mm and the characteristics measured from it."""

    id: str
    T_part_camera: NDArray[np.float64]
    observes: tuple[str, ...]


@dataclass(frozen=True)
class Acquisition:
    """One of several viewpoints that are averaged: the viewpoint, and the two points measured, ``(2, 3)`` mm, part
    frame.
    """

    viewpoint: str
    measurand: NDArray[np.float64]


@dataclass(frozen=True)
class PlannedCharacteristic:
    """What the plan achieves for one characteristic.

    Parameters
    ----------
    nominal_mm, tolerance_mm
        In mm, but rad where ``kind`` is "angle" (which is never measurable).
    allowed_error_mm
        Largest error that the requirement allows, mm; NaN where undefined.
    probability, expected_accuracy
        At ``viewpoint`` by ``measurand``: of the plan where met, the best of all viewpoints tried where not met; 0
        where none. Of the mean where there are ``acquisitions``.
    viewpoint
        Id of the planned viewpoint, of the first of several viewpoints; None unless met.
    measurand
        The two points measured from there, ``(2, 3)`` mm, part frame; None where none was visible.
    limit
        What limits the characteristic, one sentence; empty where met.
    warning
        Why the small-error model is doubtful for this viewpoint and measurand (:func:`viewgauge.evaluation.validity`);
        empty where it is not. The probability of a characteristic that is met is then the full camera model's.
    T_part_camera
        ``(4, 4)`` mm: the pose that ``probability`` belongs to; None where no measurand was visible, or with
        ``acquisitions``.
    acquisitions
        The viewpoints whose values are averaged, if no single one reaches the required probability; else none.
    single_probability
        Of the best single acquisition, where there are ``acquisitions``.
    certificate
        What is proven of a characteristic that is not met, over all poses of the region; None where nothing was tried.
    proof
        The same in a sentence, or that it was only not found; empty unless not met.
    indication
        How it stands on the drawing.
    """

    id: str
    kind: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    allowed_error_mm: float
    status: Status
    probability: float
    expected_accuracy: float
    viewpoint: str | None
    measurand: NDArray[np.float64] | None
    limit: str = ""
    warning: str = ""
    T_part_camera: NDArray[np.float64] | None = None
    acquisitions: tuple[Acquisition, ...] = ()
    single_probability: float | None = None
    certificate: Certificate | None = None
    proof: str = ""
    indication: Indication = field(default_factory=Indication)

    def __post_init__(self) -> None:
        object.__setattr__(self, "status", Status(self.status))  # a plan that is read has the plain value


@dataclass(frozen=True)
class Plan(Drawable):
    """The fewest viewpoints that measure every characteristic that can be met.

    Parameters
    ----------
    lower_bound
        Proven least number of viewpoints among the candidates and what the refinement found, for the characteristics
        that a single acquisition meets.
    refinement
        What refining changed; None where nothing was refined.
    anywhere
        Least number of viewpoints that measure those characteristics wherever in the region they are; None where that
        was not asked.
    interrupted
        A step was interrupted: the plan is the best so far.
    without_tolerance
        Basic and reference dimensions of the drawing, which demand nothing and are not planned.
    inputs
        SHA-256 of each input file that a plan was made from, by its name, where it was read from a file; else empty.
    """

    seed: int
    viewpoints: tuple[PlannedViewpoint, ...]
    characteristics: tuple[PlannedCharacteristic, ...]
    lower_bound: int
    candidate_count: int
    refinement: Refinement | None = None
    anywhere: ViewpointsBound | None = None
    interrupted: bool = False
    without_tolerance: tuple[PlannedCharacteristic, ...] = ()
    inputs: Mapping[str, str] = field(default_factory=dict, compare=False)

    @property
    def count(self) -> int:
        """Number of viewpoints."""
        return len(self.viewpoints)

    @property
    def gap(self) -> float:
        """Relative distance between the count and its proven lower bound."""
        return (self.count - self.lower_bound) / self.count if self.count else 0.0

    @property
    def proven(self) -> bool:
        """The count is proven least among the viewpoints known."""
        return self.count == self.lower_bound

    @property
    def proven_anywhere(self) -> bool:
        """The count is proven least over all poses of the region, known or not."""
        return self.anywhere is not None and self.count == self.anywhere.count

    @property
    def all_met(self) -> bool:
        """There are characteristics, and every one is met."""
        return bool(self.characteristics) and all(
            characteristic.status == Status.MET for characteristic in self.characteristics
        )
