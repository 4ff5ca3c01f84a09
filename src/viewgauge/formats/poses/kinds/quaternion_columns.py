"""Tables of poses with a quaternion: named parts (qw, qx, qy, qz), or ABB's q1 to q4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....exceptions import InputError
from ....geometry import pose_from_quaternion
from ..pose_columns import LENGTHS, PoseColumns
from ..pose_file import PoseConventions, PoseDocument, PoseFile
from ..pose_meaning import ask, length_unit, to_mm

__all__ = ["ABB", "NAMED_QUATERNION", "QuaternionColumns", "poses_of_quaternions"]

_POSITION = ("x", "y", "z")


@dataclass(frozen=True)
class QuaternionColumns:
    """Columns of a position and a quaternion, scalar first by their canonical names."""

    key: str
    name: str
    form: str
    cannot_say: str
    quaternion: tuple[str, str, str, str]
    unit: str | None
    also: tuple[str, str, str, str] | None = None

    def recognises(self, document: PoseDocument) -> bool:
        """By the names of the columns."""
        return self.matches(PoseColumns.of(document.table))

    def matches(self, columns: PoseColumns) -> bool:
        """Whether these columns are there."""
        return self._parts(columns) is not None

    def used(self, columns: PoseColumns) -> tuple[str, ...]:
        """Canonical names of the columns."""
        return (*_POSITION, *(self._parts(columns) or ()))

    def _parts(self, columns: PoseColumns) -> tuple[str, ...] | None:
        for parts in (self.quaternion, self.also):
            if parts is not None and columns.has((*_POSITION, *parts)):
                return parts
        return None

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses."""
        document.table.require_rows()
        columns = PoseColumns.of(document.table)
        columns.require_used(self.used(columns))
        poses, note = self.poses(document, columns, conventions)
        return PoseFile(self.name, columns.names, poses, (note,))

    def poses(
        self, document: PoseDocument, columns: PoseColumns, conventions: PoseConventions
    ) -> tuple[NDArray[np.float64], str]:
        """``(n, 4, 4)`` mm, and how the numbers were understood; raises InputError where more must be said."""
        parts = self._parts(columns)
        assert parts is not None
        positions, quaternions = columns.numbers(_POSITION), columns.numbers(parts)
        unit = conventions.unit or columns.unit(_POSITION, LENGTHS)
        if unit is None and (question := length_unit(positions, self.unit)):
            raise ask(document, [question])
        unit = unit or self.unit or "mm"
        poses = poses_of_quaternions(document, document.table.lines, positions * to_mm(unit), quaternions)
        return poses, f"{parts[0]} is the scalar of the quaternion; {unit}"


def poses_of_quaternions(
    document: PoseDocument,
    lines: tuple[int, ...],
    positions_mm: NDArray[np.float64],
    quaternions: NDArray[np.float64],
) -> NDArray[np.float64]:
    """``(n, 4, 4)`` of positions ``(n, 3)`` and quaternions ``(n, 4)``, scalar first; raises InputError."""
    poses = np.empty((len(positions_mm), 4, 4))
    for k, (line, position, quaternion) in enumerate(zip(lines, positions_mm, quaternions, strict=True)):
        try:
            poses[k] = pose_from_quaternion(position, quaternion)
        except InputError as error:
            raise document.error(error.problem, line=line, got=str(error.got), expected=error.expected) from error
    return poses


NAMED_QUATERNION = QuaternionColumns(
    key="quaternion",
    name="x y z and qw qx qy qz by name",
    form="table whose columns name the quaternion's parts, in any order (also ROS's and EuRoC's names)",
    cannot_say="the unit of lengths where the names do not (x_m): mm where that is sane, else --unit",
    quaternion=("qw", "qx", "qy", "qz"),
    unit="mm",
)
ABB = QuaternionColumns(
    key="abb",
    name="ABB x y z q1 q2 q3 q4",
    form="table with the columns x, y, z, q1, q2, q3, q4 (or q0 to q3); mm; the first part is the scalar",
    cannot_say="the frames (wobj, tool)",
    quaternion=("q1", "q2", "q3", "q4"),
    unit="mm",
    also=("q0", "q1", "q2", "q3"),
)
