"""The section ``candidates``: where the camera may stand, and how candidate viewpoints are sampled there."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from ...exceptions import InputError
from ...planning.candidates.candidate_options import CandidateOptions
from ...planning.region.allowed_region import Hemisphere
from ..files.problems import Problems
from .validation import build, validate
from .values import (
    Angle,
    Apart,
    Count,
    CountOrZero,
    Direction,
    DistanceRange,
    Length,
    LengthOrZero,
    Name,
    Point,
    Section,
)

__all__ = ["CandidatesSection", "read_options"]


class ConeSection(Section):
    """The cone of directions, from the part to the camera."""

    axis: Direction = Field(
        default=(0.0, 0.0, 1.0), description="the cone's axis, part frame: three numbers, by default [0, 0, 1]"
    )
    half_angle: Angle = Field(description="between axis and side of the cone: an angle, such as 60 deg")

    @model_validator(mode="after")
    def _in_range(self) -> ConeSection:
        if self.half_angle > np.pi:
            raise InputError(
                "the cone's half angle is too large",
                key="half_angle",
                got=f"{np.rad2deg(self.half_angle):.6g} deg",
                expected="at most 180 deg",
            )
        if not 0 < np.linalg.norm(self.axis) < np.inf:
            raise InputError("the cone's axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        return self


class BoxSection(Section):
    """A box of camera positions, part frame."""

    lowest: Point = Field(description='a corner, such as "[-300, -300, 100] mm"')
    highest: Point = Field(description='the opposite corner, such as "[300, 300, 700] mm"')

    @model_validator(mode="after")
    def _in_order(self) -> BoxSection:
        if not all(a < b for a, b in zip(self.lowest, self.highest, strict=True)):
            raise InputError(
                "the box is empty",
                key="highest",
                got=f"{list(self.lowest)} to {list(self.highest)} mm",
                expected="every coordinate of highest above that of lowest",
            )
        return self

    def build(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest corner, mm."""
        return self.lowest, self.highest


class HemisphereSection(Section):
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

    @model_validator(mode="after")
    def _is_direction(self) -> HemisphereSection:
        if not any(self.axis):
            raise InputError("the axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        return self

    def build(self) -> Hemisphere:
        """The hemisphere."""
        return Hemisphere(self.centre, self.axis, float("inf") if self.radius is None else self.radius)


class CandidatesSection(Section):
    """Where the camera may stand; cone, box, hemisphere and forbidden boxes are read apart."""

    distance: DistanceRange | None = Field(
        default=None,
        description='from the camera to the point it is aimed at: one length, or a range such as "[300, 600] mm"',
    )
    distances: Count | None = Field(
        default=None, description="how many distances are sampled in that range: a whole number, by default 3"
    )
    directions: Count | None = Field(
        default=None, description="how many viewing directions are sampled: a whole number, by default 200"
    )
    rolls: Count | None = Field(
        default=None, description="how many turns about the optical axis are sampled: a whole number, by default 2"
    )
    targets: CountOrZero | None = Field(
        default=None, description="how many points are aimed at beside the middle: a whole number, by default 4"
    )
    cone: Annotated[Any, Apart(ConeSection)] = Field(
        default=None, description="a cone of directions from the part to the camera; by default all directions"
    )
    box: Annotated[Any, Apart(BoxSection)] = Field(default=None, description="a box in which the camera must stand")
    hemisphere: Annotated[Any, Apart(HemisphereSection)] = Field(
        default=None, description="the side of a plane on which the camera must stand"
    )
    forbidden: Annotated[list[Any] | None, Apart(BoxSection, listed=True)] = Field(
        default=None, description="a list of boxes in which the camera must not stand"
    )
    standoff: LengthOrZero | None = Field(
        default=None,
        description="the camera's least distance from the part's surface, such as 20 mm; by default it stays out of "
        "the part's bounding box",
    )
    viewpoints: Name | None = Field(
        default=None, description="a CSV file of explicit viewpoints, in place of sampled ones"
    )

    def build(self, cone: ConeSection | None, **places: Any) -> CandidateOptions:
        """The options, with the defaults for what is not given; raises InputError.

        Parameters
        ----------
        places
            ``box``, ``hemisphere`` and ``forbidden`` of the options.
        """
        given: dict[str, Any] = {
            "distance_mm": self.distance,
            "distances": self.distances,
            "directions": self.directions,
            "rolls": self.rolls,
            "targets": self.targets,
            "standoff_mm": self.standoff,
            **places,
        }
        if self.distance is not None and self.distance[0] == self.distance[1]:
            given["distances"] = 1
        if cone is not None:
            given |= {"cone_axis": cone.axis, "cone_half_angle_rad": cone.half_angle}
        return CandidateOptions(**{name: value for name, value in given.items() if value is not None})


def read_options(value: object, problems: Problems) -> tuple[CandidatesSection, CandidateOptions] | None:
    """The section ``candidates`` and the options that it states; None, and the reasons in ``problems``."""
    where = ("candidates",)
    section = validate(CandidatesSection, value, where, problems)
    below = value if isinstance(value, dict) else {}
    cone = None
    if below.get("cone") is not None:
        cone = validate(ConeSection, below["cone"], (*where, "cone"), problems)
    places = {name: _place(model, below.get(name), problems, name) for name, model in _PLACES.items()}
    listed = below.get("forbidden")
    boxes = [
        _place(BoxSection, box, problems, "forbidden", k)
        for k, box in enumerate(listed if isinstance(listed, list) else ())
    ]
    places["forbidden"] = tuple(box for box in boxes if box is not None)
    if section is None:
        return None
    options = build(partial(section.build, **places), where, problems, cone)
    return None if options is None else (section, options)


_PLACES: dict[str, type[BoxSection] | type[HemisphereSection]] = {"box": BoxSection, "hemisphere": HemisphereSection}


def _place(
    section: type[BoxSection] | type[HemisphereSection], value: object, problems: Problems, *where: str | int
) -> Any:
    """The place that a section describes; None where there is none, or a problem was noted."""
    if value is None and len(where) == 1:
        return None
    found = validate(section, value, ("candidates", *where), problems)
    return None if found is None else found.build()
