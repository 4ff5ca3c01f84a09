"""How well sensor settings measure dimensions."""

from .best_rows import BestRows
from .evaluator import Accepted, Evaluator, TableBlock
from .looks import Looks, averaged_success_probability
from .requirement import Requirement
from .segment import SegmentImage, image_segment, success_probability
from .table import COLUMNS, as_dataset
from .validity import WARNINGS, probability_error, validity

__all__ = [
    "COLUMNS",
    "WARNINGS",
    "Accepted",
    "BestRows",
    "Evaluator",
    "Looks",
    "Requirement",
    "SegmentImage",
    "TableBlock",
    "as_dataset",
    "averaged_success_probability",
    "image_segment",
    "probability_error",
    "success_probability",
    "validity",
]
