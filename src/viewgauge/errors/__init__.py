"""Probability laws of the error of a segment's image length. They take numbers, not geometry."""

from .quantization import SpatialQuantization
from .total import TotalError

__all__ = ["SpatialQuantization", "TotalError"]
