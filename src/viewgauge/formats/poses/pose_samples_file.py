"""Samples of a pose error: CSV of poses or of errors, or YAML of joints and poses as robots log them.

CSV, by its columns (their order is free; lengths mm unless the name ends in ``_m``):

- ``x, y, z, qw, qx, qy, qz`` and the same seven with ``measured_`` before: poses commanded and measured;
- ``pose, x, y, z, qw, qx, qy, qz``: poses measured, those of the same name being visits of one commanded pose;
- ``dx_mm, dy_mm, dz_mm, rx_mrad, ry_mrad, rz_mrad`` (or ``_um``, ``_m``; ``_rad``, ``_deg``): errors as they are.

YAML: a mapping of names to ``{pose: {x, y, z, qw, qx, qy, qz}, target_joints: [...]}``, m and rad as ROS has them.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import pose_from_quaternion
from ...measurement import PoseSamples, errors_about_group_means, errors_of_poses, fit_serial_arm
from ..files.problems import Problems
from ..files.text import read_text
from ..files.yaml_tree import parse_yaml

__all__ = ["SampleFile", "read_pose_samples"]

_POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
_LENGTH = {"_mm": 1.0, "_um": 1e-3, "_m": 1e3}
_ANGLE = {"_mrad": 1e-3, "_rad": 1.0, "_deg": math.pi / 180}
_ERRORS = ("dx", "dy", "dz", "rx", "ry", "rz")
_EXPECTED = (
    "x, y, z, qw, qx, qy, qz with measured_x, ..., measured_qz; or pose, x, ..., qz; "
    "or dx_mm, dy_mm, dz_mm, rx_mrad, ry_mrad, rz_mrad"
)


@dataclass(frozen=True)
class SampleFile:
    """The samples, what they are in words, and how many commanded poses were visited repeatedly (0 if none)."""

    samples: PoseSamples
    kind: str
    groups: int = 0


def read_pose_samples(path: str | os.PathLike[str]) -> SampleFile:
    """Samples of the pose error.

    Raises
    ------
    InputError
        With file, line and column, if anything in it cannot be used.
    """
    if Path(path).suffix.lower() in (".yaml", ".yml"):
        return _from_yaml(Path(path))
    if Path(path).suffix.lower() != ".csv":
        raise InputError("unknown kind of file for samples", file=path, expected=".csv, or .yaml of joints and poses")
    return _from_csv(Path(path))


# --- CSV ------------------------------------------------------------------------------------------------------------


def _from_csv(path: Path) -> SampleFile:
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
    table = _Table(path, header, rows[1:])
    names = table.text("id") or tuple(f"line {line}" for line, _ in table.rows)
    if (errors := table.errors()) is not None:
        return SampleFile(PoseSamples(errors, names), "pose errors")
    first, measured, visits = table.poses(""), table.poses("measured_"), table.text("pose")
    if first is not None and measured is not None:
        return SampleFile(PoseSamples(errors_of_poses(first, measured), names), "poses commanded and measured")
    if first is not None and visits is not None:
        errors, groups = errors_about_group_means(first, visits)
        return SampleFile(PoseSamples(errors, names, repeated=True), f"repeated visits of {groups} poses", groups)
    got = ", ".join(header)
    raise InputError("the columns are not those of samples", file=path, line=rows[0][0], got=got, expected=_EXPECTED)


class _Table:
    """Columns of a CSV by name."""

    def __init__(self, path: Path, header: list[str], rows: Sequence[tuple[int, list[str]]]) -> None:
        self.path, self.header, self.rows = path, header, rows
        for line, row in rows:
            if len(row) != len(header):
                got = f"{len(row)} cells"
                raise InputError(
                    "a row is longer or shorter than the header",
                    file=path,
                    line=line,
                    got=got,
                    expected=str(len(header)),
                )

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
        for k, name in enumerate(_POSE):
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
            if not np.isfinite(numbers[k]):
                raise InputError("not a finite number", file=self.path, line=line, key=name, got=row[place])
        return numbers


# --- YAML -----------------------------------------------------------------------------------------------------------


def _from_yaml(path: Path) -> SampleFile:
    problems = Problems(path)
    tree = parse_yaml(read_text(path, InputError), problems)
    problems.raise_if_any()
    expected = "names with pose: {x, y, z, qw, qx, qy, qz} (m) and target_joints: [...] (rad)"
    if not isinstance(tree.value, dict) or not tree.value:
        raise InputError("the file holds no samples", file=path, expected=expected)
    poses, joints, names = [], list[list[float]](), []
    for name, entry in tree.value.items():
        line = tree.lines.get((name,))
        pose = entry.get("pose") if isinstance(entry, dict) else None
        values = entry.get("target_joints") if isinstance(entry, dict) else None
        if not isinstance(pose, dict) or not _all_numbers(pose.get(key) for key in _POSE):
            raise InputError("not a pose of seven numbers", file=path, line=line, key=f"{name}.pose", expected=expected)
        if not isinstance(values, list) or not values or not _all_numbers(values):
            raise InputError("no joint values", file=path, line=line, key=f"{name}.target_joints", expected=expected)
        if joints and len(values) != len(joints[0]):
            got = f"{len(values)} joints, {len(joints[0])} before"
            raise InputError("not as many joints as before", file=path, line=line, key=f"{name}.target_joints", got=got)
        position = [1e3 * pose[axis] for axis in "xyz"]
        try:
            poses.append(pose_from_quaternion(position, [pose[key] for key in _POSE[3:]]))
        except InputError as error:
            raise InputError(error.problem, file=path, line=line, key=f"{name}.pose", got=error.got) from error
        joints.append(values)
        names.append(str(name))
    measured = np.array(poses)
    nominal, parameters = fit_serial_arm(np.array(joints, dtype=float), measured)
    kind = f"measured poses of {len(joints[0])} joints, against their best screw axes"
    return SampleFile(PoseSamples(errors_of_poses(nominal, measured), tuple(names), parameters), kind)


def _all_numbers(values: Iterable[object]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) and math.isfinite(v) for v in values)
