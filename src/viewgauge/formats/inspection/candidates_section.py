"""The section ``candidates``: how candidate viewpoints are sampled; the keys of the region are registered apart."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from ...exceptions import InputError
from ...planning.candidates.candidate_options import CandidateOptions
from ...planning.region import RegionMember
from .values import Angle, Apart, Count, CountOrZero, Direction, DistanceRange, Name, Section

__all__ = ["CandidatesSection", "ConeSection"]


class ConeSection(Section):
    """The cone of directions, from the part to the camera."""

    axis: Direction = Field(
        default=(0.0, 0.0, 1.0), description="the cone's axis, part frame: three numbers, by default [0, 0, 1]"
    )
    half_angle: Angle = Field(description="between axis and side of the cone: an angle, such as 60 deg")

    @model_validator(mode="after")
    def _in_range(self) -> ConeSection:
        if self.half_angle > np.pi:
            raise InputError(
                "the cone's half angle is too large",
                key="half_angle",
                got=f"{np.rad2deg(self.half_angle):.6g} deg",
                expected="at most 180 deg",
            )
        if not 0 < np.linalg.norm(self.axis) < np.inf:
            raise InputError("the cone's axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        return self


class CandidatesSection(Section):
    """How candidate viewpoints are sampled; the cone and the members of the allowed region are read apart.

    The keys of the allowed region are added by :func:`~viewgauge.formats.inspection.region_section.candidates_section`.
    """

    distance: DistanceRange | None = Field(
        default=None, description='one distance to the point aimed at, or nearest and farthest: "[300, 600] mm"'
    )
    distances: Count | None = Field(default=None, description="how many distances are sampled in that range")
    directions: Count | None = Field(default=None, description="how many directions are sampled, by default 200")
    rolls: Count | None = Field(default=None, description="how many turns about the optical axis, by default 2")
    targets: CountOrZero | None = Field(default=None, description="how many points are aimed at beside the middle")
    cone: Annotated[Any, Apart(ConeSection, optional=True)] = Field(
        default=None, description="the cone of directions from the part to the camera"
    )
    viewpoints: Name | None = Field(default=None, description="a CSV file of viewpoints, in place of sampled ones")

    def build(self, cone: ConeSection | None, regions: tuple[RegionMember, ...]) -> CandidateOptions:
        """The options, with the defaults for what is not given; raises InputError."""
        given: dict[str, Any] = {
            "distance_mm": self.distance,
            "distances": self.distances,
            "directions": self.directions,
            "rolls": self.rolls,
            "targets": self.targets,
            "regions": regions,
        }
        if self.distance is not None and self.distance[0] == self.distance[1]:
            given["distances"] = 1
        if cone is not None:
            given |= {"cone_axis": cone.axis, "cone_half_angle_rad": cone.half_angle}
        return CandidateOptions(**{name: value for name, value in given.items() if value is not None})
