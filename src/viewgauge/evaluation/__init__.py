"""How well sensor settings measure dimensions."""

from .averaging import Looks, averaged_success_probability
from .best_rows import BestRows
from .capability_figures import GaugeFigures, gauge_figures, spread_mm
from .evaluator import Accepted, Evaluator, TableBlock
from .measurand_laws import GaugeLaws
from .requirement.allowed_error import Requirement
from .requirement.capability import CapabilityRequirement
from .requirement.conformance import ConformanceRequirement, Process
from .segment import SegmentImage, image_segment, success_probability
from .table import COLUMNS, as_dataset
from .validity import WARNINGS, probability_error, validity

__all__ = [
    "COLUMNS",
    "WARNINGS",
    "Accepted",
    "BestRows",
    "CapabilityRequirement",
    "ConformanceRequirement",
    "Evaluator",
    "GaugeFigures",
    "GaugeLaws",
    "Looks",
    "Process",
    "Requirement",
    "SegmentImage",
    "TableBlock",
    "as_dataset",
    "averaged_success_probability",
    "gauge_figures",
    "image_segment",
    "probability_error",
    "spread_mm",
    "success_probability",
    "validity",
]
