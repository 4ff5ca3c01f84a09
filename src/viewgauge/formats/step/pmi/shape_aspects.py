"""From the shape aspects that PMI refers to, to the records of faces and edges."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from functools import cached_property

from ..step_text import Record, Ref, StepText

__all__ = ["LOCATIONS", "SIZES", "ShapeAspects", "numbers_in"]

LOCATIONS = (
    "DIMENSIONAL_LOCATION",
    "DIRECTED_DIMENSIONAL_LOCATION",
    "DIMENSIONAL_LOCATION_WITH_PATH",
    "ANGULAR_LOCATION",
)
SIZES = (
    "DIMENSIONAL_SIZE",
    "ANGULAR_SIZE",
    "DIMENSIONAL_SIZE_WITH_PATH",
    "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE",
)
_FACES = ("ADVANCED_FACE", "FACE_SURFACE", "FACE")
_SHELLS = ("CLOSED_SHELL", "OPEN_SHELL", "CONNECTED_FACE_SET", "CONNECTED_FACE_SUB_SET")
_DERIVED = ("CENTRE_OF_SYMMETRY", "DERIVED_SHAPE_ASPECT", "GEOMETRIC_ALIGNMENT", "EXTENSION", "TANGENT", "APEX")


@dataclass(frozen=True)
class ShapeAspects:
    """The shape aspects of a file, what they consist of, and the names of the annotations that show PMI.

    Parameters
    ----------
    text
        The file's records.
    """

    text: StepText

    @cached_property
    def _items(self) -> dict[int, list[int]]:
        """Geometry of each shape aspect."""
        items: dict[int, list[int]] = defaultdict(list)
        for _, usage in self.text.parts("GEOMETRIC_ITEM_SPECIFIC_USAGE", "ITEM_IDENTIFIED_REPRESENTATION_USAGE"):
            if len(usage.parameters) == 5 and isinstance(usage.parameters[2], Ref):
                items[usage.parameters[2].number] += numbers_in(usage.parameters[4])
        return items

    @cached_property
    def _members(self) -> dict[int, list[int]]:
        """Shape aspects that each composite or derived shape aspect is made of."""
        members: dict[int, list[int]] = defaultdict(list)
        locations = set(self.text.numbers(*LOCATIONS))  # these relate two aspects, of which neither is a member
        for number, relation in self.text.parts(
            "SHAPE_ASPECT_RELATIONSHIP", "SHAPE_ASPECT_DERIVING_RELATIONSHIP", "SHAPE_ASPECT_ASSOCIATIVITY"
        ):
            if len(relation.parameters) == 4 and number not in locations:
                whole, part = numbers_in(relation.parameters[2:3]), numbers_in(relation.parameters[3:4])
                for aspect in whole:
                    members[aspect] += part
        return members

    @cached_property
    def captions(self) -> dict[int, str]:
        """Name of the annotation that shows each dimension or tolerance, such as "Linear Size.3"."""
        captions: dict[int, str] = {}
        for _, link in self.text.parts(
            "DRAUGHTING_MODEL_ITEM_ASSOCIATION", "DRAUGHTING_MODEL_ITEM_ASSOCIATION_WITH_PLACEHOLDER"
        ):
            numbers = numbers_in(link.parameters)
            if len(numbers) < 3:
                continue
            for part in self.text.records(numbers[2]):
                name = part.parameters[0] if part.parameters else None
                if isinstance(name, str) and name.strip():
                    captions.setdefault(numbers[0], " ".join(name.replace("/", "-").split()))
        return captions

    def geometry(self, aspect: int) -> tuple[tuple[int, ...], str]:
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


def numbers_in(parameters: object) -> list[int]:
    """Numbers of all references in (nested) parameters."""
    if isinstance(parameters, Ref):
        return [parameters.number]
    if isinstance(parameters, Record):
        return numbers_in(parameters.parameters)
    if isinstance(parameters, tuple):
        return [number for parameter in parameters for number in numbers_in(parameter)]
    return []
