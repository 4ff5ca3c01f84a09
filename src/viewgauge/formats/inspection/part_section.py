"""The section ``part``: what is inspected, and the characteristics that the file itself gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, WithJsonSchema, model_validator

from ...exceptions import InputError
from ...part.characteristic import Observed
from ..files.problems import Problems
from ..files.units import LENGTH, parse_quantities
from .validation import validate
from .values import Apart, Length, LengthUnit, Name, Section, Tolerance, is_number, quantities_schema

__all__ = ["CharacteristicEntry", "CharacteristicSection", "PartSection", "StatedOnFeatures", "read_characteristics"]


@dataclass(frozen=True)
class StatedOnFeatures:
    """A characteristic stated on features of the part by their ids.

    Parameters
    ----------
    kind
        "distance", "diameter" or "position".
    features
        Ids: two of a distance, else one.
    nominal_mm
        Nominal value, mm; None where not given.
    datums, basic_mm, zone_mm
        Of a position: letters of the datums, basic dimensions from them, mm, and the width of the zone, mm.
    """

    kind: str
    features: tuple[str, ...]
    nominal_mm: float | None = None
    datums: tuple[str, ...] = ()
    basic_mm: tuple[float, ...] = ()
    zone_mm: float | None = None


@dataclass(frozen=True)
class CharacteristicEntry:
    """An entry of ``part.characteristics``.

    Parameters
    ----------
    id
        Unique within the file.
    ends_mm
        The two points of a measurand, mm, part frame; None where the entry changes the characteristic of this id
        that was read from the part's PMI, or states one on features.
    stated
        What is stated on features; None for any other entry.
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
    stated: StatedOnFeatures | None = None

    @property
    def is_override(self) -> bool:
        """The entry changes a characteristic of the PMI instead of adding one."""
        return self.ends_mm is None and self.stated is None


def _read_basic(value: object) -> tuple[float, ...]:
    return parse_quantities(value, LENGTH, (1, 2, 3))


_KINDS = ("distance", "diameter", "position")
_OF_POSITION = ("datums", "basic", "zone")
_Basic = Annotated[
    tuple[float, ...], BeforeValidator(_read_basic), WithJsonSchema(quantities_schema(LENGTH, (1, 2, 3), "any"))
]
_POINT = quantities_schema(LENGTH, (3,), "any")
_PLAIN_POINT = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
_POINTS = {"type": "array", "items": {"anyOf": [_PLAIN_POINT, _POINT]}, "minItems": 2, "maxItems": 2}


class CharacteristicSection(Section):
    """A measurand of the user's own, or what is to be changed of a characteristic read from PMI."""

    model_config = ConfigDict(
        json_schema_extra={
            "dependencies": {
                "unit": ["points"],
                "nominal": {"anyOf": [{"required": ["distance"]}, {"required": ["diameter"]}]},
                "datums": ["position"],
                "basic": ["position"],
                "zone": ["position"],
            },
            "anyOf": [
                {"required": ["distance"], "properties": {"points": False}},
                {"required": ["diameter"], "properties": {"points": False}},
                {"required": ["position"], "properties": {"points": False}},
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
    distance: Annotated[list[Name], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="ids of the two features whose distance it is, such as [F12, F7]"
    )
    diameter: Name | None = Field(default=None, description="id of the hole or boss whose diameter it is, such as H3")
    position: Name | None = Field(default=None, description="id of the feature whose position has a zone, such as H3")
    nominal: Length | None = Field(
        default=None, description="the nominal value, which is compared with the geometry, such as 15 mm"
    )
    datums: Annotated[list[Name], Field(min_length=1, max_length=3)] | None = Field(
        default=None, description="of a position: letters of the datums, such as [A, B, C]"
    )
    basic: _Basic | None = Field(
        default=None, description='of a position: the basic dimensions from the datums, such as "[15, 20] mm"'
    )
    zone: Length | None = Field(default=None, description="of a position: the width of the zone, such as 0.2 mm")
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
        self._one_kind()
        if self.points is None and self.stated is None and self.tolerance is None and self.observed is None:
            raise InputError(
                "the entry says nothing but its id",
                expected="two points, or features (distance, diameter, position), or a tolerance for the "
                "characteristic of this id read from the part",
            )
        return self

    def _one_kind(self) -> None:
        given = [name for name in ("points", *_KINDS) if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(
                "an entry is one characteristic",
                key=given[1],
                got=" and ".join(given),
                expected="only one of points, distance, diameter and position",
            )
        for name in _OF_POSITION:
            if getattr(self, name) is not None and self.position is None:
                raise InputError("this belongs to a position", key=name, expected="position: the id of a feature")
        if self.nominal is not None and self.distance is None and self.diameter is None:
            raise InputError("this belongs to a distance or a diameter", key="nominal", got=f"{self.nominal:g} mm")
        if self.tolerance is not None and self.position is not None:
            raise InputError("a position has a zone, no tolerance", key="tolerance", expected="zone: 0.2 mm")

    @property
    def stated(self) -> StatedOnFeatures | None:
        """What the entry states on features; None where it names none."""
        if self.distance is not None:
            return StatedOnFeatures("distance", tuple(self.distance), self.nominal)
        if self.diameter is not None:
            return StatedOnFeatures("diameter", (self.diameter,), self.nominal)
        if self.position is not None:
            datums, basic = tuple(self.datums or ()), self.basic or ()
            return StatedOnFeatures("position", (self.position,), None, datums, basic, self.zone)
        return None

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
        default=None, description="the part's file, beside this one: STEP (.stp, .step, .p21, .stpz) or a mesh"
    )
    unit: LengthUnit | None = Field(
        default=None, description="the unit of a mesh's coordinates, such as inch; by default the file's own, else mm"
    )
    characteristics: Annotated[list[Any] | None, Apart(CharacteristicSection, listed=True)] = Field(
        default=None, description="a list of characteristics, added to those read from the part's PMI"
    )
    datums: dict[Name, Name] | None = Field(
        default=None, description="ids of the features that are datums, by their letters, such as {A: F1, B: F2}"
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
            section.id, section.ends_mm, section.tolerance, section.observed, line, section.stated
        )
    return tuple(entries.values())
