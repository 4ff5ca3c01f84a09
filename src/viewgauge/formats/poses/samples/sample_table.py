"""The columns of a CSV file of samples, by name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....exceptions import InputError
from ...files.text import read_text
from ..kinds.fanuc_columns import FANUC_COLUMNS
from ..kinds.kuka import KUKA
from ..kinds.quaternion_columns import ABB, NAMED_QUATERNION
from ..kinds.roll_pitch_yaw import ROLL_PITCH_YAW
from ..kinds.rotation_vector import ROTATION_COLUMNS
from ..pose_columns import HARMLESS, PoseColumns
from ..pose_file import PoseConventions, PoseDocument

__all__ = ["POSE_COLUMNS", "SampleTable"]

POSE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz")
_LENGTH = {"_mm": 1.0, "_um": 1e-3, "_m": 1e3}
_ANGLE = {"_mrad": 1e-3, "_rad": 1.0, "_deg": math.pi / 180}
_ERRORS = ("dx", "dy", "dz", "rx", "ry", "rz")
_KINDS = (NAMED_QUATERNION, KUKA, FANUC_COLUMNS, ABB, ROTATION_COLUMNS, ROLL_PITCH_YAW)
_NAMES = ("id", "name", "pose", "label", "point")


class SampleTable:
    """Columns of a CSV file by name, and the lines of the header and of each row; it knows which columns were used."""

    def __init__(self, document: PoseDocument, conventions: PoseConventions | None = None) -> None:
        self.document, self.table = document, document.table
        self.conventions = conventions or PoseConventions()
        self._used: set[int] = set()

    @classmethod
    def read(cls, path: Path, conventions: PoseConventions | None = None) -> SampleTable:
        """The table of a file; raises InputError where it is none, or holds no row."""
        document = PoseDocument(path, read_text(path, InputError))
        table = document.table
        if not table.rows:
            raise InputError("no samples in the file", file=path, expected="a header and rows below it")
        if table.header:
            table.require_rows()
        if repeated := {name for name in table.header if table.header.count(name) > 1}:
            raise InputError(
                "a column stands twice", file=path, line=table.header_line, got=", ".join(sorted(repeated))
            )
        return cls(document, conventions)

    @property
    def path(self) -> Path:
        """Of the file."""
        return self.table.path

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self.table.header

    @property
    def line(self) -> int | None:
        """Of the header."""
        return self.table.header_line

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each sample: its id, or its line."""
        return self.text("id") or tuple(f"line {line}" for line in self.table.lines)

    def text(self, name: str) -> tuple[str, ...] | None:
        """The cells of a column; None where there is none."""
        if name not in self.header:
            return None
        place = self.header.index(name)
        self._used.add(place)
        return self.table.text(place)

    def errors(self) -> NDArray[np.float64] | None:
        """``(n, 6)`` mm and rad; None where the columns are not there."""
        found = []
        for name in _ERRORS:
            units = _LENGTH if name.startswith("d") else _ANGLE
            there = [(name + suffix, factor) for suffix, factor in units.items() if name + suffix in self.header]
            if not there:
                return None
            found.append(there[0])
        self._used.update(self.header.index(name) for name, _ in found)
        columns = [self.table.numbers(self.header.index(name)) * factor for name, factor in found]
        return np.stack(columns, axis=1)

    def poses(self, *before: str) -> NDArray[np.float64] | None:
        """``(n, 4, 4)`` mm of the columns whose names begin with the first of ``before`` that has a pose; else None."""
        for start in before:
            columns = PoseColumns.of(self.table, start)
            for kind in _KINDS:
                if kind.matches(columns):
                    poses, names = self._poses_of(kind, columns)
                    self._used.update(columns.places[name] for name in names)
                    return poses
        return None

    def _poses_of(self, kind: object, columns: PoseColumns) -> tuple[NDArray[np.float64], Sequence[str]]:
        said = self.conventions
        if kind is NAMED_QUATERNION:
            unit = said.unit or columns.unit(("x", "y", "z"), {"mm": 1, "cm": 1, "m": 1, "inch": 1}) or "mm"
            said = PoseConventions(unit=unit)  # metres under the names of mm are a finding, not a question
        poses, _ = kind.poses(self.document, columns, said)  # type: ignore[attr-defined]
        return poses, kind.used(columns)  # type: ignore[attr-defined]

    def require_used(self) -> None:
        """Raise InputError where a column was not used and is not known to be harmless."""
        harmless = HARMLESS | set(_NAMES)
        left = [
            name for place, name in enumerate(self.header) if place not in self._used and name.lower() not in harmless
        ]
        if left:
            raise InputError(
                "a column is not used" if len(left) == 1 else "columns are not used",
                file=self.path,
                line=self.line,
                key=", ".join(left),
                hint="take it out, or name it as what it is",
            )
