"""The part: its surface, its dimensions and the gauges by which they are measured."""

from .brep import Brep, Callout, Edge, Face, Reference
from .characteristic import Dimension, Gauge, Part, Unusable
from .mesh import Mesh

__all__ = ["Brep", "Callout", "Dimension", "Edge", "Face", "Gauge", "Mesh", "Part", "Reference", "Unusable"]
