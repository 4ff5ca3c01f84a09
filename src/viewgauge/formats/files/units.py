"""Quantities with their units, read into mm, rad, px or a plain ratio.

The arithmetic is decimal, so that ``3.45 um`` is exactly the double nearest to 0.00345 mm. Only the units below
are known: pint's full registry has traps (its ``px`` is a length, its ``min`` could be a milli-inch).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Literal

from ...exceptions import InputError

if TYPE_CHECKING:
    from pint import UnitRegistry

__all__ = [
    "ANGLE",
    "LENGTH",
    "PIXELS",
    "RATIO",
    "Kind",
    "Sign",
    "parse_quantities",
    "parse_quantity",
    "unit_names",
]

Sign = Literal["any", "not negative", "positive"]


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its name, the unit it is converted to, examples for messages, and which values it can have.

    Where a value is not 0, its magnitude lies between ``least`` and ``most`` in the unit: beyond them nothing physical
    is meant, and squares and products would overflow or vanish.
    """

    name: str
    unit: str
    example: str
    vector_example: str
    least: float
    most: float


LENGTH = Kind("length", "mm", "16 mm", "[0, 0, 40] mm", 1e-12, 1e9)
ANGLE = Kind("angle", "rad", "0.02 deg", "[0.02, 0.02, 0.05] deg", 1e-15, 100)
PIXELS = Kind("number of pixels", "px", "1 px", "[1224, 1024] px", 1e-12, 1e9)
RATIO = Kind("ratio", "", "10 % or 0.1", "[10, 20] %", 1e-15, 1e9)

_DEFINITIONS = {
    LENGTH: (
        "millimeter = [length] = mm = millimetre",
        "nanometer = 1e-6 * millimeter = nm = nanometre",
        "micrometer = 0.001 * millimeter = um = µm = μm = micrometre = micron",
        "centimeter = 10 * millimeter = cm = centimetre",
        "meter = 1000 * millimeter = m = metre",
        "inch = 25.4 * millimeter = in = inches",
        "thou = 0.0254 * millimeter",
        "foot = 304.8 * millimeter = ft = feet",
    ),
    ANGLE: (
        "radian = [angle] = rad",
        "milliradian = 0.001 * radian = mrad",
        "microradian = 1e-6 * radian = urad = µrad = μrad",
        "degree = 0.01745329251994329576923690768488612713 * radian = deg = °",
        "arcminute = degree / 60 = arcmin",
        "arcsecond = degree / 3600 = arcsec",
    ),
    PIXELS: ("pixel = [pixel] = px",),
    RATIO: ("percent = 0.01 = %", "permille = 0.001 = ‰", "ppm = 1e-6"),
}
_SYMBOLS = ("mm", "cm", "m", "um", "µm", "nm", "in", "inch", "ft", "thou", "rad", "mrad", "deg", "arcmin", "px", "ppm")

_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?![\d.])|([+-]?\.?(?:nan|inf(?:inity)?))\b", re.I)
_LIST = re.compile(r"\[(.*)\](.*)", re.S)


def parse_quantity(value: object, kind: Kind, sign: Sign = "any") -> float:
    """Convert a quantity such as ``"16 mm"`` to the unit of its kind (mm, rad, px; a ratio to a plain number).

    Raises
    ------
    InputError
        If the number or the unit is missing or wrong, or the value is not finite or has the wrong sign.
    """
    number, unit = _split(value, kind)
    if not math.isfinite(float(number)):
        written_out = number[-1:].isdigit()
        raise _error(f"the number is {'too large' if written_out else 'not finite'}", _short(value), kind)
    result = _convert(number, unit, value, kind)
    if not abs(result) <= kind.most:
        raise _error("the number is too large", _short(value), kind)
    if 0 < abs(result) < kind.least:
        raise _error("the number is too small", _short(value), kind)
    if sign == "positive" and not result > 0:
        raise _error("the value must be positive", value, kind)
    if sign == "not negative" and result < 0:
        raise _error("the value must not be negative", value, kind)
    return result


def parse_quantities(value: object, kind: Kind, counts: tuple[int, ...], sign: Sign = "any") -> tuple[float, ...]:
    """Convert one or several quantities: ``"1 mm"``, ``"[0, 0, 40] mm"``, ``["0 mm", ...]`` or ``"[0 mm, ...]"``.

    Parameters
    ----------
    counts
        The numbers of values allowed; where 1 is among them a quantity need not be a list.

    Raises
    ------
    InputError
        For the reasons of :func:`parse_quantity`, and if the number of values is none of ``counts``.
    """
    items = _items(value)
    if items is None:
        if 1 not in counts and value is not None:
            raise _error(f"{_count_words(counts)} are expected here", value, kind, vector=True)
        return (parse_quantity(value, kind, sign),)
    if len(items) not in counts:
        raise _error(f"{_count_words(counts)} are expected here, not {len(items)}", _shown(value), kind, vector=True)
    try:
        return tuple(parse_quantity(item, kind, sign) for item in items)
    except InputError as error:
        raise _error(error.problem, _shown(value), kind, vector=True) from error


def unit_names(kind: Kind) -> tuple[str, ...]:
    """Every name of every unit of a kind, symbols and long names, the plural of long names too."""
    names: list[str] = []
    for definition in _DEFINITIONS[kind]:
        name, _, *others = definition.split(" = ")
        names += [name, f"{name}s", *others] if len(name) > 4 else [name, *others]
    return tuple(names)


def _items(value: object) -> list[object] | None:
    """The single values of a list, each with its unit; None if the value is no list."""
    if isinstance(value, list | tuple):
        return list(value)
    match = _LIST.fullmatch(value.strip()) if isinstance(value, str) else None
    if match is None:
        return None
    inside, unit = match[1].strip(), match[2].strip()
    return [f"{item.strip()} {unit}".strip() for item in inside.split(",")] if inside else []


def _split(value: object, kind: Kind) -> tuple[str, str]:
    """Number and unit of a quantity, as text."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        value = str(value)
    if not isinstance(value, str):
        problem = "the key has no value" if value is None else "not a quantity"
        raise _error(problem, None if value is None else _shown(value), kind)
    text = value.strip()
    match = _NUMBER.match(text)
    if match is None:
        raise _error("the value does not begin with a number", value, kind)
    return (match[1] or match[2].replace(".", "")), text[match.end() :].strip()


def _convert(number: str, unit: str, value: object, kind: Kind) -> float:
    if not unit:
        if kind is not RATIO:
            raise _error("the unit is missing", value, kind)
        return float(number)
    if float(number) == 0:  # also a number too small for a double, whose exponent Decimal might not take
        number = "0"
    factor = _factor(unit, kind)
    if factor is None:
        raise _error(f"'{unit}' is not a unit of {kind.name}" if kind.unit else f"'{unit}' makes no ratio", value, kind)
    return float(Decimal(number) * factor)


@cache
def _factor(unit: str, kind: Kind) -> Decimal | None:
    """The factor from this unit to the unit of its kind; None if the unit is unknown or of another kind."""
    import pint

    if not (unit in "%‰°" or unit.isalpha()):  # one bare unit, never an expression for pint to work out
        return None
    try:
        return Decimal(_registry().Quantity(Decimal(1), unit).to(kind.unit).magnitude)
    except pint.PintError:
        return None


@cache
def _registry() -> UnitRegistry[Decimal]:
    import pint  # late: it would slow down every start of the command line

    return pint.UnitRegistry([line for lines in _DEFINITIONS.values() for line in lines], non_int_type=Decimal)


def _short(value: object) -> str:
    """A value as a message shows it: of hundreds of digits only the first."""
    text = _shown(value)
    return text if len(text) <= 60 else f"{text[:40]}... ({len(text)} characters)"


def _error(problem: str, value: object, kind: Kind, *, vector: bool = False) -> InputError:
    expected = f"{_article(kind.name)}, such as {kind.example}"
    if kind.unit:
        expected = f"{_article(kind.name)} with its unit, such as {kind.vector_example if vector else kind.example}"
    return InputError(problem, got=value, expected=expected, hint=_hint(value, problem))


def _hint(value: object, problem: str) -> str | None:
    """Help with the commonest slips: a unit in capitals, a decimal comma."""
    text = str(value)
    if re.search(r"\d,\d", text) and not text.startswith("["):
        return "write the decimal point as a point"
    match = re.match(r"'(.+)' is not a unit", problem)
    if match and match[1] not in _SYMBOLS and match[1].lower() in _SYMBOLS:
        return f"did you mean '{match[1].lower()}'?"
    return None


def _article(noun: str) -> str:
    return f"an {noun}" if noun[0] in "aeiou" else f"a {noun}"


def _count_words(counts: tuple[int, ...]) -> str:
    return " or ".join(str(count) for count in counts) + " values"


def _shown(value: object) -> str:
    return f"[{', '.join(str(item) for item in value)}]" if isinstance(value, list | tuple) else str(value)
