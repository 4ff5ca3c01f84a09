"""Characteristics of a part and the measurands by which they are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .mesh import Mesh

__all__ = ["Characteristic", "Measurand", "NotMeasurable", "Observed", "Part", "rim_axes"]

Observed = Literal["ends", "whole"]


@dataclass(frozen=True)
class Measurand:
    """A pair of points on visible edges by which a characteristic is measured in the image.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, part frame.
    start_normals, end_normals
        ``(k, 3)``, k >= 1: outward unit normals of the faces that adjoin the edge at that point. The point
        can be seen only from in front of at least one of them.
    source
        Where it lies, in words (such as "edges 12 and 40").
    rim_axis
        ``(3,)`` unit normal of the circle of which the measurand is a diameter, where its whole rim is an outer edge;
        None for any other measurand.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    start_normals: NDArray[np.float64]
    end_normals: NDArray[np.float64]
    source: str = ""
    rim_axis: NDArray[np.float64] | None = None

    @property
    def length_mm(self) -> float:
        """Distance between the two points, mm."""
        return float(np.linalg.norm(self.end - self.start))


def rim_axes(measurands: Sequence[Measurand | None], T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 3)``: axes of the rims of which measurands are diameters, in the frames of poses ``(n, 4, 4)``; else
    zeros.
    """
    none = np.zeros(3)
    axes = [none if measurand is None or measurand.rim_axis is None else measurand.rim_axis for measurand in measurands]
    return np.asarray(np.einsum("nji,nj->ni", T_part_camera[:, :3, :3], np.array(axes).reshape(-1, 3)))


@dataclass(frozen=True)
class Characteristic:
    """A toleranced quantity of the part, with one or several measurands to choose from.

    Parameters
    ----------
    id
        Unique name.
    kind
        "distance", "length", "diameter", or "measurand" for one given by its two points.
    nominal_mm
        Nominal value, mm.
    tolerance_mm
        (lower, upper) deviation, mm; None where there is none (a basic value).
    measurands
        At least one.
    observed
        Whether the two ends or the whole segment between them must be seen.
    """

    id: str
    kind: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    measurands: tuple[Measurand, ...]
    observed: Observed = "ends"

    def measurand_at(self, points: NDArray[np.float64]) -> Measurand | None:
        """The measurand whose start and end are ``(2, 3)`` mm, part frame; None where there is none."""
        for measurand in self.measurands:
            if np.allclose(np.stack([measurand.start, measurand.end]), points, rtol=0, atol=1e-6):
                return measurand
        return None


@dataclass(frozen=True)
class NotMeasurable:
    """A characteristic that was read but cannot be measured, and why. Values are rad where ``kind`` is "angle"."""

    id: str
    kind: str
    reason: str
    nominal_mm: float = float("nan")
    tolerance_mm: tuple[float, float] | None = None


@dataclass(frozen=True)
class Part:
    """What is inspected: the occluding mesh and the characteristics, part frame, mm."""

    name: str
    mesh: Mesh
    characteristics: tuple[Characteristic, ...]
    not_measurable: tuple[NotMeasurable, ...] = ()
    notes: tuple[str, ...] = ()
    length_unit: str = "mm"
    feature_lines: tuple[NDArray[np.float64], ...] = field(default=())
    """Polylines ``(n, 3)`` mm of the part's visible edges, for pictures."""
