"""What the user may state about where the camera can be, and about the sampling of candidates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ..region import AllowedRegion, RegionMember, Workpiece
from ..region.around_targets import AroundTargets
from ..region.part_bounding_box import OutsidePartBoundingBox

__all__ = ["CandidateOptions"]


@dataclass(frozen=True)
class CandidateOptions:
    """How candidate viewpoints are sampled around the part.

    Parameters
    ----------
    distance_mm
        (nearest, farthest) distance from the camera to the point it is aimed at, mm; None: from part and camera.
    distances
        Number of distances sampled in that range.
    directions
        Number of directions, spread uniformly over the sphere or the cone.
    rolls
        Number of rotations about the optical axis, spread uniformly over half a turn.
    targets
        Number of points aimed at beside the part's centre (clusters of measurands).
    cone_axis, cone_half_angle_rad
        Only directions (from the part to the camera) within this angle of this axis, part frame.
    regions
        Members of the allowed region, such as :class:`~viewgauge.planning.region.Box`: the camera has to be where all
        of them allow it, and outside the part's bounding box unless one of them keeps it out of the part.
    """

    distance_mm: tuple[float, float] | None = None
    distances: int = 3
    directions: int = 200
    rolls: int = 2
    targets: int = 4
    cone_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    cone_half_angle_rad: float = np.pi
    regions: tuple[RegionMember, ...] = ()

    def __post_init__(self) -> None:
        if self.distance_mm is not None:
            near, far = self.distance_mm
            if not (np.isfinite([near, far]).all() and 0 < near <= far):
                raise InputError(
                    "the distance range must be two positive lengths, the nearer first",
                    key="distance",
                    got=self.distance_mm,
                )
        for name in ("distances", "directions", "rolls"):
            if getattr(self, name) < 1:
                raise InputError(f"{name} must be at least 1", key=name, got=getattr(self, name))
        if self.targets < 0:
            raise InputError("targets must not be negative", key="targets", got=self.targets)
        if not 0 < self.cone_half_angle_rad <= np.pi:
            raise InputError("the cone's half angle must lie in (0, 180] deg", got=self.cone_half_angle_rad)
        if not np.isfinite(self.cone_axis).all() or not np.linalg.norm(self.cone_axis) > 0:
            raise InputError("the cone's axis must be a direction", key="cone_axis", got=self.cone_axis)
        for member in self.regions:
            if not isinstance(member, RegionMember):
                raise InputError(
                    "not a member of the allowed region",
                    key="regions",
                    got=repr(member),
                    expected="an object such as viewgauge.planning.region.Box, with all that RegionMember asks for",
                )

    def members(self) -> tuple[RegionMember, ...]:
        """The stated members, and the part's bounding box where none of them keeps the camera out of the part."""
        if any(member.clears_part for member in self.regions):
            return self.regions
        return (*self.regions, OutsidePartBoundingBox())

    def region(
        self, targets: NDArray[np.float64], distance_mm: tuple[float, float], workpiece: Workpiece
    ) -> AllowedRegion:
        """The allowed region: all members, and the range of distances and directions from targets ``(t, 3)`` mm."""
        sampled = AroundTargets(targets, distance_mm, self.cone_axis, self.cone_half_angle_rad)
        return AllowedRegion((*(member.region(workpiece) for member in self.members()), sampled))

    def stated_region(self, workpiece: Workpiece) -> AllowedRegion:
        """What the stated members alone allow: poses that are given and not sampled are asked for no more."""
        return AllowedRegion(tuple(member.region(workpiece) for member in self.regions))
