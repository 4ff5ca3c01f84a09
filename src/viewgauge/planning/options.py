"""What the user may say about where the camera can stand, and about the search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..exceptions import InputError

__all__ = ["CandidateOptions"]


@dataclass(frozen=True)
class CandidateOptions:
    """How candidate sensor settings are sampled around the part.

    Parameters
    ----------
    distance_mm
        (nearest, farthest) distance from the camera to the point it is aimed at, mm; None: from part and camera.
    distances
        Number of distances sampled in that range.
    directions
        Number of directions, spread evenly on the sphere or the cone.
    rolls
        Number of turns about the optical axis, spread evenly over half a turn.
    targets
        Number of points aimed at beside the part's centre (clusters of gauges).
    cone_axis, cone_half_angle_rad
        Only directions (from the part to the camera) within this angle of this axis, part frame.
    """

    distance_mm: tuple[float, float] | None = None
    distances: int = 3
    directions: int = 200
    rolls: int = 2
    targets: int = 4
    cone_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    cone_half_angle_rad: float = np.pi

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
