"""From the callouts of a B-rep to dimensions with gauges: pairs of points on real, visible edges."""

from .derive import derive_dimensions

__all__ = ["derive_dimensions"]
