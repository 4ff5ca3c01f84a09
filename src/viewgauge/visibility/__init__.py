"""Whether a gauge can be observed from a sensor setting."""

from .limits import ObservationLimits
from .observability import REASONS, Observation, observe
from .occlusion import Occluder

__all__ = ["REASONS", "Observation", "ObservationLimits", "Occluder", "observe"]
