"""The columns of a CSV file of samples, by name."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import pose_from_quaternion
from ..files.text import read_text

__all__ = ["POSE_COLUMNS", "SampleTable"]

POSE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz")
_MOST = 1e9  # of any unit
_LENGTH = {"_mm": 1.0, "_um": 1e-3, "_m": 1e3}
_ANGLE = {"_mrad": 1e-3, "_rad": 1.0, "_deg": math.pi / 180}
_ERRORS = ("dx", "dy", "dz", "rx", "ry", "rz")


class SampleTable:
    """Columns of a CSV file by name, and the lines of the header and of each row."""

    def __init__(self, path: Path, line: int, header: list[str], rows: Sequence[tuple[int, list[str]]]) -> None:
        self.path, self.line, self.header, self.rows = path, line, header, rows

    @classmethod
    def read(cls, path: Path) -> SampleTable:
        """The table of a file; raises InputError where it is none, or holds no row."""
        reader = csv.reader(io.StringIO(read_text(path, InputError)))
        try:
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
        except csv.Error as error:
            raise InputError(f"not CSV: {error}", file=path, line=reader.line_num) from error
        if len(rows) < 2:
            raise InputError("no samples in the file", file=path, expected="a header and rows below it")
        header = [name.strip() for name in rows[0][1]]
        if repeated := {name for name in header if header.count(name) > 1}:
            raise InputError("a column stands twice", file=path, line=rows[0][0], got=", ".join(sorted(repeated)))
        for line, row in rows[1:]:
            if len(row) != len(header):
                raise InputError(
                    "a row is longer or shorter than the header",
                    file=path,
                    line=line,
                    got=f"{len(row)} cells",
                    expected=str(len(header)),
                )
        return cls(path, rows[0][0], header, rows[1:])

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each sample: its id, or its line."""
        return self.text("id") or tuple(f"line {line}" for line, _ in self.rows)

    def text(self, name: str) -> tuple[str, ...] | None:
        """The cells of a column; None where there is none."""
        if name not in self.header:
            return None
        place = self.header.index(name)
        return tuple(row[place].strip() for _, row in self.rows)

    def errors(self) -> NDArray[np.float64] | None:
        """``(n, 6)`` mm and rad; None where the columns are not there."""
        columns = []
        for name in _ERRORS:
            units = _LENGTH if name.startswith("d") else _ANGLE
            found = [suffix for suffix in units if name + suffix in self.header]
            if not found:
                return None
            columns.append(self._numbers(name + found[0]) * units[found[0]])
        return np.stack(columns, axis=1)

    def poses(self, before: str) -> NDArray[np.float64] | None:
        """``(n, 4, 4)`` mm; None where the columns are not there."""
        names, scale = [], np.ones(3)
        for k, name in enumerate(POSE_COLUMNS):
            metres = k < 3 and f"{before}{name}_m" in self.header
            names.append(f"{before}{name}_m" if metres else before + name)
            if metres:
                scale[k] = 1e3
        if not set(names) <= set(self.header):
            return None
        numbers = np.stack([self._numbers(name) for name in names], axis=1)
        return np.array([self._pose(k, row[:3] * scale, row[3:]) for k, row in enumerate(numbers)])

    def _pose(self, k: int, position: NDArray[np.float64], quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
        try:
            return pose_from_quaternion(position, quaternion)
        except InputError as error:
            raise InputError(
                error.problem, file=self.path, line=self.rows[k][0], got=error.got, hint=error.hint
            ) from error

    def _numbers(self, name: str) -> NDArray[np.float64]:
        place = self.header.index(name)
        numbers = np.empty(len(self.rows))
        for k, (line, row) in enumerate(self.rows):
            try:
                numbers[k] = float(row[place])
            except ValueError:
                numbers[k] = np.nan
            if not np.abs(numbers[k]) <= _MOST:
                problem = "the number is too large" if np.isfinite(numbers[k]) else "not a finite number"
                raise InputError(problem, file=self.path, line=line, key=name, got=row[place])
        return numbers
