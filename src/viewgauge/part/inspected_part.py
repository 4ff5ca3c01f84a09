"""The part that is inspected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..findings import Finding
from .brep import Brep
from .characteristic import Characteristic, NotMeasurable
from .mesh import Mesh

__all__ = ["Part"]


@dataclass(frozen=True)
class Part:
    """What is inspected: the occluding mesh and the characteristics, part frame, mm.

    Parameters
    ----------
    name
        The part's name, for messages and pages.
    mesh
        The surface that hides what lies behind it.
    characteristics
        Those that can be measured.
    not_measurable
        Those that were read but cannot be measured, each with its reason.
    notes
        What the user should know about the reading, one sentence each.
    length_unit
        Unit of the part's file (everything here is mm already).
    solids
        Number of solids of a CAD file; None where nobody counted.
    brep
        The boundary representation of a CAD part, for features by their ids; None for a mesh, and once the
        characteristics are complete.
    feature_lines
        Polylines ``(n, 3)`` mm of the part's visible edges, for pictures.
    pmi_counts
        Number of toleranced records in the part's file by kind, counted in its text apart from the reader.
    findings
        What is implausible about the part or its file, such as its size.
    """

    name: str
    mesh: Mesh
    characteristics: tuple[Characteristic, ...]
    not_measurable: tuple[NotMeasurable, ...] = ()
    notes: tuple[str, ...] = ()
    length_unit: str = "mm"
    feature_lines: tuple[NDArray[np.float64], ...] = field(default=())
    pmi_counts: Mapping[str, int] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    solids: int | None = None
    brep: Brep | None = None
