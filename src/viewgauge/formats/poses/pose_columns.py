"""Columns of a table by name: which of them make a pose, in which unit, and which are left over."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .number_table import NumberTable

__all__ = ["ANGLES", "LENGTHS", "PoseColumns"]

LENGTHS = {"mm": 1.0, "cm": 10.0, "m": 1e3, "inch": 25.4}
ANGLES = {"deg": np.pi / 180, "rad": 1.0}
_SUFFIXES = {"mm": "mm", "cm": "cm", "m": "m", "in": "inch", "inch": "inch", "deg": "deg", "°": "deg", "rad": "rad"}
_UNIT = re.compile(r"(?:[\s_]*[\[(]\s*(?P<bracketed>[^\])]*)\s*[\])]|[_ ](?P<suffix>mm|cm|m|inch|in|deg|rad))\s*$")
_LEADING = re.compile(r"^(field_)?(pose_)*(transform_)?")
_OF_POSITION = "{0} t{0} p{0} pos_{0} p_{0} t_{0} position_{0} translation_{0} p_rs_r_{0}"
_OF_QUATERNION = "q{0} q_{0} quat_{0} orientation_{0} quaternion_{0} q_rs_{0}"
_ALIASES = {axis: _OF_POSITION.format(axis).split() for axis in "xyz"} | {
    f"q{axis}": _OF_QUATERNION.format(axis).split() for axis in "wxyz"
}
_ALIASES["qw"].append("rotation_w")
_CANONICAL = {alias: name for name, aliases in _ALIASES.items() for alias in aliases}
_NAMES = ("id", "name", "label", "point", "pose_id", "pose_name")
_HARMLESS = (
    "time timestamp t stamp sec nanosec secs nsecs stamp_sec stamp_nanosec header_seq header_stamp header_stamp_sec "
    "header_stamp_nanosec header_stamp_secs header_stamp_nsecs header_frame_id frame_id child_frame_id seq index row "
    "n no nr number # date comment note file image uf ut config s turn status visit repeat run"
)
HARMLESS = frozenset(_HARMLESS.split())
"""Columns that say nothing of a pose: times, counters, names of frames and files, the arm's configuration."""


@dataclass(frozen=True)
class PoseColumns:
    """The columns of one kind of pose in a table, those whose names begin with ``before``.

    Parameters
    ----------
    places, units, twice
        Of each column by its canonical name, such as ``x``, ``qw`` or ``a``: its place, and its unit where its name
        says one; and names that stand twice.
    """

    table: NumberTable
    before: str
    places: dict[str, int]
    units: dict[str, str]
    twice: tuple[str, ...] = ()

    @classmethod
    def of(cls, table: NumberTable, before: str = "") -> PoseColumns:
        """Columns by their canonical names."""
        places: dict[str, int] = {}
        units: dict[str, str] = {}
        twice: list[str] = []
        for place, written in enumerate(table.header):
            name, unit = _read_name(written)
            if not name.startswith(before):
                continue
            name = _canonical(name[len(before) :], table.header)
            if name in places:
                twice.append(f"{table.header[places[name]]} and {written}")
            places[name] = place
            if unit is not None:
                units[name] = unit
        return cls(table, before, places, units, tuple(twice))

    def has(self, names: Sequence[str]) -> bool:
        """Whether all of these columns are there."""
        return set(names) <= self.places.keys()

    def numbers(self, names: Sequence[str]) -> NDArray[np.float64]:
        """``(n, len(names))`` as written."""
        return np.stack([self.table.numbers(self.places[name]) for name in names], axis=1)

    def unit(self, names: Sequence[str], known: dict[str, float]) -> str | None:
        """The unit that the names of the columns say; None if none does; raises InputError where they differ."""
        said = {self.units.get(name) for name in names}
        if said == {None}:
            return None
        unit = said.pop()
        if said or unit is None or unit not in known:
            raise InputError(
                "the units of the columns are not one unit of the kind",
                file=self.table.path,
                line=self.table.header_line,
                got=", ".join(self.table.header[self.places[name]] for name in names),
                expected=f"one of {', '.join(known)} for all of them",
            )
        return unit

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The name of each row: of a column of names, else by its line."""
        for name in _NAMES:
            if name in self.places:
                found = self.table.text(self.places[name])
                if len(set(found)) == len(found):
                    return found
        return tuple(f"line {line}" for line in self.table.lines)

    def require_used(self, used: Sequence[str]) -> None:
        """Raise InputError where a column is neither used nor known to be harmless, or two say the same."""
        if self.twice:
            raise InputError(
                "a column stands twice", file=self.table.path, line=self.table.header_line, got="; ".join(self.twice)
            )
        left = [name for name in self.places if name not in used and name not in HARMLESS and name not in _NAMES]
        if left:
            raise InputError(
                "a column is not used" if len(left) == 1 else "columns are not used",
                file=self.table.path,
                line=self.table.header_line,
                key=", ".join(self.table.header[self.places[name]] for name in left),
                expected=f"{', '.join(used)}, and names or times beside them",
                hint="take the column out, or name it as what it is",
            )


def _read_name(written: str) -> tuple[str, str | None]:
    """Name in lower case with _ between words, and its unit; None where it says none."""
    text, unit = written.strip().lower(), None
    match = _UNIT.search(text)
    if match and match.start():
        said = match["bracketed"] if match["bracketed"] is not None else match["suffix"]
        if said.strip() in _SUFFIXES:
            unit = _SUFFIXES[said.strip()]
            text = text[: match.start()]
        elif match["bracketed"] is not None and said.strip() in ("", "-", "1", "ns", "s"):
            text = text[: match.start()]
    return re.sub(r"[\s.\-/]+", "_", text.strip()), unit


def _canonical(name: str, header: Sequence[str]) -> str:
    name = name if name in _NAMES else _LEADING.sub("", name) or name
    if name in ("rotation_x", "rotation_y", "rotation_z") and any("rotation" in h and h.endswith("w") for h in header):
        return "q" + name[-1]
    return _CANONICAL.get(name, name)
