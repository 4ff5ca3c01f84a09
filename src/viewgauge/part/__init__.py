"""The part: its surface, its characteristics and the measurands by which they are measured."""

from .brep import Brep, Edge, Face, PmiRecord, Reference
from .characteristic import Characteristic, Measurand, NotMeasurable, Part
from .mesh import Mesh

__all__ = [
    "Brep",
    "Characteristic",
    "Edge",
    "Face",
    "Measurand",
    "Mesh",
    "NotMeasurable",
    "Part",
    "PmiRecord",
    "Reference",
]
