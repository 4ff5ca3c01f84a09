"""From the PMI records of a B-rep to characteristics with measurands: pairs of points on real, visible edges."""

from .derive import derive_characteristics

__all__ = ["derive_characteristics"]
