"""What forms the image: the pinhole camera with its lens and pixels, and the edge detector that reads it."""

from .camera import Camera
from .edge_detector import EdgeDetector
from .window import Window

__all__ = ["Camera", "EdgeDetector", "Window"]
