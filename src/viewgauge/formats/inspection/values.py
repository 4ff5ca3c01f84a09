"""The kinds of value that keys of the inspection file have: how each is read, and what JSON Schema says of it.

Values arrive as plain YAML values and leave in mm, rad and px. Every quantity carries its unit in the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, StrictInt, StrictStr, WithJsonSchema

from ...exceptions import InputError
from ..files.units import ANGLE, LENGTH, PIXELS, RATIO, Kind, Sign, parse_quantities, parse_quantity, unit_names

__all__ = [
    "QUANTITIES",
    "Angle",
    "AngleDeviations",
    "AngleOrZero",
    "AnyLength",
    "Apart",
    "Coefficients",
    "Count",
    "CountOrZero",
    "Direction",
    "DistanceRange",
    "Elsewhere",
    "Length",
    "LengthDeviations",
    "LengthOrZero",
    "LengthUnit",
    "Name",
    "Pitch",
    "PixelPair",
    "Pixels",
    "PixelsOrZero",
    "PixelsOrZeros",
    "Point",
    "PositiveNumber",
    "Quaternion",
    "Ratio",
    "Resolution",
    "Schema",
    "Section",
    "Tolerance",
    "is_number",
    "quantities_schema",
]

Schema = dict[str, Any]
"""A JSON Schema."""


class Section(BaseModel):
    """A section of the file: no unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, protected_namespaces=())


@dataclass(frozen=True)
class Apart:
    """Says of a key that its section is read apart, so that all problems are reported; and which section it is.

    Parameters
    ----------
    section
        The model of the section, or of each of a list of sections.
    listed
        The key holds a list of such sections.
    optional
        The key may be written with nothing below it.
    """

    section: type[BaseModel]
    listed: bool = False
    optional: bool = False


@dataclass(frozen=True)
class Elsewhere:
    """Says of a key that it is known here only to say in a message where it belongs."""


def is_number(value: object) -> bool:
    """Whether a YAML value is a number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


# --- JSON Schema of quantities --------------------------------------------------------------------------------------

_UNSIGNED = r"(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"

QUANTITIES: dict[str, Schema] = {}
"""The schema of each kind of quantity, by a name: where one stands, the whole schema refers to it by that name."""


def _number(sign: Sign) -> str:
    before = {"any": "[+-]?", "not negative": r"\+?", "positive": r"\+?(?=[\d.]*[1-9])"}
    return before[sign] + _UNSIGNED


def _units(kind: Kind) -> str:
    names = "|".join(re.escape(name) for name in unit_names(kind))
    return f"({names})" if kind.unit else f"({names})?"


def _text_schema(pattern: str, expected: str) -> Schema:
    """A text of a pattern; editors that know ``patternErrorMessage`` say what is expected instead of showing it."""
    return {"type": "string", "pattern": pattern, "patternErrorMessage": f"expected: {expected}"}


def _quantity_schema(kind: Kind, sign: Sign) -> Schema:
    expected = f"a {kind.name}{' with its unit' if kind.unit else ''}, such as {kind.example}"
    schema = _text_schema(rf"^\s*{_number(sign)}\s*{_units(kind)}\s*$", expected)
    if not kind.unit:
        bounds: dict[Sign, Schema] = {"any": {}, "positive": {"exclusiveMinimum": 0}, "not negative": {"minimum": 0}}
        schema = {"anyOf": [{"type": "number", **bounds[sign]}, schema]}
    return QUANTITIES.setdefault(_quantity_name(kind, (1,), sign), schema)


def quantities_schema(kind: Kind, counts: tuple[int, ...], sign: Sign) -> Schema:
    """JSON Schema of what :func:`~viewgauge.formats.files.units.parse_quantities` reads."""
    number, units, each = _number(sign), _units(kind), _quantity_schema(kind, sign)
    options: list[Schema] = [each] if 1 in counts else []
    for count in counts:
        one_unit = rf"\[\s*{number}\s*(,\s*{number}\s*){{{count - 1}}}\]\s*{units}"
        own_units = rf"\[\s*{number}\s*{units}\s*(,\s*{number}\s*{units}\s*){{{count - 1}}}\]"
        expected = f'{count} values with their unit, in quotes, such as "{kind.vector_example}"'
        options.append(_text_schema(rf"^\s*({one_unit}|{own_units})\s*$", expected))
        options.append({"type": "array", "items": each, "minItems": count, "maxItems": count})
    return QUANTITIES.setdefault(_quantity_name(kind, counts, sign), {"anyOf": options})


def _quantity_name(kind: Kind, counts: tuple[int, ...], sign: Sign) -> str:
    """Such as ``positive_length``, or ``3_lengths``."""
    words = [] if sign == "any" else sign.split()
    numbers = [] if counts == (1,) else [*"_or_".join(map(str, counts)).split("_")]
    noun = (
        kind.name if counts == (1,) else kind.name.replace("number", "numbers") if " " in kind.name else f"{kind.name}s"
    )
    return "_".join([*numbers, *words, *noun.split()])


# --- readers --------------------------------------------------------------------------------------------------------


def _one(kind: Kind, sign: Sign) -> BeforeValidator:
    def read(value: object) -> float:
        return parse_quantity(value, kind, sign)

    return BeforeValidator(read)


def _several(kind: Kind, counts: tuple[int, ...], sign: Sign) -> BeforeValidator:
    def read(value: object) -> tuple[float, ...]:
        return parse_quantities(value, kind, counts, sign)

    return BeforeValidator(read)


def _numbers(count: int) -> BeforeValidator:
    def read(value: object) -> tuple[float, ...]:
        expected = f"{count} plain numbers, such as {[0] * (count - 1) + [1]}"
        if not isinstance(value, list) or len(value) != count:
            raise InputError(f"not {count} numbers", got=value, expected=expected)
        if not all(is_number(item) for item in value):
            raise InputError("not plain numbers", got=value, expected=expected)
        return tuple(float(item) for item in value)

    return BeforeValidator(read)


def _read_tolerance(value: object) -> tuple[float, ...]:
    limits = parse_quantities(value, LENGTH, (1, 2))
    if len(limits) == 1:
        if limits[0] <= 0:
            raise InputError("the tolerance must be positive", got=value, expected="plus/minus, such as 0.1 mm")
        return (-limits[0], limits[0])
    if not limits[0] < limits[1]:
        raise InputError(
            "the lower deviation must be less than the upper", got=value, expected='such as "[-0.05, 0.1] mm"'
        )
    return limits


def _read_distance(value: object) -> tuple[float, ...]:
    limits = parse_quantities(value, LENGTH, (1, 2), "positive")
    if limits[0] > limits[-1]:
        raise InputError("the nearer distance comes first", got=value, expected='such as "[300, 600] mm"')
    return (limits[0], limits[-1])


def _read_name(value: object) -> object:
    if isinstance(value, str) and not value.strip():
        raise InputError("the text is empty")
    return value


def _read_unit(value: object) -> object:
    if isinstance(value, str):
        parse_quantity(f"1 {value}", LENGTH)
    return value


def _read_resolution(value: object) -> tuple[int, ...]:
    expected = "columns and rows as two positive whole numbers, such as [2448, 2048]"
    if isinstance(value, str):
        value = list(parse_quantities(value, PIXELS, (2,), "positive"))
    if not isinstance(value, list) or len(value) != 2 or any(isinstance(count, bool) for count in value):
        raise InputError("not two numbers", got=value, expected=expected)
    if not all(isinstance(count, int | float) and 1 <= count <= _MOST and count % 1 == 0 for count in value):
        raise InputError("not two positive whole numbers", got=value, expected=expected)
    return tuple(int(count) for count in value)


def _read_coefficients(value: object) -> tuple[float, ...]:
    expected = "plain numbers, such as [-0.1, 0.02, 0, 0, 0]"
    if not isinstance(value, list) or not all(is_number(item) for item in value):
        raise InputError("not a list of numbers", got=value, expected=expected)
    return tuple(float(item) for item in value)


def _read_positive(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 < value < float("inf"):
        raise InputError("not a positive number", got=value, expected="a plain number, such as 8")
    return float(value)


# --- types ----------------------------------------------------------------------------------------------------------

_MOST = 1_000_000
_NUMBERS: Schema = {"type": "array", "items": {"type": "number"}}
_PIXEL_COUNT: Schema = {"type": "integer", "minimum": 1, "maximum": _MOST}


def _as(schema: Schema) -> WithJsonSchema:
    return WithJsonSchema(schema)


Length = Annotated[float, _one(LENGTH, "positive"), _as(_quantity_schema(LENGTH, "positive"))]
AnyLength = Annotated[float, _one(LENGTH, "any"), _as(_quantity_schema(LENGTH, "any"))]
LengthOrZero = Annotated[float, _one(LENGTH, "not negative"), _as(_quantity_schema(LENGTH, "not negative"))]
Angle = Annotated[float, _one(ANGLE, "positive"), _as(_quantity_schema(ANGLE, "positive"))]
AngleOrZero = Annotated[float, _one(ANGLE, "not negative"), _as(_quantity_schema(ANGLE, "not negative"))]
Pixels = Annotated[float, _one(PIXELS, "positive"), _as(_quantity_schema(PIXELS, "positive"))]
PixelsOrZero = Annotated[float, _one(PIXELS, "not negative"), _as(_quantity_schema(PIXELS, "not negative"))]
Ratio = Annotated[float, _one(RATIO, "positive"), _as(_quantity_schema(RATIO, "positive"))]
Point = Annotated[
    tuple[float, float, float], _several(LENGTH, (3,), "any"), _as(quantities_schema(LENGTH, (3,), "any"))
]
PixelsOrZeros = Annotated[
    tuple[float, ...],
    _several(PIXELS, (1, 2), "not negative"),
    _as(quantities_schema(PIXELS, (1, 2), "not negative")),
]
PixelPair = Annotated[tuple[float, float], _several(PIXELS, (2,), "any"), _as(quantities_schema(PIXELS, (2,), "any"))]
Pitch = Annotated[
    tuple[float, ...], _several(LENGTH, (1, 2), "positive"), _as(quantities_schema(LENGTH, (1, 2), "positive"))
]
Deviations = tuple[float, ...]  # one or three
LengthDeviations = Annotated[
    Deviations, _several(LENGTH, (1, 3), "not negative"), _as(quantities_schema(LENGTH, (1, 3), "not negative"))
]
AngleDeviations = Annotated[
    Deviations, _several(ANGLE, (1, 3), "not negative"), _as(quantities_schema(ANGLE, (1, 3), "not negative"))
]
Tolerance = Annotated[
    tuple[float, float],
    BeforeValidator(_read_tolerance),
    _as({"anyOf": [_quantity_schema(LENGTH, "positive"), quantities_schema(LENGTH, (2,), "any")]}),
]
DistanceRange = Annotated[
    tuple[float, float], BeforeValidator(_read_distance), _as(quantities_schema(LENGTH, (1, 2), "positive"))
]
Resolution = Annotated[
    tuple[int, int],
    BeforeValidator(_read_resolution),
    _as(
        {
            "anyOf": [
                {"type": "array", "items": _PIXEL_COUNT, "minItems": 2, "maxItems": 2},
                quantities_schema(PIXELS, (2,), "positive"),
            ]
        }
    ),
]
PositiveNumber = Annotated[float, BeforeValidator(_read_positive), _as({"type": "number", "exclusiveMinimum": 0})]
Coefficients = Annotated[tuple[float, ...], BeforeValidator(_read_coefficients), _as(_NUMBERS)]
Direction = Annotated[tuple[float, float, float], _numbers(3), _as({**_NUMBERS, "minItems": 3, "maxItems": 3})]
Quaternion = Annotated[tuple[float, float, float, float], _numbers(4), _as({**_NUMBERS, "minItems": 4, "maxItems": 4})]
LengthUnit = Annotated[
    StrictStr, BeforeValidator(_read_unit), _as({"type": "string", "enum": list(unit_names(LENGTH))})
]
Name = Annotated[StrictStr, BeforeValidator(_read_name), _as({"type": "string", "pattern": r"\S"})]
Count = Annotated[StrictInt, Field(ge=1, le=_MOST)]
CountOrZero = Annotated[StrictInt, Field(ge=0)]
