"""The file of explicit sensor settings: CSV with ``id, x, y, z, qw, qx, qy, qz``.

Each row is a pose ``T_part_camera``: position in mm and unit quaternion, scalar first. The header names the
columns, so their order is free; further columns are ignored.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError, SettingsFileError
from ..geometry import pose_from_quaternion, quaternion_from_pose, require_poses
from .atomic import write_text_atomically
from .text import read_text

__all__ = ["COLUMNS", "read_settings", "write_settings"]

COLUMNS = ("id", "x", "y", "z", "qw", "qx", "qy", "qz")

_Row = tuple[int, dict[str, str]]


def read_settings(path: str | os.PathLike[str]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Ids and poses ``T_part_camera`` ``(n, 4, 4)``, mm, of a settings file.

    Raises
    ------
    SettingsFileError
        With file, line and column, if anything in it cannot be used.
    """
    text = read_text(path, SettingsFileError)
    poses: dict[str, NDArray[np.float64]] = {}
    lines: dict[str, int] = {}
    for line, row in _rows(path, text):
        name = row["id"]
        if not name:
            raise SettingsFileError("the id is empty", file=path, line=line, key="id", expected="a unique name")
        if name in poses:
            raise SettingsFileError(
                "the id is used twice",
                file=path,
                line=line,
                key="id",
                got=f"'{name}', first in line {lines[name]}",
                expected="a unique name",
            )
        poses[name], lines[name] = _pose(path, line, row), line
    if not poses:
        raise SettingsFileError("no settings in the file", file=path, expected="at least one row below the header")
    return tuple(poses), np.stack(list(poses.values()))


def write_settings(path: str | os.PathLike[str], ids: Sequence[str], poses: ArrayLike) -> None:
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
        writer.writerow([name, *(repr(float(number)) for number in (*T[:3, 3], *quaternion))])
    write_text_atomically(path, buffer.getvalue())


def _rows(path: str | os.PathLike[str], text: str) -> Iterator[_Row]:
    """Line number and cells by column name of each row that is not blank."""
    reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True, strict=True)
    header: list[str] | None = None
    try:
        for cells in reader:
            cells = [cell.strip() for cell in cells]
            if not any(cells):
                continue
            if header is None:
                header = _header(path, reader.line_num, cells)
                continue
            if len(cells) != len(header):
                raise SettingsFileError(
                    "the row has another number of cells than the header",
                    file=path,
                    line=reader.line_num,
                    got=len(cells),
                    expected=f"{len(header)}: {', '.join(header)}",
                )
            yield reader.line_num, dict(zip(header, cells, strict=True))
    except csv.Error as error:
        raise SettingsFileError(f"not valid CSV: {error}", file=path, line=reader.line_num) from error
    if header is None:
        raise SettingsFileError("the file is empty", file=path, expected=f"a header: {', '.join(COLUMNS)}")


def _header(path: str | os.PathLike[str], line: int, cells: list[str]) -> list[str]:
    missing = [column for column in COLUMNS if column not in cells]
    if missing:
        separated = len(cells) == 1 and any(mark in cells[0] for mark in ";\t")
        raise SettingsFileError(
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
            raise SettingsFileError("the column is there twice", file=path, line=line, key=column)
    return cells


def _pose(path: str | os.PathLike[str], line: int, row: dict[str, str]) -> NDArray[np.float64]:
    numbers = []
    for column in COLUMNS[1:]:
        try:
            number = float(row[column])
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise SettingsFileError(
                "not a finite number",
                file=path,
                line=line,
                key=column,
                got=row[column] or "an empty cell",
                expected="a number in mm, without its unit" if column in "xyz" else "a part of a unit quaternion",
            )
        numbers.append(number)
    try:
        return pose_from_quaternion(numbers[:3], numbers[3:])
    except InputError as error:
        raise SettingsFileError(
            error.problem, file=path, line=line, key="qw, qx, qy, qz", got=error.got, expected=error.expected
        ) from error
