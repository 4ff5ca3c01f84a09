"""How well sensor settings measure dimensions."""

from .requirement import Requirement
from .segment import SegmentImage, image_segment, success_probability
from .table import COLUMNS, evaluate_settings
from .validity import WARNINGS, probability_error, validity

__all__ = [
    "COLUMNS",
    "WARNINGS",
    "Requirement",
    "SegmentImage",
    "evaluate_settings",
    "image_segment",
    "probability_error",
    "success_probability",
    "validity",
]
