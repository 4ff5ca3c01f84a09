"""What stands on the drawing: the text of a dimension or a geometric tolerance, its datums and its modifiers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

__all__ = ["Indication", "Measurability", "indication_from"]


class Measurability(StrEnum):
    """Whether a characteristic of the part can be measured; the values are those of ``check`` and ``plan.json``."""

    MEASURABLE = "measurable"
    """By at least one measurand."""
    PARTIAL = "partial"
    """Some of what it demands can be measured, the rest cannot."""
    NOT_MEASURABLE = "not_measurable"
    """No measurand could be made of it, or none that is known yet."""
    OUT_OF_SCOPE = "out_of_scope"
    """Nothing that a camera sees at edges can measure it."""


@dataclass(frozen=True)
class Indication:
    """A dimension or a geometric tolerance as it stands in the file.

    Parameters
    ----------
    record
        Number of its record in the file (the STEP instance number); 0 where it comes from no file.
    text
        In the words of a drawing, mm and degrees, such as "position diameter 0.2 (M) | A | B | C".
    zone_mm
        Width or diameter of the tolerance zone of a geometric tolerance, mm; None of a dimension.
    datums
        The datums in their order, such as "A" or "B-C (M)".
    modifiers
        What else is demanded, in words, such as "maximum material requirement" or "average".
    limits
        (lower, upper) limit of the value, mm (rad of an angle), where only one of them is given; else (None, None).
    toleranced
        False of a basic or reference dimension, which demands nothing by itself.
    features
        How many features the indication applies to.
    """

    record: int = 0
    text: str = ""
    zone_mm: float | None = None
    datums: tuple[str, ...] = ()
    modifiers: tuple[str, ...] = ()
    limits: tuple[float | None, float | None] = (None, None)
    toleranced: bool = True
    features: int = 1

    @property
    def is_one_sided(self) -> bool:
        """Only an upper or only a lower limit is given."""
        return self.limits != (None, None)


def indication_from(entry: Mapping[str, Any]) -> Indication:
    """The indication of plain data, as ``dataclasses.asdict`` makes it, or JSON of that."""
    sequences = {name: tuple(entry[name]) for name in ("datums", "modifiers", "limits")}
    return Indication(**{**entry, **sequences})
