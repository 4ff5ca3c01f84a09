"""The section ``camera.usable_region``: where in the image the camera is used."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, TypeAdapter, WithJsonSchema, model_validator

from ....exceptions import InputError
from ....sensors import Camera, ImageCircle, ImagePolygon, UsableRegion
from ...files.units import LENGTH, PIXELS, parse_quantity
from ..inspection_text import InspectionText
from ..validation import build, validate
from ..values import Apart, Length, PixelPair, Pixels, Section

__all__ = ["UsableRegionSection", "read_usable_region"]

_SQUARE = 0.01  # by how much the sides of a pixel may differ


def _read_size(value: object) -> tuple[str, float]:
    """A number of pixels, or a length on the sensor."""
    try:
        return "px", parse_quantity(value, PIXELS, "positive")
    except InputError:
        try:
            return "mm", parse_quantity(value, LENGTH, "positive")
        except InputError as error:
            raise InputError(
                error.problem, got=error.got, expected="a size in the image, such as 2000 px, or on the sensor: 11 mm"
            ) from None


_Size = Annotated[
    tuple[str, float],
    BeforeValidator(_read_size),
    WithJsonSchema({"anyOf": [TypeAdapter(Pixels).json_schema(), TypeAdapter(Length).json_schema()]}),
]


class CircleSection(Section):
    """An image circle: by its diameter or its radius."""

    diameter: _Size | None = Field(
        default=None, description="its diameter, in the image or on the sensor, such as 2000 px or 11 mm"
    )
    radius: _Size | None = Field(default=None, description="or its radius")
    centre: PixelPair | None = Field(
        default=None, description='its centre, such as "[1224, 1024] px"; by default the principal point'
    )

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        if (self.diameter is None) == (self.radius is None):
            raise InputError("not a circle", key="diameter", expected="either diameter or radius")
        return self

    def build(self, camera: Camera) -> ImageCircle:
        """The circle in the image of a camera; raises InputError."""
        size = self.diameter or self.radius
        assert size is not None  # one of the two is given
        unit, radius = size
        if self.diameter:
            radius /= 2
        if unit == "mm":
            width, height = camera.pixel_pitch_mm
            if abs(width / height - 1) > _SQUARE:
                raise InputError(
                    "a circle on the sensor is none in pixels that are not square",
                    got=f"pixels of {width:g} x {height:g} mm",
                    expected="a size in px, or a polygon",
                )
            radius /= width
        return ImageCircle(self.centre or camera.principal_point, radius)


class UsableRegionSection(Section):
    """The part of the image in which ends of measurands may lie."""

    circle: Annotated[Any, Apart(CircleSection)] = Field(default=None, description="the inside of a circle")
    polygon: Annotated[list[PixelPair], Field(min_length=3)] | None = Field(
        default=None, description='the inside of a polygon, by its corners: ["[100, 0] px", ...]'
    )

    @model_validator(mode="after")
    def _one_shape(self) -> Self:
        if (self.circle is None) == (self.polygon is None):
            raise InputError("not one shape", key="circle", expected="either circle or polygon")
        return self


def read_usable_region(text: InspectionText, camera: Camera) -> UsableRegion | None:
    """The region that the file states for a camera; None where it states none, or none that can be."""
    value, where, problems = text.below("camera", "usable_region"), ("camera", "usable_region"), text.problems
    section = None if value is None else validate(UsableRegionSection, value, where, problems)
    if section is None:
        return None
    if section.polygon is not None:
        return build(lambda: ImagePolygon(tuple(section.polygon or ())), where, problems)
    circle = validate(CircleSection, section.circle, (*where, "circle"), problems)
    return None if circle is None else build(lambda: circle.build(camera), (*where, "circle"), problems)
