"""Everything one inspection needs, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ..evaluation import Requirement, Setup
from ..findings import Finding
from ..geometry import PoseError
from ..part import Part
from ..sensors import Camera
from ..visibility import ObservationLimits
from .candidates.candidate_options import CandidateOptions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .plan import Plan

__all__ = ["ExplicitViewpoints", "Inspection"]


@dataclass(frozen=True)
class ExplicitViewpoints:
    """Viewpoints given one by one: n names and ``T_part_camera`` ``(n, 4, 4)`` mm."""

    ids: tuple[str, ...]
    T_part_camera: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.ids)

    @classmethod
    def of_plan(cls, plan: Plan) -> ExplicitViewpoints:
        """The viewpoints of a plan."""
        poses = np.array([viewpoint.T_part_camera for viewpoint in plan.viewpoints]).reshape(-1, 4, 4)
        return cls(tuple(viewpoint.id for viewpoint in plan.viewpoints), poses)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` ``(m, 4, 4)`` mm of viewpoints ``first`` to ``stop - 1``."""
        return self.T_part_camera[first:stop]


@dataclass(frozen=True)
class Inspection:
    """A part, a camera and the uncertainty of its pose, a requirement, and where the camera may stand.

    Made from a file by :func:`viewgauge.load`, or from Python objects as it stands.

    Parameters
    ----------
    candidates
        Where the camera may stand, and how candidates are sampled there.
    limits
        When a measurand counts as observable.
    viewpoints
        Explicit candidate viewpoints, which take the place of sampled ones; None to sample.
    averaged_viewpoints
        From how many viewpoints a characteristic may be measured and averaged; 1 for one only.
    seed
        Of all sampling: the same seed gives the same plan.
    name
        Title of the report.
    inputs
        SHA-256 of each input file, by its name; empty where nothing was read.
    findings
        What is implausible in it and not accepted: every command shows these as warnings.
    accepted
        Names of findings that are meant as they are.
    """

    part: Part
    camera: Camera
    pose_error: PoseError
    requirement: Requirement
    candidates: CandidateOptions = field(default_factory=CandidateOptions)
    limits: ObservationLimits = field(default_factory=ObservationLimits)
    viewpoints: ExplicitViewpoints | None = None
    averaged_viewpoints: int = 1
    seed: int = 0
    name: str = "inspection"
    inputs: Mapping[str, str] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    accepted: tuple[str, ...] = ()

    @property
    def setup(self) -> Setup:
        """Camera, pose error, requirement and limits, as everything below an inspection takes them."""
        return Setup(self.camera, self.pose_error, self.requirement, self.limits)
