"""Tables of poses with three angles: what KUKA, Fanuc, Universal Robots and roll-pitch-yaw tables share."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..pose_columns import ANGLES, LENGTHS, PoseColumns
from ..pose_file import PoseConventions, PoseDocument, PoseFile, rigid
from ..pose_meaning import angle_unit, ask, length_unit, rotation_matrices, to_mm, to_rad

__all__ = ["AngleColumns"]

_MEANINGS = {
    "rotation-vector": "a rotation vector",
    "fixed-xyz": "turns about the fixed axes x, y, z in this order",
    "turning-zyx": "turns about z, then the new y, then the new x",
}


@dataclass(frozen=True)
class AngleColumns:
    """Columns of a position and three angles.

    Parameters
    ----------
    angles
        Canonical names of the columns.
    unit, angle, rotation
        What the format says; None where its columns do not say it.
    middle_within_90
        Controllers give the middle angle from -90 to 90 deg: another is another convention.
    """

    key: str
    name: str
    form: str
    cannot_say: str
    angles: tuple[str, str, str]
    unit: str | None = None
    angle: str | None = None
    rotation: str | None = None
    middle_within_90: bool = False
    position: tuple[str, ...] = field(default=("x", "y", "z"))

    def recognises(self, document: PoseDocument) -> bool:
        """By the names of the columns."""
        return self.matches(PoseColumns.of(document.table))

    def matches(self, columns: PoseColumns) -> bool:
        """Whether these columns are there."""
        return columns.has((*self.position, *self.angles))

    def used(self, columns: PoseColumns) -> tuple[str, ...]:
        """Canonical names of the columns."""
        del columns  # which are always the same
        return (*self.position, *self.angles)

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
        positions, angles = columns.numbers(self.position), columns.numbers(self.angles)
        unit = conventions.unit or columns.unit(self.position, LENGTHS)
        angle = conventions.angle or columns.unit(self.angles, ANGLES)
        missing = []
        if unit is None and (question := length_unit(positions, self.unit)):
            missing.append(question)
        if angle is None and (question := angle_unit(angles, self.angle)):
            missing.append(question)
        unit, angle = unit or self.unit or "mm", angle or self.angle or "rad"
        turns = angles * to_rad(angle)
        rotation = conventions.rotation or self.rotation
        if rotation is None or (conventions.rotation is None and self._is_of_another_kind(turns)):
            missing.append(self._ask_rotation(turns))
        if missing:
            raise ask(document, missing)
        assert rotation is not None
        matrices = rotation_matrices(rotation, turns)
        rows = zip(document.table.lines, positions * to_mm(unit), matrices, strict=True)
        poses = np.array([rigid(document, line, p, R) for line, p, R in rows])
        meaning = _MEANINGS.get(rotation, rotation)
        return poses, f"{', '.join(self.angles)} are {meaning}; {unit} and {angle}"

    def _is_of_another_kind(self, turns: NDArray[np.float64]) -> bool:
        return self.middle_within_90 and bool((np.abs(turns[:, 1]) > np.radians(90.001)).any())

    def _ask_rotation(self, turns: NDArray[np.float64]) -> tuple[str, str, str]:
        what = f"what the angles {', '.join(self.angles)} mean"
        if self.rotation is not None:
            what += f" (this form has {self.angles[1]} from -90 to 90 deg, and here it is beyond)"
        vector = len(turns) > 2 and bool((np.linalg.norm(turns, axis=1) <= np.pi + 0.01).all())
        proposal = "--rotation rotation-vector (no row turns by more than 180 deg)" if vector else ""
        how = "--rotation rotation-vector, fixed-xyz (roll, pitch, yaw), turning-xyz, turning-zyx, ..."
        return what, how, proposal
