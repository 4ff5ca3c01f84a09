"""The section ``part``: what is inspected, and the characteristics that the file itself gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import ConfigDict, Field, WithJsonSchema, model_validator

from ...exceptions import InputError
from ...part.characteristic import Observed
from ..files.problems import Problems
from ..files.units import LENGTH, parse_quantities
from .validation import validate
from .values import Apart, LengthUnit, Name, Section, Tolerance, is_number, quantities_schema

__all__ = ["CharacteristicEntry", "CharacteristicSection", "PartSection", "read_characteristics"]


@dataclass(frozen=True)
class CharacteristicEntry:
    """An entry of ``part.characteristics``.

    Parameters
    ----------
    id
        Unique within the file.
    ends_mm
        The two points of a measurand, mm, part frame; None where the entry changes the characteristic of this id
        that was read from the part's PMI.
    tolerance_mm
        (lower, upper) deviation, mm; None where not given.
    observed
        What must be seen; None where not given ("ends" for a measurand, unchanged for a characteristic of the PMI).
    line
        1-based line in the inspection file, for messages.
    """

    id: str
    ends_mm: tuple[tuple[float, ...], tuple[float, ...]] | None
    tolerance_mm: tuple[float, float] | None
    observed: Observed | None
    line: int

    @property
    def is_override(self) -> bool:
        """The entry changes a characteristic of the PMI instead of adding one."""
        return self.ends_mm is None


_POINT = quantities_schema(LENGTH, (3,), "any")
_PLAIN_POINT = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
_POINTS = {"type": "array", "items": {"anyOf": [_PLAIN_POINT, _POINT]}, "minItems": 2, "maxItems": 2}


class CharacteristicSection(Section):
    """A measurand of the user's own, or what is to be changed of a characteristic read from PMI."""

    model_config = ConfigDict(
        json_schema_extra={
            "dependencies": {"unit": ["points"]},
            "anyOf": [
                {"required": ["points", "unit"]},
                {"required": ["points"], "properties": {"points": {"items": _POINT}}},
                {"required": ["tolerance"], "properties": {"points": False}},
                {"required": ["observed"], "properties": {"points": False}},
            ],
        }
    )

    id: Name = Field(description="a name, unique among the characteristics")
    points: Annotated[Annotated[list[Any], Field(min_length=2, max_length=2)] | None, WithJsonSchema(_POINTS)] = Field(
        default=None,
        description="two points of the part's surface, part frame, such as [[0, 0, 40], [60, 0, 40]] with unit: mm",
    )
    unit: LengthUnit | None = Field(default=None, description="the unit of the points' plain numbers, such as mm")
    tolerance: Tolerance | None = Field(
        default=None, description='plus/minus, such as 0.1 mm, or two deviations, such as "[-0.05, 0.1] mm"'
    )
    observed: Observed | None = Field(
        default=None, description="what must be seen: ends (both end points), or whole (the whole segment)"
    )

    @model_validator(mode="after")
    def _whole(self) -> CharacteristicSection:
        if self.points is None and self.unit is not None:
            raise InputError("the unit belongs to points", key="unit", expected="points and their unit, or neither")
        if (ends := self.ends_mm) is not None and ends[0] == ends[1]:
            raise InputError("the two points are the same", key="points", got=f"{list(ends[0])} mm")
        if self.points is None and self.tolerance is None and self.observed is None:
            raise InputError(
                "the entry says nothing but its id",
                expected="two points, or a tolerance for the characteristic of this id read from the part",
            )
        return self

    @property
    def ends_mm(self) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
        """The two points, mm, part frame; None where the entry has none; raises InputError."""
        if self.points is None:
            return None
        start, end = (self._point(point) for point in self.points)
        return start, end

    def _point(self, point: object) -> tuple[float, ...]:
        if self.unit is not None and isinstance(point, list):
            point = [f"{value} {self.unit}" if is_number(value) else value for value in point]
        try:
            return parse_quantities(point, LENGTH, (3,))
        except InputError as error:
            raise InputError(
                error.problem,
                key="points",
                got=error.got,
                expected="two points, such as [[0, 0, 40], [60, 0, 40]] with unit: mm beside them",
                hint=error.hint,
            ) from error


class PartSection(Section):
    """The part and its characteristics, which are read one by one."""

    file: Name | None = Field(
        default=None, description="the part's file, beside this one: STEP (.stp, .step, .p21) or a mesh"
    )
    unit: LengthUnit | None = Field(
        default=None, description="the unit of a mesh's coordinates, such as inch; by default the file's own, else mm"
    )
    characteristics: Annotated[list[Any] | None, Apart(CharacteristicSection, listed=True)] = Field(
        default=None, description="a list of characteristics, added to those read from the part's PMI"
    )
    general_tolerance: Tolerance | None = Field(
        default=None, description="the tolerance of characteristics that have none of their own, such as 0.1 mm"
    )


def read_characteristics(values: object, problems: Problems) -> tuple[CharacteristicEntry, ...]:
    """The entries of ``part.characteristics``; what is wrong with any goes to ``problems``."""
    entries: dict[str, CharacteristicEntry] = {}
    for index, value in enumerate(values if isinstance(values, list) else ()):
        where = ("part", "characteristics", index)
        section = validate(CharacteristicSection, value, where, problems)
        if section is None:
            continue
        line = problems.line_of(where) or 1
        if section.id in entries:
            first = f"'{section.id}', first in line {entries[section.id].line}"
            problems.add((*where, "id"), "the id is used twice", got=first, expected="a unique id")
            continue
        entries[section.id] = CharacteristicEntry(
            section.id, section.ends_mm, section.tolerance, section.observed, line
        )
    return tuple(entries.values())
