"""Counts the toleranced records in the raw text of a STEP file, by other code than the reader's.

What the reader finds is compared with this; so nothing here uses the reader's records.
"""

from __future__ import annotations

import re
from collections import Counter

__all__ = ["count_toleranced"]

_RECORD = re.compile(r"#(\d+)\s*=\s*((?:'[^']*'|[^';])*);")
_COMMENT = re.compile(r"('[^']*')|/\*.*?\*/", re.S)
_STRING = re.compile(r"'[^']*'")
_REFERENCE = re.compile(r"#(\d+)")
_KINDS = [
    "straightness",
    "flatness",
    "roundness",
    "cylindricity",
    "line_profile",
    "surface_profile",
    "angularity",
    "parallelism",
    "perpendicularity",
    "position",
    "coaxiality",
    "concentricity",
    "symmetry",
    "circular_runout",
    "total_runout",
]
_GEOMETRIC = re.compile(rf"\b({'|'.join(_KINDS)})_tolerance\s*\(", re.I)
_UNKNOWN = re.compile(r"\b(?:MODIFIED_|UNEQUALLY_DISPOSED_)?GEOMETRIC_TOLERANCE(?:_WITH_[A-Z_]+)?\s*\(", re.I)
_DIMENSION = re.compile(
    r"\b(?:(?:DIRECTED_)?DIMENSIONAL_(?:LOCATION|SIZE)[A-Z_]*|ANGULAR_(?:LOCATION|SIZE))\s*\(", re.I
)
_LIMIT = re.compile(r"REPRESENTATION_ITEM\s*\(\s*'\s*(?:upper|lower) limit\s*'", re.I)
_QUALIFIED = re.compile(r"QUALIFIED_REPRESENTATION_ITEM\s*\(\s*\(([^()]*)\)", re.I)
_MOST_OR_LEAST = re.compile(r"TYPE_QUALIFIER\s*\(\s*'\s*(?:maximum|minimum)\s*'", re.I)


def count_toleranced(text: str) -> dict[str, int]:
    """How many records of each kind have a tolerance: geometric tolerances, and dimensions with deviations or limits.

    Parameters
    ----------
    text
        The file's text.
    """
    text = _COMMENT.sub(lambda found: found[1] or " ", text)
    bodies = {int(found[1]): found[2] for found in _RECORD.finditer(text)}
    counts: Counter[str] = Counter()
    dimensions: dict[int, str] = {}
    with_value: set[int] = set()
    representations: list[tuple[int, int]] = []
    for number, body in bodies.items():
        plain = _STRING.sub("''", body)
        geometric = _GEOMETRIC.search(plain)
        if geometric:
            counts[geometric[1].lower()] += 1
        elif _UNKNOWN.match(plain.lstrip(" \t\r\n(")):
            counts["geometric_tolerance"] += 1
        elif _DIMENSION.match(plain.lstrip(" \t\r\n(")) or ("SHAPE_ASPECT" in plain and _DIMENSION.search(plain)):
            dimensions[number] = _dimension_kind(body, plain)
        elif plain.lstrip().upper().startswith("PLUS_MINUS_TOLERANCE"):
            with_value |= {int(number) for number in _REFERENCE.findall(plain)[1:2]}
        elif plain.lstrip().upper().startswith("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            pair = [int(number) for number in _REFERENCE.findall(plain)]
            if len(pair) == 2:
                representations.append((pair[0], pair[1]))
    for dimension, representation in representations:
        items = [int(number) for number in _REFERENCE.findall(bodies.get(representation, ""))]
        if any(_is_limit(bodies, item) for item in items):
            with_value.add(dimension)
    counts.update(kind for number, kind in dimensions.items() if number in with_value)
    return dict(sorted(counts.items()))


def _dimension_kind(body: str, plain: str) -> str:
    """The kind of a dimension by its record's type and its own word."""
    word = " ".join(re.findall(r"'([^']*)'", body)).lower()
    if re.search(r"\bANGULAR_", plain, re.I) or "angle" in word:
        return "angle"
    if "toroidal" in word or "curved" in word or re.search(r"SIZE_WITH_PATH", plain, re.I):
        return "other"
    if re.search(r"\bDIMENSIONAL_LOCATION", plain, re.I) or re.search(r"DIRECTED_DIMENSIONAL", plain, re.I):
        return "distance"
    return next((kind for kind in ("diameter", "radius") if kind in word), "length")


def _is_limit(bodies: dict[int, str], item: int) -> bool:
    """Whether a value is an upper or lower limit, or qualified as a largest or smallest one."""
    body = bodies.get(item, "")
    if _LIMIT.search(body):
        return True
    qualified = _QUALIFIED.search(body)
    qualifiers = _REFERENCE.findall(qualified[1]) if qualified else ()
    return any(_MOST_OR_LEAST.search(bodies.get(int(number), "")) for number in qualifiers)
