"""The geometric tolerances in a STEP file's semantic PMI: kind, zone, modifiers, datums and toleranced features."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from math import nan

from ....part.brep import PmiRecord
from ....part.geometric_tolerances import GEOMETRIC_TOLERANCES, geometric_tolerance
from ....part.indication import Indication
from ..step_text import Enumeration, Record, StepText
from ..step_units import Units
from .datum_systems import DatumSystems, modifier_mark, modifier_words
from .dimension_text import amount
from .dimensions import DimensionReader
from .pmi_records import PmiSource
from .shape_aspects import LOCATIONS, SIZES, ShapeAspects, numbers_in

__all__ = ["GeometricToleranceReader"]

_ENTITY = {f"{kind.upper()}_TOLERANCE": kind for kind in GEOMETRIC_TOLERANCES}
_SUPERTYPES = (
    "GEOMETRIC_TOLERANCE",
    "GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE",
    "GEOMETRIC_TOLERANCE_WITH_MODIFIERS",
    "GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT",
    "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT",
    "GEOMETRIC_TOLERANCE_WITH_MAXIMUM_TOLERANCE",
    "MODIFIED_GEOMETRIC_TOLERANCE",
    "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE",
)
_COMMON = 4  # parameters of a geometric tolerance: name, description, magnitude, toleranced aspect
_OTHER = "geometric_tolerance"


@dataclass
class _Zone:
    """What a tolerance's zone is like: words before and after its size, and further modifiers in words."""

    shape: str = ""
    after: str = ""
    modifiers: tuple[str, ...] = ()


@dataclass(frozen=True)
class GeometricToleranceReader:
    """Reads the geometric tolerances of a file.

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
    def _aspects(self) -> ShapeAspects:
        return ShapeAspects(self.text)

    @cached_property
    def datum_systems(self) -> DatumSystems:
        """The file's datums."""
        return DatumSystems(self.text)

    @cached_property
    def _zones(self) -> dict[int, _Zone]:
        """The zone of each tolerance that has one of a special shape."""
        zones: dict[int, _Zone] = defaultdict(_Zone)
        for number, zone in self.text.parts("TOLERANCE_ZONE"):
            numbers = numbers_in(zone.parameters)
            forms = [n for n in numbers if "TOLERANCE_ZONE_FORM" in self.text.type_of(n)]
            words = " ".join(self._words(form).lower() for form in forms)
            datums = self.text.part(number, "TOLERANCE_ZONE_WITH_DATUM")
            for tolerance in self._tolerances_in(zone):
                zones[tolerance].shape = _shape(words)
                if "non uniform" in words or "non-uniform" in words:
                    zones[tolerance].modifiers += ("non-uniform zone",)
                if datums is not None:
                    names = "-".join(self.datum_systems.datums(numbers_in(datums.parameters[-1:])))
                    zones[tolerance].modifiers += (f"zone oriented by {names}",)
        for _, projected in self.text.parts("PROJECTED_ZONE_DEFINITION"):
            numbers = numbers_in(projected.parameters)
            length = next((value for n in reversed(numbers) if (value := self._units.value(n)) is not None), None)
            words = "" if length is None else f" {amount(length)}"
            for number in numbers[:1]:
                for tolerance in (t for zone in self.text.records(number) for t in self._tolerances_in(zone)):
                    zones[tolerance].after += f" (P){words}"
                    zones[tolerance].modifiers += (f"projected tolerance zone{words}",)
        for _, relation in self.text.parts("GEOMETRIC_TOLERANCE_RELATIONSHIP"):
            pair, name = numbers_in(relation.parameters), str(relation.parameters[0]).strip()
            if len(pair) == 2 and name:
                zones[pair[1]].modifiers += (f"lower segment ({name})",)
        return zones

    def tolerances(self) -> tuple[PmiSource, ...]:
        """All geometric tolerances in the order of their numbers."""
        return tuple(self._tolerance(number) for number in self.text.numbers(*_ENTITY, *_SUPERTYPES))

    def _tolerance(self, number: int) -> PmiSource:
        parts = {part.type: part for part in self.text.records(number)}
        kind = next((_ENTITY[name] for name in parts if name in _ENTITY), _OTHER)
        known = geometric_tolerance(kind)
        common = parts.get("GEOMETRIC_TOLERANCE") or next(
            (part for part in parts.values() if len(part.parameters) >= _COMMON), Record("", ())
        )
        magnitude, aspects = (numbers_in(common.parameters[k : k + 1]) for k in (2, 3))
        zone_mm = self._units.value(magnitude[0]) if magnitude else None
        zone = self._zones.get(number, _Zone())
        datums = self.datum_systems.datums(self._datum_records(parts, common))
        marks, words = self._modifiers(parts, common)
        size = "without a value" if zone_mm is None else amount(zone_mm)
        indicator = " ".join(f"{zone.shape}{size}{zone.after} {' '.join(marks)}".split())
        indication = Indication(
            record=number,
            text=" | ".join((f"{known.words} {indicator}", *datums)),
            zone_mm=nan if zone_mm is None else zone_mm,
            datums=datums,
            modifiers=(*words, *zone.modifiers),
        )
        name = self._aspects.captions.get(number, "") or _name(common)
        first = tuple(dict.fromkeys(n for aspect in aspects for n in self._geometry(aspect)))
        problem = known.reason
        if not first:
            problem += "; it refers to no face or edge" if aspects else "; it refers to nothing"
        pmi_record = PmiRecord(name, kind, kind, nan, None, (), (), problem, known.status, indication)
        return PmiSource(pmi_record, first, ())

    def _geometry(self, aspect: int) -> tuple[int, ...]:
        """Faces and edges of a toleranced aspect; of the feature of a dimension where it is one."""
        if {part.type for part in self.text.records(aspect)} & {*LOCATIONS, *SIZES}:
            own, _ = self._aspects.geometry(aspect)
            sides = DimensionReader(self.text).sides(aspect)
            return own or tuple(n for side in sides for n in self._aspects.geometry(side)[0])
        return self._aspects.geometry(aspect)[0]

    def _datum_records(self, parts: dict[str, Record], common: Record) -> list[int]:
        own = parts.get("GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE")
        if own is not None and len(own.parameters) < _COMMON:
            return numbers_in(own.parameters)
        further = numbers_in(common.parameters[_COMMON:])
        return [n for n in further if "DATUM" in self.text.type_of(n)]

    def _modifiers(self, parts: dict[str, Record], common: Record) -> tuple[list[str], list[str]]:
        """Modifiers as marks on the drawing, and in words."""
        marks: list[str] = []
        words: list[str] = []
        enumerations = [p.name for p in _flat(common.parameters[_COMMON:]) if isinstance(p, Enumeration)]
        for name in ("GEOMETRIC_TOLERANCE_WITH_MODIFIERS", "MODIFIED_GEOMETRIC_TOLERANCE"):
            if name in parts and parts[name] is not common:
                enumerations += [p.name for p in _flat(parts[name].parameters) if isinstance(p, Enumeration)]
        for name in dict.fromkeys(enumerations):
            marks.append(modifier_mark(name))
            words.append(modifier_words(name))
        for name, mark, meaning in (
            ("UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE", "(U) {}", "unequally disposed by {}"),
            ("GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT", "/ {}", "on any length of {}"),
            ("GEOMETRIC_TOLERANCE_WITH_MAXIMUM_TOLERANCE", "at most {}", "at most {}"),
        ):
            if name in parts:
                values = [self._units.value(n) for n in numbers_in(parts[name].parameters)]
                text = " x ".join(amount(value) for value in values if value is not None)
                if "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT" in parts and "DEFINED_UNIT" in name:
                    text, meaning = (
                        self._area(parts["GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT"], text),
                        "on any area {}",
                    )
                marks.append(mark.format(text))
                words.append(meaning.format(text))
        return marks, words

    def _area(self, area: Record, first: str) -> str:
        """The size of an area in which a tolerance applies, such as "25 x 25" or "circular 25"."""
        values = [self._units.value(n) for n in numbers_in(area.parameters)]
        second = next((amount(value) for value in values if value is not None), "")
        shape = next((p.name.lower() for p in area.parameters if isinstance(p, Enumeration)), "")
        if shape == "square":
            second = first
        return f"{first} x {second}" if second else f"{shape} {first}".strip()

    def _words(self, number: int) -> str:
        return " ".join(p for part in self.text.records(number) for p in part.parameters if isinstance(p, str))

    def _tolerances_in(self, zone: Record) -> list[int]:
        return [n for n in numbers_in(zone.parameters) if "_TOLERANCE" in f"_{self.text.type_of(n)}"]


def _flat(parameter: object) -> list[object]:
    if isinstance(parameter, tuple):
        return [leaf for member in parameter for leaf in _flat(member)]
    return [parameter]


def _name(common: Record) -> str:
    """The name that the tolerance's own record gives it, empty where it gives none."""
    name = common.parameters[0] if common.parameters else None
    return " ".join(name.replace("/", "-").split()) if isinstance(name, str) else ""


def _shape(form: str) -> str:
    """The word before the size of a zone of this form."""
    if "spherical" in form or "within a sphere" in form:
        return "spherical diameter "
    if form.startswith(("cylindrical", "circular", "within a circle", "within a cylinder")):
        return "diameter "
    return ""
