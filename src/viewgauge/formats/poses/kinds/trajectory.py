"""Rows of a position and a quaternion without names: TUM trajectories (with a time), and seven numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..pose_columns import PoseColumns
from ..pose_file import PoseConventions, PoseDocument, PoseFile
from ..pose_meaning import ask, length_unit, to_mm
from .quaternion_columns import poses_of_quaternions

__all__ = ["QuaternionRows", "Trajectory"]

_UNIT_TOLERANCE = 1e-3
_NAMED = ("x", "y", "z", "qx", "qy", "qz", "qw")
_ORDERS = {"xyzw": [3, 0, 1, 2], "wxyz": [0, 1, 2, 3]}


class Trajectory:
    """Eight numbers a row: time tx ty tz qx qy qz qw."""

    key = "tum"
    name = "TUM trajectory"
    form = "rows of time tx ty tz qx qy qz qw; m; the scalar last"
    cannot_say = "the frames; the unit is asked for where metres are implausible"

    def recognises(self, document: PoseDocument) -> bool:
        """By eight numbers a row, the last four of them a unit quaternion, and no names of columns but its own."""
        table = document.table
        if not table.is_numbers or table.width != 8 or not _are_units(_numbers(document, slice(4, 8))):
            return False
        columns = PoseColumns.of(table)
        if not columns.has(("qw", "qx")):  # a comment above the rows names nothing
            return True
        return [columns.places.get(name) for name in _NAMED] == list(range(1, 8)) and not columns.units

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses, named by their times."""
        numbers = _numbers(document, slice(1, 8))
        times = document.table.text(0)
        names = times if len(set(times)) == len(times) else tuple(f"line {line}" for line in document.table.lines)
        order = conventions.quaternion or "xyzw"
        poses, unit = _poses(document, numbers, order, conventions, "m")
        return PoseFile(self.name, names, poses, (f"{unit}; quaternions {order}",))


class QuaternionRows:
    """Seven numbers a row, whose order nothing says."""

    key = "xyz-quaternion"
    name = "rows of x y z and a quaternion"
    form = "rows of seven numbers, without names"
    cannot_say = "the order of the quaternion (--quaternion xyzw or wxyz) and the unit of lengths (--unit)"

    def recognises(self, document: PoseDocument) -> bool:
        """By seven numbers a row, the last four of them a unit quaternion."""
        table = document.table
        return (
            table.is_numbers and table.width == 7 and not table.header and _are_units(_numbers(document, slice(3, 7)))
        )

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses."""
        numbers = _numbers(document, slice(0, 7))
        missing = []
        if conventions.quaternion is None:
            how = "--quaternion xyzw or --quaternion wxyz"
            missing.append(("whether a quaternion's scalar stands first or last", how, ""))
        if conventions.unit is None and (question := length_unit(numbers[:, :3], None)):
            missing.append(question)
        if missing:
            raise ask(document, missing)
        order = conventions.quaternion or ""
        poses, unit = _poses(document, numbers, order, conventions, None)
        names = tuple(f"line {line}" for line in document.table.lines)
        return PoseFile(self.name, names, poses, (f"{unit}; quaternions {order}",))


def _poses(
    document: PoseDocument, numbers: NDArray[np.float64], order: str, conventions: PoseConventions, usual: str | None
) -> tuple[NDArray[np.float64], str]:
    if conventions.unit is None and (question := length_unit(numbers[:, :3], usual)):
        raise ask(document, [question])
    unit = conventions.unit or usual or "mm"
    if order not in _ORDERS:
        raise document.error("unknown order of quaternions", key="--quaternion", got=order, expected="xyzw or wxyz")
    quaternions = numbers[:, 3:][:, _ORDERS[order]]
    return poses_of_quaternions(document, document.table.lines, numbers[:, :3] * to_mm(unit), quaternions), unit


def _numbers(document: PoseDocument, part: slice) -> NDArray[np.float64]:
    table = document.table
    return np.stack([table.numbers(k) for k in range(table.width)[part]], axis=1)


def _are_units(quaternions: NDArray[np.float64]) -> bool:
    return bool((np.abs(np.linalg.norm(quaternions, axis=1) - 1) < _UNIT_TOLERANCE).all())
