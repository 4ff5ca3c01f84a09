"""Corners of a board in an image, as a table: points of the board (mm) and their places (px)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .number_table import NumberTable
from .pose_columns import HARMLESS
from .pose_file import PoseDocument

__all__ = ["read_corners"]

_POINTS = (("x_mm", "y_mm", "z_mm"), ("x_mm", "y_mm"))
_PLACES = (("u_px", "v_px"), ("u", "v"))
_EXPECTED = "x_mm, y_mm (and z_mm, else 0), u_px, v_px"


def read_corners(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points ``(n, 3)`` mm in the board frame, and places ``(n, 2)`` px (0 = centre of the first pixel).

    Raises
    ------
    InputError
        If the columns are others, or a cell is no number.
    """
    table = PoseDocument(path).table
    table.require_rows()
    header = [name.strip().lower() for name in table.header]
    points = next((names for names in _POINTS if set(names) <= set(header)), None)
    places = next((names for names in _PLACES if set(names) <= set(header)), None)
    if points is None or places is None:
        raise InputError("not a list of corners", file=path, got=", ".join(table.header), expected=_EXPECTED)
    left = [name for name in header if name not in (*points, *places, "id") and name not in HARMLESS]
    if left:
        raise InputError("a column is not used", file=path, key=", ".join(left), expected=_EXPECTED)
    board = _columns(table, header, points)
    flat = np.zeros((len(board), 3 - len(points)))
    return np.concatenate([board, flat], axis=1), _columns(table, header, places)


def _columns(table: NumberTable, header: list[str], names: tuple[str, ...]) -> NDArray[np.float64]:
    return np.stack([table.numbers(header.index(name)) for name in names], axis=1)
