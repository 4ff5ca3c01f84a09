"""What the user may say about where the camera can stand, and about the search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...part import Mesh
from ..region.allowed_region import Hemisphere, Region

Corners = tuple[tuple[float, float, float], tuple[float, float, float]]

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
        Number of directions, spread evenly on the sphere or the cone.
    rolls
        Number of turns about the optical axis, spread evenly over half a turn.
    targets
        Number of points aimed at beside the part's centre (clusters of measurands).
    cone_axis, cone_half_angle_rad
        Only directions (from the part to the camera) within this angle of this axis, part frame.
    box, forbidden
        Lowest and highest corner, mm, part frame, of the box in which the camera has to stand, and of those in which
        it must not.
    hemisphere
        The side of a plane, and how far from a point of it, where the camera has to stand.
    standoff_mm
        Least distance from the part's surface, mm; None to keep out of the part's bounding box instead.
    """

    distance_mm: tuple[float, float] | None = None
    distances: int = 3
    directions: int = 200
    rolls: int = 2
    targets: int = 4
    cone_axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    cone_half_angle_rad: float = np.pi
    box: Corners | None = None
    hemisphere: Hemisphere | None = None
    forbidden: tuple[Corners, ...] = ()
    standoff_mm: float | None = None

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
        for low, high in (*self.forbidden, *([self.box] if self.box else [])):
            if not (np.isfinite([low, high]).all() and (np.asarray(low) < np.asarray(high)).all()):
                raise InputError(
                    "a box needs its lowest corner first, each coordinate below that of the highest",
                    key="box, forbidden",
                    got=f"{list(low)} to {list(high)}",
                )
        if self.standoff_mm is not None and not (np.isfinite(self.standoff_mm) and self.standoff_mm >= 0):
            raise InputError("must be finite and not negative", key="standoff_mm", got=self.standoff_mm)
        if self.hemisphere is not None and not (
            self.hemisphere.radius_mm > 0 and 0 < np.linalg.norm(self.hemisphere.axis) < np.inf
        ):
            raise InputError("the hemisphere needs a direction and a positive radius", got=self.hemisphere)

    @property
    def bounded(self) -> bool:
        """Whether more is asked of the camera's position than a distance and a direction from the part."""
        return (
            self.box is not None or self.hemisphere is not None or bool(self.forbidden) or self.standoff_mm is not None
        )

    def region(self, targets: NDArray[np.float64], distance_mm: tuple[float, float], mesh: Mesh) -> Region:
        """Where the camera may stand, aimed at targets ``(t, 3)`` mm from a range of distances."""
        return Region(
            targets,
            distance_mm,
            mesh,
            self.cone_axis,
            self.cone_half_angle_rad,
            None if self.box is None else np.array(self.box),
            self.hemisphere,
            np.array(self.forbidden).reshape(-1, 2, 3),
            self.standoff_mm,
        )
