"""The allowed region: where the camera may be. One file a kind of condition, each behind :class:`RegionMember`."""

from .allowed_region import AllowedRegion
from .box import Box
from .forbidden_box import ForbiddenBox
from .hemisphere import Hemisphere
from .protocol import UNLIMITED, Region, RegionMember, Workpiece
from .standoff import Standoff

__all__ = [
    "UNLIMITED",
    "AllowedRegion",
    "Box",
    "ForbiddenBox",
    "Hemisphere",
    "Region",
    "RegionMember",
    "Standoff",
    "Workpiece",
]
