"""The keys of the inspection file that say where the camera may stand."""

from __future__ import annotations

from pydantic import Field, model_validator

from ...exceptions import InputError
from ...planning.region.allowed_region import Hemisphere
from .sections import Direction, Length, Point, Section

__all__ = ["BoxSection", "HemisphereSection"]


class BoxSection(Section):
    """A box of camera positions, part frame."""

    lowest: Point = Field(description="a corner, such as [-300, -300, 100] mm")
    highest: Point = Field(description="the opposite corner, such as [300, 300, 700] mm")

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

    centre: Point | None = None
    axis: Direction = (0.0, 0.0, 1.0)
    radius: Length | None = None

    @model_validator(mode="after")
    def _is_direction(self) -> HemisphereSection:
        if not any(self.axis):
            raise InputError("the axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        return self

    def build(self) -> Hemisphere:
        """The hemisphere."""
        return Hemisphere(self.centre, self.axis, float("inf") if self.radius is None else self.radius)
