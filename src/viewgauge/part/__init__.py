"""The part: its surface, its characteristics and the measurands by which they are measured."""

from .brep import Brep, Edge, Face, PmiRecord, Reference
from .characteristic import Characteristic, NotMeasurable
from .inspected_part import Part
from .measurands import Diameter, LengthBetweenPoints, Measurand, PointPair, rim_axes
from .mesh import Mesh

__all__ = [
    "Brep",
    "Characteristic",
    "Diameter",
    "Edge",
    "Face",
    "LengthBetweenPoints",
    "Measurand",
    "Mesh",
    "NotMeasurable",
    "Part",
    "PmiRecord",
    "PointPair",
    "Reference",
    "rim_axes",
]
