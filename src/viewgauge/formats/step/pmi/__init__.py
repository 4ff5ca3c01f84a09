"""The semantic PMI of a STEP file (AP242): dimensions and geometric tolerances, from the records of its text.

Follows the CAx-IF "Recommended Practices for the Representation and Presentation of PMI (AP242)".
"""

from .dimensions import DimensionReader
from .geometric_tolerances import GeometricToleranceReader
from .pmi_counts import count_toleranced
from .pmi_findings import pmi_findings
from .pmi_notes import drawn_annotations, pmi_notes
from .pmi_records import PmiSource, named_apart, to_pmi_records
from .pmi_sources import pmi_sources

__all__ = [
    "DimensionReader",
    "GeometricToleranceReader",
    "PmiSource",
    "count_toleranced",
    "drawn_annotations",
    "named_apart",
    "pmi_findings",
    "pmi_notes",
    "pmi_sources",
    "to_pmi_records",
]
