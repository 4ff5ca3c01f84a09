"""The dimensions in a STEP file's semantic PMI (AP242), read from its records.

Follows the CAx-IF "Recommended Practices for the Representation and Presentation of PMI (AP242)", sections 5
and 6: a dimension refers to shape aspects, these to faces and edges; its value is a shape dimension
representation, its deviations a plus-minus tolerance. Reading the records rather than a kernel's digest of them
keeps the sign of every deviation and every dimension whose geometry the kernel does not know.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from ....part.brep import PmiKind, PmiRecord
from ....part.indication import Indication, Measurability
from ..step_text import Record, StepText
from .dimension_text import dimension_text
from .dimension_values import DimensionValues
from .pmi_records import NO_LENGTH, PmiSource, named_apart
from .shape_aspects import LOCATIONS, SIZES, ShapeAspects, numbers_in

__all__ = ["DimensionReader"]


@dataclass(frozen=True)
class DimensionReader:
    """Reads the dimensions of a file.

    Parameters
    ----------
    text
        The file's records.
    """

    text: StepText

    @cached_property
    def _aspects(self) -> ShapeAspects:
        return ShapeAspects(self.text)

    @cached_property
    def _values(self) -> DimensionValues:
        return DimensionValues(self.text)

    @property
    def plus_minus(self) -> dict[int, list[int]]:
        """Ranges (records) that the plus-minus tolerances give to each dimension."""
        return self._values.plus_minus

    def dimensions(self) -> tuple[PmiSource, ...]:
        """All dimensions in the order of their numbers, with unique names."""
        numbers = self.text.numbers(*LOCATIONS, *SIZES)
        return named_apart([self._dimension(number) for number in numbers])

    def sides(self, number: int) -> list[int]:
        """The shape aspects that a dimension applies to: one of a size, two of a location."""
        return _label_and_sides(self.text.records(number))[1]

    def _dimension(self, number: int) -> PmiSource:
        parts = self.text.records(number)
        types = {part.type for part in parts}
        label, sides = _label_and_sides(parts)
        first, problem_first = self._aspects.geometry(sides[0]) if sides else ((), "the dimension refers to nothing")
        second, problem_second = self._aspects.geometry(sides[1]) if len(sides) > 1 else ((), "")
        kind = _kind(types, label)
        value = self._values.value(number, kind)
        problem = value.problem
        if not problem and kind == "other":
            problem = NO_LENGTH.format(label)
        if not problem and value.not_two_point:
            words = value.not_two_point
            problem = f"the {words} size is made of many points of the feature, and two opposite points do not give it"
        indication = Indication(
            record=number,
            text=dimension_text(kind, label, value),
            modifiers=value.modifiers,
            limits=value.limits,
            toleranced=value.toleranced,
        )
        pmi_record = PmiRecord(
            self._aspects.captions.get(number, ""),
            kind,
            label,
            value.nominal,
            value.tolerance,
            (),
            (),
            problem,
            Measurability.NOT_MEASURABLE,
            indication,
        )
        return PmiSource(pmi_record, first, second, problem_first, problem_second)


def _label_and_sides(parts: Sequence[Record]) -> tuple[str, list[int]]:
    """The dimension's own word and the shape aspects it applies to (one of a size, two of a location)."""
    label: str = ""
    sides: list[int] = []
    location = any(part.type in LOCATIONS for part in parts)
    for part in sorted(parts, key=lambda part: part.type not in SIZES):  # a size's own word before its aspect's name
        parameters = part.parameters
        if part.type == "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE" and len(parameters) == 6:
            parameters = parameters[4:]  # behind the four of a shape aspect
        words = [parameter for parameter in parameters if isinstance(parameter, str) and parameter]
        label = label or (words[0] if words else "")
        if part.type in (*LOCATIONS, *SIZES, "SHAPE_ASPECT_RELATIONSHIP") and (location or not sides):
            sides += numbers_in(parameters)
    return label, sides[: 2 if location else 1]


def _kind(types: set[str], label: str) -> PmiKind:
    words = label.lower()
    if types & {"ANGULAR_LOCATION", "ANGULAR_SIZE"} or "angle" in words:
        return "angle"
    if "toroidal" in words or "curved" in words or "DIMENSIONAL_SIZE_WITH_PATH" in types:
        return "other"
    if types & set(LOCATIONS):
        return "distance"
    if "diameter" in words:
        return "diameter"
    return "radius" if "radius" in words else "length"
