"""Characteristics of a part: what of it has a tolerance, and by which measurands it is measured."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .indication import Indication, Measurability
from .measurands import PointPair

__all__ = ["Characteristic", "NotMeasurable", "Observed"]

Observed = Literal["ends", "whole"]


@dataclass(frozen=True)
class Characteristic:
    """A toleranced quantity of the part, with one or several measurands to choose from.

    Parameters
    ----------
    id
        Unique name.
    kind
        "distance", "length", "diameter" or another registered kind of PMI record, or "measurand" for one given by its
        two points.
    nominal_mm
        Nominal value, mm.
    tolerance_mm
        (lower, upper) deviation, mm; None where there is none (a basic value).
    measurands
        At least one. Visibility and error laws take pairs of points.
    observed
        Whether the two ends or the whole segment between them must be seen.
    indication
        How it stands on the drawing; of a characteristic from no drawing an empty one.
    """

    id: str
    kind: str
    nominal_mm: float
    tolerance_mm: tuple[float, float] | None
    measurands: tuple[PointPair, ...]
    observed: Observed = "ends"
    indication: Indication = field(default_factory=Indication)

    @property
    def unit(self) -> str:
        """Unit of the value, that of its measurands: "mm" for lengths and diameters."""
        return self.measurands[0].unit

    def measurand_at(self, points: NDArray[np.float64]) -> PointPair | None:
        """The measurand whose start and end are ``(2, 3)`` mm, part frame; None where there is none."""
        for measurand in self.measurands:
            if np.allclose(np.stack([measurand.start, measurand.end]), points, rtol=0, atol=1e-6):
                return measurand
        return None


@dataclass(frozen=True)
class NotMeasurable:
    """A characteristic that was read but cannot be measured, and why.

    Parameters
    ----------
    id, kind
        As of a :class:`Characteristic`.
    reason
        Why it cannot be measured, a clause such as "an angle has no pair of opposite edge points".
    nominal_mm, tolerance_mm
        As of a :class:`Characteristic`, but rad where ``unit`` says so.
    unit
        "mm" or "rad".
    status
        Not measurable, only partly, or out of scope.
    indication
        As of a :class:`Characteristic`.
    """

    id: str
    kind: str
    reason: str
    nominal_mm: float = float("nan")
    tolerance_mm: tuple[float, float] | None = None
    unit: str = "mm"
    status: Measurability = Measurability.NOT_MEASURABLE
    indication: Indication = field(default_factory=Indication)
