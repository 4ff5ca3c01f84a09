"""The file of explicit viewpoints: CSV with ``id, x, y, z, qw, qx, qy, qz``.

Each row is a pose ``T_part_camera``: position in mm and unit quaternion, scalar first. The header names the
columns, so their order is free; further columns are ignored. A file of another format of poses
(:mod:`~viewgauge.formats.poses.pose_formats`) is read as such.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
from array import array
from collections.abc import Iterator, Sequence
from operator import itemgetter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError, ViewpointsFileError
from ...geometry import pose_from_quaternion, quaternion_from_pose, require_poses
from ..files.atomic import write_text_atomically
from ..files.spreadsheet_text import from_cell, to_cell
from ..files.text import read_text
from .pose_formats import is_pose_file, read_poses

__all__ = ["COLUMNS", "read_viewpoints", "write_viewpoints"]

COLUMNS = ("id", "x", "y", "z", "qw", "qx", "qy", "qz")

_MOST = 1e7  # mm: 10 km
_ROWS_PER_BLOCK = 2**16  # bounds what the conversion needs beside its result
_LINE = re.compile(r"[^\r\n]*(?:\r\n?|\n)|[^\r\n]+")

_Row = tuple[int, str, list[str]]


def read_viewpoints(path: str | os.PathLike[str]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Ids and poses ``T_part_camera`` ``(n, 4, 4)``, mm, of a viewpoints file, or of another format of poses.

    Raises
    ------
    ViewpointsFileError
        With file, line and column, if anything in it cannot be used.
    """
    text = read_text(path, ViewpointsFileError)
    if not _has_own_header(text) and is_pose_file(path):
        poses = read_poses(path)
        return poses.names, poses.poses
    lines: dict[str, int] = {}  # by id
    numbers = array("d")  # seven of each row
    try:
        for line, name, cells in _rows(path, text):
            if not name:
                raise ViewpointsFileError("the id is empty", file=path, line=line, key="id", expected="a unique name")
            if name in lines:
                raise ViewpointsFileError(
                    "the id is used twice",
                    file=path,
                    line=line,
                    key="id",
                    got=f"'{name}', first in line {lines[name]}",
                    expected="a unique name",
                )
            numbers.extend(_numbers(path, line, cells))
            lines[name] = line
    except ViewpointsFileError:
        _poses(path, numbers, lines)  # what is wrong further up is reported first
        raise
    if not lines:
        raise ViewpointsFileError("no viewpoints in the file", file=path, expected="at least one row below the header")
    return tuple(lines), _poses(path, numbers, lines)


def write_viewpoints(path: str | os.PathLike[str], ids: Sequence[str], poses: ArrayLike) -> None:
    """Write poses ``T_part_camera`` ``(n, 4, 4)``, mm, with their ids; every digit of the doubles is kept.

    Raises
    ------
    InputError
        If the poses are not rigid, their number is not that of the ids, or the place cannot be written to.
    """
    T_part_camera = require_poses(poses, "T_part_camera")
    if T_part_camera.shape != (len(ids), 4, 4):
        raise InputError("each pose needs one id", got=f"{len(ids)} ids, poses of shape {T_part_camera.shape}")
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(COLUMNS)
    for name, T, quaternion in zip(ids, T_part_camera, quaternion_from_pose(T_part_camera), strict=True):
        writer.writerow([to_cell(name), *(repr(float(number)) for number in (*T[:3, 3], *quaternion))])
    write_text_atomically(path, buffer.getvalue())


def _has_own_header(text: str) -> bool:
    first = next((line for line in text[:10_000].splitlines() if line.strip()), "")
    return set(COLUMNS) <= {cell.strip() for cell in re.split("[,;\t]", first)}


def _rows(path: str | os.PathLike[str], text: str) -> Iterator[_Row]:
    """Line number, id and the other cells in the order of the columns, of each row that is not blank."""
    reader = csv.reader((line.group() for line in _LINE.finditer(text)), skipinitialspace=True, strict=True)
    header: list[str] | None = None
    try:
        for cells in reader:
            cells = [cell.strip() for cell in cells]
            if not any(cells):
                continue
            if header is None:
                header = _header(path, reader.line_num, cells)
                chosen = itemgetter(*(header.index(column) for column in COLUMNS))
                continue
            if len(cells) != len(header):
                raise ViewpointsFileError(
                    "the row has another number of cells than the header",
                    file=path,
                    line=reader.line_num,
                    got=len(cells),
                    expected=f"{len(header)}: {', '.join(header)}",
                )
            name, *others = chosen(cells)
            yield reader.line_num, from_cell(name), others
    except csv.Error as error:
        raise ViewpointsFileError(f"not valid CSV: {error}", file=path, line=reader.line_num) from error
    if header is None:
        raise ViewpointsFileError("the file is empty", file=path, expected=f"a header: {', '.join(COLUMNS)}")


def _header(path: str | os.PathLike[str], line: int, cells: list[str]) -> list[str]:
    missing = [column for column in COLUMNS if column not in cells]
    if missing:
        separated = len(cells) == 1 and any(mark in cells[0] for mark in ";\t")
        raise ViewpointsFileError(
            "columns are missing" if len(missing) > 1 else "a column is missing",
            file=path,
            line=line,
            key=", ".join(missing),
            got=", ".join(cells),
            expected=f"a header: {', '.join(COLUMNS)}",
            hint="separate the columns by commas" if separated else None,
        )
    for column in COLUMNS:
        if cells.count(column) > 1:
            raise ViewpointsFileError("the column is there twice", file=path, line=line, key=column)
    return cells


def _numbers(path: str | os.PathLike[str], line: int, cells: list[str]) -> list[float]:
    """The numbers of a row, position and quaternion; all finite."""
    try:
        numbers = list(map(float, cells))
        if all(abs(number) <= _MOST for number in numbers):  # not so for NaN
            return numbers
    except ValueError:
        pass
    return [_number(path, line, column, cell) for column, cell in zip(COLUMNS[1:], cells, strict=True)]


def _number(path: str | os.PathLike[str], line: int, column: str, cell: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    if not abs(number) <= _MOST:
        raise ViewpointsFileError(
            "the number is too large" if math.isfinite(number) else "not a finite number",
            file=path,
            line=line,
            key=column,
            got=cell or "an empty cell",
            expected="a number in mm, without its unit" if column in "xyz" else "a part of a unit quaternion",
        )
    return number


def _poses(path: str | os.PathLike[str], numbers: array[float], lines: dict[str, int]) -> NDArray[np.float64]:
    """Poses ``(n, 4, 4)`` of rows of seven numbers."""
    rows = np.asarray(numbers).reshape(-1, 7)
    poses = np.empty((len(rows), 4, 4))
    for first in range(0, len(rows), _ROWS_PER_BLOCK):
        block = slice(first, first + _ROWS_PER_BLOCK)
        try:
            poses[block] = pose_from_quaternion(rows[block, :3], rows[block, 3:])
        except InputError:
            _require_unit(path, rows[block], list(lines.values())[block])
            raise
    return poses


def _require_unit(path: str | os.PathLike[str], rows: NDArray[np.float64], lines: Sequence[int]) -> None:
    """Raise ViewpointsFileError for the first row that is no pose."""
    for row, line in zip(rows, lines, strict=True):
        try:
            pose_from_quaternion(row[:3], row[3:])
        except InputError as error:
            raise ViewpointsFileError(
                error.problem, file=path, line=line, key="qw, qx, qy, qz", got=error.got, expected=error.expected
            ) from error
