"""Dimensions of a part and the gauges by which they are measured."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .mesh import Mesh

__all__ = ["Dimension", "Gauge", "Observed", "Part", "Unusable"]

Observed = Literal["ends", "whole"]


@dataclass(frozen=True)
class Gauge:
    """A pair of points on visible edges by which a dimension is measured in the image.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, part frame.
    start_normals, end_normals
        ``(k, 3)``, k >= 1: outward unit normals of the faces that adjoin the edge at that point. The point
        can be seen only from in front of at least one of them.
    source
        Where it lies, in words (such as "edges 12 and 40").
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    start_normals: NDArray[np.float64]
    end_normals: NDArray[np.float64]
    source: str = ""

    @property
    def length_mm(self) -> float:
        """Distance between the two points, mm."""
        return float(np.linalg.norm(self.end - self.start))


@dataclass(frozen=True)
class Dimension:
    """A toleranced quantity of the part, with one or several gauges to choose from.

    Parameters
    ----------
    id
        Unique name.
    kind
        "distance", "length", "diameter", or "gauge" for one given by its two points.
    nominal_mm
        Nominal value, mm.
    tolerance_mm
        (lower, upper) deviation, mm; None where there is none (a basic value).
    gauges
        At least one.
    observed
        Whether the two ends or the whole segment between them must be seen.
    """

    id: str
    kind: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    gauges: tuple[Gauge, ...]
    observed: Observed = "ends"


@dataclass(frozen=True)
class Unusable:
    """A dimension that was read but cannot be measured, and why. Values are rad where ``kind`` is "angle"."""

    id: str
    kind: str
    reason: str
    nominal_mm: float = float("nan")
    tolerance_mm: tuple[float, float] | None = None


@dataclass(frozen=True)
class Part:
    """What is inspected: the occluding mesh and the dimensions, part frame, mm."""

    name: str
    mesh: Mesh
    dimensions: tuple[Dimension, ...]
    unusable: tuple[Unusable, ...] = ()
    notes: tuple[str, ...] = ()
    length_unit: str = "mm"
    feature_lines: tuple[NDArray[np.float64], ...] = field(default=())
    """Polylines ``(n, 3)`` mm of the part's visible edges, for pictures."""
