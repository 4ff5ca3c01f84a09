"""How well sensor settings measure dimensions."""

from .requirement import Requirement
from .segment import SegmentImage, image_segment, success_probability
from .table import COLUMNS, evaluate_settings

__all__ = ["COLUMNS", "Requirement", "SegmentImage", "evaluate_settings", "image_segment", "success_probability"]
