"""Poses as matrices: sixteen or twelve numbers a row, blocks of four rows, or columns m00 to m33."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..number_table import NumberTable
from ..pose_columns import PoseColumns
from ..pose_file import PoseConventions, PoseDocument, PoseFile, rigid
from ..pose_meaning import ask, length_unit, to_mm

__all__ = ["MatrixRows", "poses_of_matrices"]

_LAST_ROW = np.array([0.0, 0, 0, 1])
_ELEMENTS = [f"{k}{m}" for k in range(4) for m in range(4)]
_FROM_ONE = [f"{k}{m}" for k in range(1, 5) for m in range(1, 5)]


class MatrixRows:
    """Rows of numbers, or columns named after a matrix's elements."""

    key = "matrix"
    name = "rows of 4x4 matrices"
    form = "text or CSV: 16 numbers a row (row by row), 12 (the last row left out), blocks of 4 rows, or m00 to m33"
    cannot_say = "the unit of lengths: --unit"

    def recognises(self, document: PoseDocument) -> bool:
        """By the names of the columns, or as rows of numbers whose last four are 0 0 0 1."""
        return self._matrices(document) is not None

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses."""
        found = self._matrices(document)
        assert found is not None
        names, lines, matrices = found
        poses, notes = poses_of_matrices(document, lines, matrices, conventions)
        return PoseFile(self.name, names, poses, notes)

    def _matrices(self, document: PoseDocument) -> tuple[tuple[str, ...], tuple[int, ...], NDArray[np.float64]] | None:
        """Names, lines and matrices ``(n, 4, 4)`` as written; None where it is another kind of file."""
        table = document.table
        if (named := _of_columns(table)) is not None:
            return named
        if not table.is_numbers or table.width not in (4, 12, 16) or (table.width == 4 and len(table.rows) % 4):
            return None
        rows = np.stack([table.numbers(k) for k in range(table.width)], axis=1)
        lines = table.lines
        if table.width == 12:
            rows = np.concatenate([rows, np.broadcast_to(_LAST_ROW, (len(rows), 4))], axis=1)
        if table.width == 4:
            lines = lines[::4]
        matrices = rows.reshape(-1, 4, 4)
        borders = [matrices[:, 3] == _LAST_ROW, matrices[:, :, 3] == _LAST_ROW]
        if table.width == 4 and not any(border.all() for border in borders):
            return None
        return tuple(f"line {line}" for line in lines), lines, matrices


def _of_columns(table: NumberTable) -> tuple[tuple[str, ...], tuple[int, ...], NDArray[np.float64]] | None:
    columns = PoseColumns.of(table)
    for letter in ("m", "t", "r"):
        for elements in (_ELEMENTS, _FROM_ONE):
            all_of = [letter + element for element in elements]
            for written in (all_of, all_of[:12]):
                if columns.has(written):
                    table.require_rows()
                    columns.require_used(written)
                    rows = columns.numbers(written)
                    if len(written) == 12:
                        rows = np.concatenate([rows, np.broadcast_to(_LAST_ROW, (len(rows), 4))], axis=1)
                    return columns.names, table.lines, rows.reshape(-1, 4, 4)
    return None


def poses_of_matrices(
    document: PoseDocument,
    lines: tuple[int, ...],
    matrices: NDArray[np.float64],
    conventions: PoseConventions,
    usual: str | None = None,
) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """``(n, 4, 4)`` mm of matrices as written, and how they were understood.

    Raises
    ------
    InputError
        If one is not a pose, or its unit must be said.
    """
    notes = []
    if (matrices[:, :, 3] == _LAST_ROW).all() and not (matrices[:, 3] == _LAST_ROW).all():
        matrices = matrices.swapaxes(1, 2)
        notes.append("the matrices are written column by column (0 0 0 1 is their last column): transposed")
    for line, matrix in zip(lines, matrices, strict=True):
        if not np.allclose(matrix[3], _LAST_ROW, rtol=0, atol=1e-9):
            raise document.error(
                "the last row is not 0 0 0 1",
                line=line,
                got=" ".join(f"{v:g}" for v in matrix[3]),
                expected="a 4x4 matrix, row by row",
            )
    question = None if conventions.unit else length_unit(matrices[:, :3, 3], usual)
    if question or (conventions.unit is None and usual is None):
        raise ask(document, [question or ("the unit of lengths", "--unit mm, cm, m or inch", "")])
    unit = conventions.unit or usual or "mm"
    positions = matrices[:, :3, 3] * to_mm(unit)
    poses = [rigid(document, line, p, R) for line, p, R in zip(lines, positions, matrices[:, :3, :3], strict=True)]
    return np.array(poses), (unit, *notes)
