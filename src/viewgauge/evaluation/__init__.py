"""How well viewpoints measure characteristics."""

from .averaging import Acquisitions, averaged_success_probability
from .best_rows import BestRows
from .capability_figures import CapabilityFigures, capability_figures, spread_mm
from .evaluator import Accepted, Evaluator, TableBlock
from .measurand_laws import MeasurandLaws
from .requirement.allowed_error import Requirement
from .requirement.capability import CapabilityRequirement
from .requirement.conformance import ConformanceRequirement, Process
from .segment import SegmentImage, image_segment, success_probability
from .setup import Setup
from .table import COLUMNS, as_dataset
from .validity import WARNINGS, probability_error, validity

__all__ = [
    "COLUMNS",
    "WARNINGS",
    "Accepted",
    "Acquisitions",
    "BestRows",
    "CapabilityFigures",
    "CapabilityRequirement",
    "ConformanceRequirement",
    "Evaluator",
    "MeasurandLaws",
    "Process",
    "Requirement",
    "SegmentImage",
    "Setup",
    "TableBlock",
    "as_dataset",
    "averaged_success_probability",
    "capability_figures",
    "image_segment",
    "probability_error",
    "spread_mm",
    "success_probability",
    "validity",
]
