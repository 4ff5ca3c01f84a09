"""A boundary representation with its semantic PMI as plain data: what a CAD reader delivers.

Nothing here knows a CAD kernel. Lengths are mm whatever the file's unit was; coordinates are the part frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..findings import Finding
from .indication import Indication, Measurability
from .mesh import Mesh

__all__ = ["Brep", "Edge", "Face", "PmiKind", "PmiRecord", "Reference"]

PmiKind = Literal["distance", "length", "diameter", "radius", "angle", "other"]


@dataclass(frozen=True)
class Face:
    """A face of the part.

    Parameters
    ----------
    kind
        Surface type.
    origin, axis
        ``(3,)``: a point of the plane and its *outward* unit normal; a point of the axis and its direction
        for surfaces of revolution. Zero for "other".
    radius_mm
        Of a cylinder or sphere; NaN otherwise.
    concave
        Of a curved face: the material is outside (a hole, not a boss).
    edges
        Indices of the bounding edges.
    instance
        Which instance of its part in an assembly it belongs to: faces of one instance have one number.
    """

    kind: Literal["plane", "cylinder", "cone", "sphere", "torus", "other"]
    origin: NDArray[np.float64]
    axis: NDArray[np.float64]
    radius_mm: float
    concave: bool
    edges: tuple[int, ...]
    instance: int = 0


@dataclass(frozen=True)
class Edge:
    """An edge of the part.

    Parameters
    ----------
    kind
        Curve type.
    points
        ``(n, 3)`` mm: points of the exact curve from start to end, n >= 2; their chords stay within the
        mesh's chord error. A line has exactly two.
    faces
        Indices of the adjoining faces: two, one for a seam or an open border.
    normals
        ``(n, len(faces), 3)``: outward unit normals of the adjoining faces at the points.
    centre, axis, radius_mm
        Of a circle or arc (zero, zero and NaN otherwise).
    closed
        Start and end coincide (a full circle).
    seam
        The edge closes one periodic face onto itself and shows no feature.
    smooth
        The adjoining faces meet tangentially: no visible crease.
    instance
        As of a :class:`Face`.
    """

    kind: Literal["line", "circle", "other"]
    points: NDArray[np.float64]
    faces: tuple[int, ...]
    normals: NDArray[np.float64]
    centre: NDArray[np.float64]
    axis: NDArray[np.float64]
    radius_mm: float
    closed: bool
    seam: bool = False
    smooth: bool = False
    instance: int = 0


@dataclass(frozen=True)
class Reference:
    """A face or an edge that a PMI record points to, by index."""

    kind: Literal["face", "edge"]
    index: int


@dataclass(frozen=True)
class PmiRecord:
    """One toleranced quantity of the semantic PMI, as written in the file.

    Parameters
    ----------
    name
        Unique identifier within the part (the file's name where it has a useful one).
    kind
        "distance" between two sets of features (DIMENSIONAL_LOCATION), "length" of one feature or between
        the opposite features of one (DIMENSIONAL_SIZE that is no diameter), "diameter", "radius", "angle",
        "other", a kind of geometric tolerance, or another kind for which a deriver is registered.
    label
        The file's own word for the characteristic (for messages), such as "linear distance" or "diameter".
    nominal_mm
        Nominal value, mm (rad for an angle; NaN where the file gives none).
    tolerance_mm
        (lower, upper) deviation, mm; None for a basic or reference value.
    first, second
        What is referred to; ``second`` is empty for sizes.
    problem
        Why it cannot be measured, as far as the reader knows; empty where it may be.
    status
        What it is where there is a problem.
    indication
        How it stands on the drawing.
    """

    name: str
    kind: PmiKind | str
    label: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    first: tuple[Reference, ...]
    second: tuple[Reference, ...] = ()
    problem: str = ""
    status: Measurability = Measurability.NOT_MEASURABLE
    indication: Indication = field(default_factory=Indication)

    @property
    def unit(self) -> str:
        """Unit of the nominal value and the tolerance: "rad" for an angle, "mm" for all else."""
        return "rad" if self.kind == "angle" else "mm"


@dataclass(frozen=True)
class Brep:
    """A solid with its faces, edges, occlusion mesh and PMI records.

    Parameters
    ----------
    length_unit
        The file's unit, such as "mm" or "inch" (everything here is mm already).
    notes
        What the user should know about the reading, one sentence each (such as "no semantic PMI: geometry only").
    plus_minus_count
        Number of PLUS_MINUS_TOLERANCE entities in the file, with which the reading can be compared.
    pmi_counts
        Number of toleranced records in the file's text by kind, counted apart from the reading.
    findings
        What is implausible in the file.
    solids
        Number of solids; 0 where the file has surfaces or triangles only.
    """

    name: str
    length_unit: str
    faces: tuple[Face, ...]
    edges: tuple[Edge, ...]
    mesh: Mesh
    pmi_records: tuple[PmiRecord, ...]
    plus_minus_count: int = 0
    notes: tuple[str, ...] = ()
    pmi_counts: Mapping[str, int] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    solids: int = 0
