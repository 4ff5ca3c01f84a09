"""The dimensions in a STEP file's semantic PMI (AP242), read from its records.

Follows the CAx-IF "Recommended Practices for the Representation and Presentation of PMI (AP242)", sections 5
and 6: a dimension refers to shape aspects, these to faces and edges; its value is a shape dimension
representation, its deviations a plus-minus tolerance. Reading the records rather than a kernel's digest of them
keeps the sign of every deviation and every dimension whose geometry the kernel does not know.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ...part.brep import Edge, Face, PmiKind, PmiRecord, Reference
from .step_text import Record, Ref, StepText
from .step_units import Units

__all__ = ["Dimension", "DimensionReader", "to_pmi_records"]

_LOCATIONS = (
    "DIMENSIONAL_LOCATION",
    "DIRECTED_DIMENSIONAL_LOCATION",
    "DIMENSIONAL_LOCATION_WITH_PATH",
    "ANGULAR_LOCATION",
)
_SIZES = (
    "DIMENSIONAL_SIZE",
    "ANGULAR_SIZE",
    "DIMENSIONAL_SIZE_WITH_PATH",
    "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE",
)
_FACES = ("ADVANCED_FACE", "FACE_SURFACE", "FACE")
_SHELLS = ("CLOSED_SHELL", "OPEN_SHELL", "CONNECTED_FACE_SET", "CONNECTED_FACE_SUB_SET")
_ROUND = ("cylinder", "cone", "sphere", "torus")
_NO_LENGTH = 'a "{}" is no length between two points'
_DERIVED = ("CENTRE_OF_SYMMETRY", "DERIVED_SHAPE_ASPECT", "GEOMETRIC_ALIGNMENT", "EXTENSION", "TANGENT", "APEX")


@dataclass(frozen=True)
class Dimension:
    """A dimension as the file's records give it.

    Parameters
    ----------
    pmi_record
        All but the references.
    first, second
        Record numbers of the faces and edges on either side.
    problem_first, problem_second
        Why a side could not be followed to faces and edges; empty where it could.
    """

    pmi_record: PmiRecord
    first: tuple[int, ...]
    second: tuple[int, ...]
    problem_first: str = ""
    problem_second: str = ""


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
    def _units(self) -> Units:
        return Units(self.text)

    @cached_property
    def _items(self) -> dict[int, list[int]]:
        """Geometry of each shape aspect."""
        items: dict[int, list[int]] = defaultdict(list)
        for _, usage in self.text.parts("GEOMETRIC_ITEM_SPECIFIC_USAGE", "ITEM_IDENTIFIED_REPRESENTATION_USAGE"):
            if len(usage.parameters) == 5 and isinstance(usage.parameters[2], Ref):
                items[usage.parameters[2].number] += _numbers(usage.parameters[4])
        return items

    @cached_property
    def _members(self) -> dict[int, list[int]]:
        """Shape aspects that each composite or derived shape aspect is made of."""
        members: dict[int, list[int]] = defaultdict(list)
        locations = set(self.text.numbers(*_LOCATIONS))  # these relate two aspects, of which neither is a member
        for number, relation in self.text.parts(
            "SHAPE_ASPECT_RELATIONSHIP", "SHAPE_ASPECT_DERIVING_RELATIONSHIP", "SHAPE_ASPECT_ASSOCIATIVITY"
        ):
            if len(relation.parameters) == 4 and number not in locations:
                whole, part = _numbers(relation.parameters[2:3]), _numbers(relation.parameters[3:4])
                for aspect in whole:
                    members[aspect] += part
        return members

    @cached_property
    def _values(self) -> dict[int, list[int]]:
        """Representation items (values, notes) of each dimension."""
        values: dict[int, list[int]] = defaultdict(list)
        for _, link in self.text.parts("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            numbers = _numbers(link.parameters)
            if len(numbers) == 2:
                for part in self.text.records(numbers[1]):
                    if len(part.parameters) == 3:
                        values[numbers[0]] += _numbers(part.parameters[1])
        return values

    @cached_property
    def plus_minus(self) -> dict[int, list[int]]:
        """Ranges (records) that the plus-minus tolerances give to each dimension."""
        ranges: dict[int, list[int]] = defaultdict(list)
        for _, tolerance in self.text.parts("PLUS_MINUS_TOLERANCE"):
            numbers = _numbers(tolerance.parameters)
            if len(numbers) == 2:
                ranges[numbers[1]].append(numbers[0])
        return ranges

    @cached_property
    def _captions(self) -> dict[int, str]:
        """Name of the annotation that shows each dimension, such as "Linear Size.3"."""
        captions: dict[int, str] = {}
        for _, link in self.text.parts(
            "DRAUGHTING_MODEL_ITEM_ASSOCIATION", "DRAUGHTING_MODEL_ITEM_ASSOCIATION_WITH_PLACEHOLDER"
        ):
            numbers = _numbers(link.parameters)
            if len(numbers) < 3:
                continue
            for part in self.text.records(numbers[2]):
                name = part.parameters[0] if part.parameters else None
                if isinstance(name, str) and name.strip():
                    captions.setdefault(numbers[0], " ".join(name.replace("/", "-").split()))
        return captions

    def dimensions(self) -> tuple[Dimension, ...]:
        """All dimensions in the order of their numbers, with unique names."""
        numbers = self.text.numbers(*_LOCATIONS, *_SIZES)
        return _named_apart([self._dimension(number) for number in numbers])

    def notes(self, pmi_records: Sequence[PmiRecord]) -> list[str]:
        """What the user should know about the dimensions read: what is missing, and how the counts compare."""
        if not pmi_records:
            return ["The file has no semantic PMI dimensions: geometry only."]
        known = set(self.text.numbers(*_LOCATIONS, *_SIZES))
        notes = []
        stray = sum(len(ranges) for number, ranges in self.plus_minus.items() if number not in known)
        if stray:
            notes.append(f"{stray} PLUS_MINUS_TOLERANCE entities belong to no dimension and are not used.")
        repeated = sum(len(ranges) - 1 for number, ranges in self.plus_minus.items() if number in known)
        if repeated:
            notes.append(
                f"{repeated} PLUS_MINUS_TOLERANCE entities repeat one of the same dimension; the first counts."
            )
        angles = sum(pmi_record.kind == "angle" and pmi_record.tolerance_mm is not None for pmi_record in pmi_records)
        if angles:
            notes.append(f"Toleranced dimensions that are angles: {angles}.")
        limits = sum(pmi_record.tolerance_mm is not None for pmi_record in pmi_records) - len(
            self.plus_minus.keys() & known
        )
        if limits > 0:
            notes.append(f"Dimensions toleranced by limits, without a PLUS_MINUS_TOLERANCE entity: {limits}.")
        return notes

    def _dimension(self, number: int) -> Dimension:
        parts = self.text.records(number)
        types = {part.type for part in parts}
        label, sides = _label_and_sides(parts)
        first, problem_first = self._geometry(sides[0]) if sides else ((), "the dimension refers to nothing")
        second, problem_second = self._geometry(sides[1]) if len(sides) > 1 else ((), "")
        kind = _kind(types, label)
        nominal, tolerance, problem = self._magnitude(number)
        if not problem and kind == "other":
            problem = _NO_LENGTH.format(label)
        pmi_record = PmiRecord(self._captions.get(number, ""), kind, label, nominal, tolerance, (), (), problem)
        return Dimension(pmi_record, first, second, problem_first, problem_second)

    def _magnitude(self, number: int) -> tuple[float, tuple[float, float] | None, str]:
        """Nominal value, deviations (mm or rad) and what is wrong with them."""
        named: dict[str, float] = {}
        for item in self._values[number]:
            value = self._units.value(item)
            if value is not None:
                named.setdefault(self._item_name(item), value)
        lower, upper = named.pop("lower limit", None), named.pop("upper limit", None)
        nominal = named.get("nominal value", next(iter(named.values()), math.nan))
        if lower is not None and upper is not None:
            nominal = (lower + upper) / 2 if math.isnan(nominal) else nominal
            return nominal, (lower - nominal, upper - nominal), ""
        if number in self.plus_minus:
            tolerance, problem = self._deviations(self.plus_minus[number][0])
            return nominal, tolerance, problem or ("the file gives no value" if math.isnan(nominal) else "")
        return nominal, None, "the file gives no value" if math.isnan(nominal) else ""

    def _item_name(self, item: int) -> str:
        part = self.text.part(item, "REPRESENTATION_ITEM")
        name = part.parameters[0] if part is not None and part.parameters else ""
        return name.lower() if isinstance(name, str) else ""

    def _deviations(self, number: int) -> tuple[tuple[float, float] | None, str]:
        limits = self.text.part(number, "TOLERANCE_VALUE")
        if limits is not None:
            values = [self._units.value(limit) for limit in _numbers(limits.parameters)]
            if len(values) == 2 and values[0] is not None and values[1] is not None:
                return (min(values[0], values[1]), max(values[0], values[1])), ""
        fit = self.text.part(number, "LIMITS_AND_FITS")
        if fit is not None:
            words = [word for word in fit.parameters if isinstance(word, str) and word]
            return None, f"a tolerance class ({' '.join(words)}) is not converted to deviations"
        return None, "the tolerance has no readable limits"

    def _geometry(self, aspect: int) -> tuple[tuple[int, ...], str]:
        """Faces and edges under a shape aspect, and what it also or only refers to that is neither."""
        found: dict[int, None] = {}
        foreign: Counter[str] = Counter()
        derived = False
        pending, seen = [aspect], set()
        while pending:
            current = pending.pop(0)
            if current in seen:
                continue
            seen.add(current)
            derived = derived or any(part.type in _DERIVED for part in self.text.records(current))
            pending += self._members[current]
            for item in self._items[current]:
                topology = self._topology(item)
                found.update(dict.fromkeys(topology))
                if not topology:
                    foreign[self._describe(item)] += 1
        if found:
            return tuple(found), "refers to a centre or another derived element" if derived else ""
        what = ", ".join(foreign)
        return (), f"refers to {what}, which is no face or edge" if what else "refers to no geometry"

    def _topology(self, item: int) -> tuple[int, ...]:
        types = set(self.text.type_of(item).split("+"))
        if types & {*_FACES, "EDGE_CURVE"}:
            return (item,)
        if types & {"ORIENTED_EDGE", "SUBEDGE"}:
            return tuple(n for n in self.text.references(item) if "EDGE_CURVE" in self.text.type_of(n))
        if types & set(_SHELLS):
            return tuple(n for n in self.text.references(item) if self.text.type_of(n) in _FACES)
        return ()

    def _describe(self, item: int) -> str:
        parts = self.text.records(item)
        name = next((p.parameters[0] for p in parts if p.parameters and isinstance(p.parameters[0], str)), "")
        words = self.text.type_of(item).replace("_", " ").lower() or "a missing record"
        return f'{words} "{name}"' if name else words


def _numbers(parameters: object) -> list[int]:
    """Numbers of all references in (nested) parameters."""
    if isinstance(parameters, Ref):
        return [parameters.number]
    if isinstance(parameters, Record):
        return _numbers(parameters.parameters)
    if isinstance(parameters, tuple):
        return [number for parameter in parameters for number in _numbers(parameter)]
    return []


def _label_and_sides(parts: Sequence[Record]) -> tuple[str, list[int]]:
    """The dimension's own word and the shape aspects it applies to (one of a size, two of a location)."""
    label, sides = "", []
    location = any(part.type in _LOCATIONS for part in parts)
    for part in parts:
        words = [parameter for parameter in part.parameters if isinstance(parameter, str) and parameter]
        label = label or (words[0] if words else "")
        if part.type in (*_LOCATIONS, *_SIZES, "SHAPE_ASPECT_RELATIONSHIP"):
            sides += _numbers(part.parameters)
    return label, sides[: 2 if location else 1]


def _kind(types: set[str], label: str) -> PmiKind:
    words = label.lower()
    if types & {"ANGULAR_LOCATION", "ANGULAR_SIZE"} or "angle" in words:
        return "angle"
    if "toroidal" in words or "curved" in words or "DIMENSIONAL_SIZE_WITH_PATH" in types:
        return "other"
    if types & set(_LOCATIONS):
        return "distance"
    if "diameter" in words:
        return "diameter"
    return "radius" if "radius" in words else "length"


def _named_apart(dimensions: Sequence[Dimension]) -> tuple[Dimension, ...]:
    """The dimensions with unique names: the file's, or the label with a running number."""
    taken: Counter[str] = Counter()
    named = []
    for index, dimension in enumerate(dimensions, start=1):
        label = dimension.pmi_record.label.replace("/", "-").replace(" ", "_") or "dimension"
        wanted = dimension.pmi_record.name or f"{label}_{index}"
        name, repeat = wanted, 1
        while taken[name]:
            repeat += 1
            name = f"{wanted}_{repeat}"
        taken[name] += 1
        named.append(replace(dimension, pmi_record=replace(dimension.pmi_record, name=name)))
    return tuple(named)


def to_pmi_records(
    dimensions: Sequence[Dimension],
    shapes: Mapping[int, Sequence[Reference]],
    faces: Sequence[Face],
    edges: Sequence[Edge],
) -> tuple[PmiRecord, ...]:
    """PMI records with their references.

    Parameters
    ----------
    dimensions
        The dimensions as read from the records.
    shapes
        The faces and edges of the part that stand for each record.
    faces, edges
        All faces and edges of the part.
    """
    pmi_records = []
    for dimension in dimensions:
        pmi_record, problems = dimension.pmi_record, [dimension.pmi_record.problem]
        first, problem = _side(dimension.first, dimension.problem_first, shapes, faces)
        problems.append(problem)
        second, problem = _side(dimension.second, dimension.problem_second, shapes, faces)
        problems.append(problem)
        kind = pmi_record.kind
        if kind == "length" and "curve" in pmi_record.label.lower() and not _straight(first, edges):
            kind = "other"
            problems.append(_NO_LENGTH.format(pmi_record.label))
        problem = "; ".join(dict.fromkeys(problem for problem in problems if problem))
        pmi_records.append(replace(pmi_record, kind=kind, first=first, second=second, problem=problem))
    return tuple(pmi_records)


def _side(
    numbers: Sequence[int], problem: str, shapes: Mapping[int, Sequence[Reference]], faces: Sequence[Face]
) -> tuple[tuple[Reference, ...], str]:
    """References of one side, and what is wrong with them."""
    references = tuple(dict.fromkeys(reference for number in numbers for reference in shapes.get(number, ())))
    lost = sum(not shapes.get(number) for number in numbers)
    if lost:
        return references, f"{lost} of {len(numbers)} faces and edges it refers to are not on the part"
    if references and all(r.kind == "face" and faces[r.index].kind in _ROUND for r in references):
        return references, ""  # a round face stands for its own axis or centre
    return references, problem


def _straight(references: Sequence[Reference], edges: Sequence[Edge]) -> bool:
    return bool(references) and all(r.kind == "edge" and edges[r.index].kind == "line" for r in references)
