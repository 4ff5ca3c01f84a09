"""Everything one inspection needs, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..evaluation import Requirement
    from ..geometry import PoseError
    from ..part import Part
    from ..sensors import Camera
    from ..visibility import ObservationLimits
    from . import CandidateOptions, Plan

__all__ = ["ExplicitSettings", "Inspection"]


@dataclass(frozen=True)
class ExplicitSettings:
    """Sensor settings given one by one: n names and ``T_part_camera`` ``(n, 4, 4)`` mm."""

    ids: tuple[str, ...]
    T_part_camera: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.ids)

    @classmethod
    def of_plan(cls, plan: Plan) -> ExplicitSettings:
        """The settings of a plan."""
        poses = np.array([setting.T_part_camera for setting in plan.settings]).reshape(-1, 4, 4)
        return cls(tuple(setting.id for setting in plan.settings), poses)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` ``(m, 4, 4)`` mm of settings ``first`` to ``stop - 1``."""
        return self.T_part_camera[first:stop]


@dataclass(frozen=True)
class Inspection:
    """A part, a camera on a head, a requirement, and where the camera may stand.

    Parameters
    ----------
    inputs
        SHA-256 of each input file, by its name.
    settings
        Explicit candidate settings, which take the place of sampled ones; None to sample.
    looks
        From how many settings a dimension may be measured and averaged; 1 for one only.
    """

    name: str
    part: Part
    camera: Camera
    head: PoseError
    requirement: Requirement
    candidates: CandidateOptions
    limits: ObservationLimits
    settings: ExplicitSettings | None
    seed: int
    inputs: Mapping[str, str]
    looks: int = 1
