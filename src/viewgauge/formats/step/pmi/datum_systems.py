"""Datums, datum systems and datum targets, in the order and with the modifiers that the file gives them."""

from __future__ import annotations

from dataclasses import dataclass

from ..step_text import Enumeration, Record, Ref, StepText
from ..step_units import Units
from .dimension_text import amount
from .shape_aspects import numbers_in

__all__ = ["DatumSystems", "modifier_mark", "modifier_words"]

_MARKS = {
    "MAXIMUM_MATERIAL_REQUIREMENT": "M",
    "MAXIMUM_MATERIAL_CONDITION": "M",
    "LEAST_MATERIAL_REQUIREMENT": "L",
    "LEAST_MATERIAL_CONDITION": "L",
    "REGARDLESS_OF_FEATURE_SIZE": "S",
    "RECIPROCITY_REQUIREMENT": "R",
    "FREE_STATE": "F",
    "FREE_STATE_CONDITION": "F",
    "TANGENT_PLANE": "T",
    "STATISTICAL_TOLERANCE": "ST",
    "COMMON_ZONE": "CZ",
    "SEPARATE_REQUIREMENT": "SZ",
    "SEPARATE_SIMULTANEOUS_REQUIREMENT": "SIM",
    "ANY_CROSS_SECTION": "ACS",
    "ANY_LONGITUDINAL_SECTION": "ALS",
    "LINE_ELEMENT": "LE",
    "NOT_CONVEX": "NC",
    "PITCH_DIAMETER": "PD",
    "MAJOR_DIAMETER": "MD",
    "MINOR_DIAMETER": "LD",
    "TRANSLATION": ">",
    "POINT": "PT",
    "LINE": "SL",
    "PLANE": "PL",
    "BASIC": "[ ]",
    "CONTACTING_FEATURE": "CF",
    "DEGREE_OF_FREEDOM_CONSTRAINT_X": "x",
    "DEGREE_OF_FREEDOM_CONSTRAINT_Y": "y",
    "DEGREE_OF_FREEDOM_CONSTRAINT_Z": "z",
    "DEGREE_OF_FREEDOM_CONSTRAINT_U": "u",
    "DEGREE_OF_FREEDOM_CONSTRAINT_V": "v",
    "DEGREE_OF_FREEDOM_CONSTRAINT_W": "w",
}
_TARGETS = ("DATUM_TARGET", "PLACED_DATUM_TARGET_FEATURE")
_DEPTH = 6


def modifier_mark(name: str) -> str:
    """A modifier as it stands on a drawing, such as "(M)"; in words where it has no mark."""
    return f"({_MARKS.get(name, modifier_words(name))})"


def modifier_words(name: str) -> str:
    """A modifier in words, such as "maximum material requirement"."""
    return name.lower().replace("_", " ")


@dataclass(frozen=True)
class DatumSystems:
    """The datums of a file.

    Parameters
    ----------
    text
        The file's records.
    """

    text: StepText

    def datums(self, numbers: list[int]) -> tuple[str, ...]:
        """The datums that the records of a datum reference name, in their order, such as ``("A", "B-C (M)")``.

        A record is a datum system, which lists compartments, or (before edition 1 of AP242) a datum reference with its
        place in the order.
        """
        named: list[tuple[float, str]] = []
        for place, number in enumerate(numbers):
            system = self.text.part(number, "DATUM_SYSTEM")
            if system is not None:
                compartments = numbers_in(system.parameters[-1:])
                named += [(n, self._name(compartment, 0)) for n, compartment in enumerate(compartments)]
                continue
            order = next(
                (p for part in self.text.records(number) for p in part.parameters if isinstance(p, float)), place
            )
            named.append((float(order), self._name(number, 0)))
        return tuple(name for _, name in sorted(named, key=lambda entry: entry[0]))

    def targets(self) -> tuple[str, ...]:
        """Names of the datum targets, such as "A1"."""
        letters: dict[int, str] = {}
        for _, relation in self.text.parts("SHAPE_ASPECT_RELATIONSHIP", "DATUM_TARGET_RELATIONSHIP"):
            for number in numbers_in(relation.parameters):
                letter = self._letter(number)
                if letter:
                    letters |= dict.fromkeys(numbers_in(relation.parameters), letter)
        found = []
        for number, target in self.text.parts(*_TARGETS):
            words = [parameter for parameter in target.parameters if isinstance(parameter, str)]
            found.append((letters.get(number, "") + (words[-1] if words else "")) or "without a name")
        return tuple(sorted(found))

    def _letter(self, number: int) -> str:
        part = self.text.part(number, "DATUM") or self.text.part(number, "COMMON_DATUM")
        words = [parameter for parameter in (part.parameters if part else ()) if isinstance(parameter, str)]
        if part is not None and not words:  # a complex record has the letter in its first part
            aspects = self.text.part(number, "SHAPE_ASPECT")
            words = [parameter for parameter in (aspects.parameters if aspects else ()) if isinstance(parameter, str)]
        return words[-1].strip() if words else ""

    def _name(self, number: int, depth: int) -> str:
        """A datum, or several joined to a common one, with the modifiers of their compartment."""
        letter = self._letter(number)
        if letter or depth > _DEPTH:
            return letter or "?"
        bases: list[str] = []
        marks: list[str] = []
        for part in self.text.records(number):
            for parameter in part.parameters[4:] if len(part.parameters) > 4 else part.parameters:
                self._collect(parameter, bases, marks, depth)
        return " ".join(["-".join(bases) or "?", *dict.fromkeys(marks)])

    def _collect(self, parameter: object, bases: list[str], marks: list[str], depth: int) -> None:
        """Datums and modifiers in the parameters of a compartment."""
        if isinstance(parameter, Ref):
            types = self.text.type_of(parameter.number)
            if "MODIFIER" in types and "DATUM" in types:
                marks.append(self._valued_modifier(parameter.number))
            elif "DATUM" in types:
                bases.append(self._name(parameter.number, depth + 1))
        elif isinstance(parameter, Enumeration):
            if parameter.name not in ("T", "F", "U", "TRUE", "FALSE"):
                marks.append(modifier_mark(parameter.name))
        elif isinstance(parameter, Record):
            self._collect(parameter.parameters, bases, marks, depth)
        elif isinstance(parameter, tuple):
            for member in parameter:
                self._collect(member, bases, marks, depth)

    def _valued_modifier(self, number: int) -> str:
        """A modifier with a length, such as "(distance 12)"."""
        words, units = [], Units(self.text)
        for part in self.text.records(number):
            words += [modifier_words(p.name) for p in part.parameters if isinstance(p, Enumeration)]
            values = [units.value(length) for length in numbers_in(part.parameters)]
            words += [amount(value) for value in values if value is not None]
        return f"({' '.join(words)})"
