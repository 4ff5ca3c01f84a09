"""All dimensions and geometric tolerances of a file."""

from __future__ import annotations

from ..step_text import StepText
from .dimensions import DimensionReader
from .geometric_tolerances import GeometricToleranceReader
from .pmi_records import PmiSource, named_apart

__all__ = ["pmi_sources"]


def pmi_sources(text: StepText) -> tuple[PmiSource, ...]:
    """The dimensions, then the geometric tolerances, each in the order of their numbers, with unique names.

    Parameters
    ----------
    text
        The file's records.
    """
    return named_apart([*DimensionReader(text).dimensions(), *GeometricToleranceReader(text).tolerances()])
