"""Rows of numbers in text, with or without a header, however they are separated."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError

__all__ = ["NumberTable"]

_LARGEST = 1e7
"""No coordinate of a robot cell is larger, in whatever unit (times in seconds or nanoseconds are not coordinates)."""


@dataclass(frozen=True)
class NumberTable:
    """A table of text.

    Parameters
    ----------
    header, header_line
        Names of the columns; none where the first row is numbers (a comment above it may name them).
    rows
        Line and cells of each.
    decimal_comma
        Whether numbers are written 1,5.
    """

    path: Path
    header: tuple[str, ...]
    header_line: int | None
    rows: tuple[tuple[int, tuple[str, ...]], ...]
    decimal_comma: bool = False

    @classmethod
    def of(cls, path: Path, text: str) -> NumberTable:
        """The table of a text."""
        lines = [(k, line.strip()) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
        content = [(k, line) for k, line in lines if line[0] not in "#%" and not line.startswith("//")]
        if not content:
            return cls(path, (), None, ())
        separator = _separator(content[0][1])
        rows = [(k, _cells(line, separator)) for k, line in content]
        comma = separator == ";" and any("," in cell for _, row in rows[1:] for cell in row)
        if not _is_row_of_numbers(rows[0][1], comma):
            return cls(path, rows[0][1], rows[0][0], tuple(rows[1:]), comma)
        above = [(k, line.lstrip("#%/ \t")) for k, line in lines if k < content[0][0]]
        for k, line in above[::-1]:
            names = _cells(line, _separator(line))
            if len(names) == len(rows[0][1]):
                return cls(path, names, k, tuple(rows), comma)
        return cls(path, (), None, tuple(rows), comma)

    @cached_property
    def width(self) -> int:
        """Cells of each row; 0 where rows differ, or there are none."""
        widths = {len(row) for _, row in self.rows}
        return widths.pop() if len(widths) == 1 else 0

    @cached_property
    def is_numbers(self) -> bool:
        """Whether every cell is a number."""
        return bool(self.rows) and all(_is_row_of_numbers(row, self.decimal_comma) for _, row in self.rows)

    @property
    def lines(self) -> tuple[int, ...]:
        """The line of each row."""
        return tuple(line for line, _ in self.rows)

    def require_rows(self) -> None:
        """Raise InputError where there is no row, or one of another length than the header."""
        if not self.rows:
            raise InputError("no poses in the file", file=self.path, expected="a header and rows below it")
        for line, row in self.rows:
            if len(row) != len(self.header):
                raise InputError(
                    "a row is longer or shorter than the header",
                    file=self.path,
                    line=line,
                    got=f"{len(row)} cells",
                    expected=f"{len(self.header)}: {', '.join(self.header)}",
                )

    def text(self, place: int) -> tuple[str, ...]:
        """Cells of a column."""
        return tuple(row[place] for _, row in self.rows)

    def numbers(self, place: int) -> NDArray[np.float64]:
        """``(n,)``: numbers of a column; raises InputError with the line where a cell is none."""
        name = self.header[place] if self.header else f"column {place + 1}"
        found = np.empty(len(self.rows))
        for k, (line, row) in enumerate(self.rows):
            number = _number(row[place], self.decimal_comma)
            if number is None or not math.isfinite(number):
                raise InputError(
                    "not a finite number", file=self.path, line=line, key=name, got=row[place] or "an empty cell"
                )
            if abs(number) > _LARGEST:
                raise InputError(
                    "no position and no angle is so large",
                    file=self.path,
                    line=line,
                    key=name,
                    got=row[place][:40],
                    expected=f"at most {_LARGEST:g}",
                )
            found[k] = number
        return found


def _separator(line: str) -> str | None:
    for mark in ";\t,":
        if mark in line:
            return mark
    return None


def _cells(line: str, separator: str | None) -> tuple[str, ...]:
    line = line.strip()
    if line[:1] in "[({":  # a row of a printed list
        line = line.strip("[](){},").strip()
    if separator is None:
        return tuple(line.split())
    row = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    cells = [cell.strip() for cell in row]
    return tuple(cells[:-1] if len(cells) > 1 and not cells[-1] else cells)


def _number(cell: str, comma: bool) -> float | None:
    try:
        return float(cell.replace(",", ".") if comma else cell)
    except ValueError:
        return None


def _is_row_of_numbers(row: tuple[str, ...], comma: bool) -> bool:
    return all(_number(cell, comma) is not None for cell in row)
