"""Visibility: which measurands can be observed from a viewpoint, and the reason where one cannot."""

from .culling import OCCLUDED, REASONS, VISIBLE, Culling
from .limits import ObservationLimits
from .observability import observe
from .occlusion import Occluder, SightLines

__all__ = ["OCCLUDED", "REASONS", "VISIBLE", "Culling", "ObservationLimits", "Occluder", "SightLines", "observe"]
