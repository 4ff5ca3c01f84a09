"""The value of a dimension: nominal, deviations or limits, tolerance class, and what qualifies it."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property

from ....part.limits_and_fits import class_deviations_mm
from ..step_text import Record, StepText
from ..step_units import Units
from .shape_aspects import numbers_in

__all__ = ["DimensionValue", "DimensionValues"]

_NO_VALUE = "the file gives no value"
_NOT_TOLERANCED = {
    "theoretical": "basic",
    "basic": "basic",
    "theoretically exact": "basic",
    "auxiliary": "reference",
    "reference": "reference",
}
_SIDES = {"minimum": "lower", "maximum": "upper"}
_WITHOUT_MEANING = ("designed", "nominal", "dimensional note", "")  # of a type qualifier: no other quantity is meant
_NOT_TWO_POINT = (  # sizes of ISO 14405-1 that no single pair of opposite points has
    *("average", "mean", "median", "mid-range", "range of sizes", "rank order", "least square", "inscribed"),
    *("circumscribed", "minimax", "circumference", "area diameter", "volume diameter", "sphere", "standard deviation"),
)


@dataclass(frozen=True)
class DimensionValue:
    """What a dimension demands, mm (rad of an angle).

    Parameters
    ----------
    nominal
        NaN where the file gives none.
    tolerance
        (lower, upper) deviation; None where it has none or only one limit.
    limits
        (lower, upper) limit where only one of them is given; else (None, None).
    tolerance_class
        Such as "H7"; empty where there is none.
    modifiers
        What qualifies the value, in words, such as "average", "basic", "reference", "statistical".
    toleranced
        The file demands something of the value.
    problem
        Why the value cannot be used; empty where it can.
    """

    nominal: float = math.nan
    tolerance: tuple[float, float] | None = None
    limits: tuple[float | None, float | None] = (None, None)
    tolerance_class: str = ""
    modifiers: tuple[str, ...] = ()
    toleranced: bool = False
    problem: str = ""

    @property
    def not_two_point(self) -> str:
        """The modifier that asks for another size than the distance of two points; empty where there is none."""
        return next((m for m in self.modifiers if any(word in m.lower() for word in _NOT_TWO_POINT)), "")


@dataclass
class _Items:
    """Values of one dimension by name, limits, and modifiers."""

    named: dict[str, float] = field(default_factory=dict)
    lower: float | None = None
    upper: float | None = None
    modifiers: dict[str, None] = field(default_factory=dict)


@dataclass(frozen=True)
class DimensionValues:
    """Reads the values of a file's dimensions.

    Parameters
    ----------
    text
        The file's records.
    """

    text: StepText

    @cached_property
    def units(self) -> Units:
        """The file's units."""
        return Units(self.text)

    @cached_property
    def _items_of(self) -> dict[int, list[int]]:
        """Representation items (values, notes) of each dimension."""
        values: dict[int, list[int]] = defaultdict(list)
        for _, link in self.text.parts("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            numbers = numbers_in(link.parameters)
            if len(numbers) == 2:
                for part in self.text.records(numbers[1]):
                    if len(part.parameters) == 3:
                        values[numbers[0]] += numbers_in(part.parameters[1])
        return values

    @cached_property
    def plus_minus(self) -> dict[int, list[int]]:
        """Ranges (records) that the plus-minus tolerances give to each dimension."""
        ranges: dict[int, list[int]] = defaultdict(list)
        for _, tolerance in self.text.parts("PLUS_MINUS_TOLERANCE"):
            numbers = numbers_in(tolerance.parameters)
            if len(numbers) == 2:
                ranges[numbers[1]].append(numbers[0])
        return ranges

    def value(self, number: int, kind: str) -> DimensionValue:
        """The value of the dimension with this record number."""
        items = self._items(number)
        nominal = items.named.get("nominal value", next(iter(items.named.values()), math.nan))
        modifiers = tuple(items.modifiers)
        lower, upper = items.lower, items.upper
        if lower is not None and upper is not None:
            nominal = (lower + upper) / 2 if math.isnan(nominal) else nominal
            tolerance = (lower - nominal, upper - nominal)
            return DimensionValue(nominal, tolerance, modifiers=modifiers, toleranced=True)
        problem = _NO_VALUE if math.isnan(nominal) else ""
        if number in self.plus_minus:
            deviations, tolerance_class, unread = self._deviations(self.plus_minus[number][0], nominal, kind)
            return DimensionValue(
                nominal,
                deviations,
                (None, None),
                tolerance_class,
                modifiers,
                toleranced=True,
                problem=unread or problem,
            )
        if lower is not None or upper is not None:
            nominal = next(v for v in (nominal, upper, lower) if v is not None and not math.isnan(v))
            return DimensionValue(nominal, None, (lower, upper), "", modifiers, toleranced=True)
        return DimensionValue(nominal, modifiers=modifiers, problem=problem)

    def _items(self, number: int) -> _Items:
        found = _Items()
        for item in self._items_of[number]:
            value, name, qualifiers = self.units.value(item), self._item_name(item), self._qualifiers(item)
            if value is None:
                found.modifiers.update(dict.fromkeys(self._notes(item)))
                continue
            side = name.removesuffix(" limit") if name in ("lower limit", "upper limit") else ""
            if not side and number not in self.plus_minus:  # else the deviations are from this value
                side = next((side for word, side in _SIDES.items() if word in qualifiers), "")
            if side == "lower":
                found.lower = value if found.lower is None else found.lower
            elif side == "upper":
                found.upper = value if found.upper is None else found.upper
            else:
                found.named.setdefault(name, value)
            found.modifiers.update(dict.fromkeys(q for q in qualifiers if q not in _WITHOUT_MEANING))
        return found

    def _item_name(self, item: int) -> str:
        part = self.text.part(item, "REPRESENTATION_ITEM")
        name = part.parameters[0] if part is not None and part.parameters else ""
        return name.lower() if isinstance(name, str) else ""

    def _qualifiers(self, item: int) -> list[str]:
        """Words that qualify a value, such as "maximum" or "average"."""
        part = self.text.part(item, "QUALIFIED_REPRESENTATION_ITEM")
        numbers = numbers_in(part.parameters) if part is not None else []
        words = []
        for number in numbers:
            qualifier = self.text.part(number, "TYPE_QUALIFIER")
            words += [p.strip().lower() for p in (qualifier.parameters if qualifier else ()) if isinstance(p, str)]
        return words

    def _notes(self, item: int) -> list[str]:
        """The words of a "dimensional note"."""
        part = self.text.part(item, "DESCRIPTIVE_REPRESENTATION_ITEM")
        words = [p for p in part.parameters if isinstance(p, str)] if part is not None else []
        if len(words) != 2 or words[0].strip().lower() != "dimensional note" or not words[1].strip():
            return []
        note = words[1].strip().lower()
        return [_NOT_TOLERANCED.get(note, note)]

    def _deviations(self, number: int, nominal: float, kind: str) -> tuple[tuple[float, float] | None, str, str]:
        """Deviations, the tolerance class, and what is wrong with them."""
        limits = self.text.part(number, "TOLERANCE_VALUE")
        if limits is not None:
            values = [self.units.value(limit) for limit in numbers_in(limits.parameters)]
            if len(values) == 2 and values[0] is not None and values[1] is not None:
                return (min(values[0], values[1]), max(values[0], values[1])), "", ""
        fit = self.text.part(number, "LIMITS_AND_FITS")
        if fit is None:
            return None, "", "the tolerance has no readable limits"
        name, letter, grade = _tolerance_class(fit)
        deviations = None if kind == "angle" or math.isnan(nominal) else class_deviations_mm(nominal, letter, grade)
        if deviations is None:
            return None, name, f"the tolerance class {name} of this size is not among those known (ISO 286, to 500 mm)"
        return deviations, name, ""


def _tolerance_class(fit: Record) -> tuple[str, str, str]:
    """Name, letter and grade of a tolerance class: ('H', 'hole', '7', 'ISO 286') is H7."""
    words = [word.strip() for word in fit.parameters if isinstance(word, str)]
    variances, grade = words[:2], words[2] if len(words) > 2 else ""
    side = next((word.lower() for word in variances if word.lower() in ("hole", "shaft")), "")
    letter = next((word for word in variances if word.isalpha() and len(word) <= 2), "")
    if grade.upper().startswith("IT"):
        grade = grade[2:]
    if letter and grade.lower().startswith(letter.lower()):
        grade = grade[len(letter) :]
    letter = letter.upper() if side == "hole" else letter.lower() if side == "shaft" else letter
    return f"{letter}{grade}" or "without a name", letter, grade
