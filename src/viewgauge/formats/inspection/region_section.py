"""The keys of the inspection file that state the allowed region: one registered section for each kind of member.

To add a kind, write its member (:mod:`viewgauge.planning.region`) and a :class:`RegionSection` here, and register it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import Field, create_model, model_validator

from ...exceptions import InputError
from ...planning.candidates.candidate_options import CandidateOptions
from ...planning.region import Box, ForbiddenBox, Hemisphere, RegionMember, Standoff
from ..files.problems import KeyPath, Problems
from .candidates_section import CandidatesSection, ConeSection
from .validation import build, validate
from .values import Apart, Direction, Length, LengthOrZero, Point, Section

__all__ = ["RegionSection", "candidates_section", "read_options", "register_quantity", "register_region"]

_WHERE: KeyPath = ("candidates",)


class RegionSection(Section):
    """What the value of a key of the allowed region holds."""

    def build(self) -> RegionMember:
        """The member of the allowed region; raises InputError."""
        raise NotImplementedError


@dataclass(frozen=True)
class _RegionKey:
    """How the value of a key is read.

    Parameters
    ----------
    field
        Type of the key in the section ``candidates``.
    description
        What the key states, for messages and editors.
    section
        What the value, or each entry of a list, is read as; None where the value is one quantity.
    listed
        Each entry of a list is a section.
    make
        What makes a member of the quantity; None where the section does.
    """

    field: Any
    description: str
    section: type[RegionSection] | None = None
    listed: bool = False
    make: Callable[[Any], RegionMember] | None = None


_KEYS: dict[str, _RegionKey] = {}


def register_region(key: str, section: type[RegionSection], description: str, *, listed: bool = False) -> None:
    """Let the section ``candidates`` of an inspection file state a kind of member of the allowed region.

    Parameters
    ----------
    key
        The member's own key, such as ``Box.key``. A key that is registered again is replaced.
    section
        What the value is read as. Its ``build`` makes the member.
    description
        What the key states, such as "a box in which the camera must be".
    listed
        The value is a list, each entry of which is read as a section and makes a member.
    """
    _register(key, _RegionKey(_apart(section, listed), description, section, listed))


def _apart(section: type[RegionSection], listed: bool) -> Any:
    return Annotated[list[Any] | None if listed else Any, Apart(section, listed=listed)]


def register_quantity(key: str, quantity: Any, description: str, make: Callable[[Any], RegionMember]) -> None:
    """The same for a member that is made of one quantity, such as ``standoff: 80 mm``.

    Parameters
    ----------
    quantity
        Type of the value, such as ``Length`` of :mod:`~viewgauge.formats.inspection.sections`.
    """
    _register(key, _RegionKey(quantity, description, make=make))


def _register(key: str, read: _RegionKey) -> None:
    if key in CandidatesSection.model_fields:
        raise InputError("the key states how candidates are sampled", key=key, expected="another key")
    _KEYS[key] = read


def candidates_section() -> type[CandidatesSection]:
    """The section ``candidates`` with the keys of all registered members."""
    fields: dict[str, Any] = {
        name: (
            key.field if key.section is not None else key.field | None,
            Field(default=None, description=key.description),
        )
        for name, key in _KEYS.items()
    }
    made: type[CandidatesSection] = create_model("CandidatesSection", __base__=CandidatesSection, **fields)
    return made


def read_options(value: object, problems: Problems) -> tuple[CandidatesSection, CandidateOptions] | None:
    """The section ``candidates`` and the options that it states; None, and the reasons in ``problems``, if it cannot be
    read.
    """
    section = validate(candidates_section(), value, _WHERE, problems)
    stated = value if isinstance(value, dict) else {}
    cone = None
    if stated.get("cone") is not None:
        cone = validate(ConeSection, stated["cone"], (*_WHERE, "cone"), problems)
    members: list[RegionMember | None] = []
    for name, key in _KEYS.items():
        given, where = stated.get(name), (*_WHERE, name)
        if given is None:
            continue
        if key.make is not None:
            members.append(build(key.make, where, problems, getattr(section, name)) if section else None)
        elif key.section is not None and not key.listed:
            members.append(_member(key.section, given, where, problems))
        elif key.section is not None and isinstance(given, list):
            members += [_member(key.section, entry, (*where, k), problems) for k, entry in enumerate(given)]
    if section is None:
        return None
    regions = tuple(member for member in members if member is not None)
    options = build(section.build, _WHERE, problems, cone, regions)
    return None if options is None else (section, options)


def _member(section: type[RegionSection], value: object, where: KeyPath, problems: Problems) -> RegionMember | None:
    """What one section states; read apart, so that its problems are reported even where others have some."""
    read = validate(section, value, where, problems)
    return None if read is None else build(read.build, where, problems)


class _CornersSection(RegionSection):
    """Two corners of a box of camera positions, part frame."""

    lowest: Point = Field(description="a corner, such as [-300, -300, 100] mm")
    highest: Point = Field(description="the opposite corner, such as [300, 300, 700] mm")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not all(a < b for a, b in zip(self.lowest, self.highest, strict=True)):
            raise InputError(
                "the box is empty",
                key="highest",
                got=f"{list(self.lowest)} to {list(self.highest)} mm",
                expected="every coordinate of highest above that of lowest",
            )
        return self


class BoxSection(_CornersSection):
    """The box in which the camera has to be."""

    def build(self) -> Box:
        """The box."""
        return Box(self.lowest, self.highest)


class ForbiddenBoxSection(_CornersSection):
    """A box in which the camera must not be."""

    def build(self) -> ForbiddenBox:
        """The box."""
        return ForbiddenBox(self.lowest, self.highest)


class HemisphereSection(RegionSection):
    """The side of a plane on which the camera stays, such as above the table."""

    centre: Point | None = Field(
        default=None,
        description='a point of the plane, such as "[0, 0, 10] mm"; by default the middle of the measurands',
    )
    axis: Direction = Field(
        default=(0.0, 0.0, 1.0),
        description="the direction towards the camera's side, part frame: three numbers, by default [0, 0, 1]",
    )
    radius: Length | None = Field(
        default=None, description="how far from the centre the camera may be, such as 600 mm; by default any distance"
    )

    def build(self) -> Hemisphere:
        """The hemisphere; raises InputError."""
        return Hemisphere(self.centre, self.axis, float("inf") if self.radius is None else self.radius)


register_region(Box.key, BoxSection, "a box in which the camera must be")
register_region(Hemisphere.key, HemisphereSection, "the side of a plane on which the camera must be")
register_region(ForbiddenBox.key, ForbiddenBoxSection, "a list of boxes in which the camera must not be", listed=True)
register_quantity(
    Standoff.key,
    LengthOrZero,
    "the camera's least distance from the part's surface, such as 20 mm; by default it stays out of the part's "
    "bounding box",
    Standoff,
)
