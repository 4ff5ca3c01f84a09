"""What forms the image and reads it: sensors behind one protocol, the pinhole camera first, and the edge detector.

A sensor is one file with a class that fulfils :class:`Sensor`.
"""

from .base import Sensor
from .camera import Camera
from .edge_detector import EdgeDetector
from .usable_region import ImageCircle, ImagePolygon, UsableRegion
from .window import Window

__all__ = ["Camera", "EdgeDetector", "ImageCircle", "ImagePolygon", "Sensor", "UsableRegion", "Window"]
