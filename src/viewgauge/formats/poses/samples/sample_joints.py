"""Samples of a pose error as joint values and measured poses, as robots log them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from ....exceptions import InputError
from ....geometry import pose_from_quaternion
from ....measurement import PoseSamples, errors_of_poses, fit_serial_arm
from .sample_file import SampleDocument, SampleFile
from .sample_table import POSE_COLUMNS

__all__ = ["JointSamples"]


class JointSamples:
    """YAML of names with ``{pose: {x, y, z, qw, qx, qy, qz}, target_joints: [...]}``, m and rad as ROS has them."""

    suffixes = (".yaml", ".yml")
    expected = "names with pose: {x, y, z, qw, qx, qy, qz} (m) and target_joints: [...] (rad)"

    def read(self, document: SampleDocument) -> SampleFile | None:
        """The errors against the arm that fits the joints best; None where the file is not YAML."""
        tree = document.tree
        if tree is None:
            return None
        if not isinstance(tree.value, dict) or not tree.value:
            raise InputError("the file holds no samples", file=document.path, expected=self.expected)
        poses, joints, names = [], list[list[float]](), []
        for name, entry in tree.value.items():
            line = tree.lines.get((name,))
            pose = entry.get("pose") if isinstance(entry, dict) else None
            values = entry.get("target_joints") if isinstance(entry, dict) else None
            if not isinstance(pose, dict) or not _all_numbers(pose.get(key) for key in POSE_COLUMNS):
                raise InputError(
                    "not a pose of seven numbers",
                    file=document.path,
                    line=line,
                    key=f"{name}.pose",
                    expected=self.expected,
                )
            if not isinstance(values, list) or not values or not _all_numbers(values):
                raise InputError(
                    "no joint values",
                    file=document.path,
                    line=line,
                    key=f"{name}.target_joints",
                    expected=self.expected,
                )
            if joints and len(values) != len(joints[0]):
                got = f"{len(values)} joints, {len(joints[0])} before"
                raise InputError(
                    "not as many joints as before", file=document.path, line=line, key=f"{name}.target_joints", got=got
                )
            position = [1e3 * pose[axis] for axis in "xyz"]
            try:
                poses.append(pose_from_quaternion(position, [pose[key] for key in POSE_COLUMNS[3:]]))
            except InputError as error:
                raise InputError(
                    error.problem, file=document.path, line=line, key=f"{name}.pose", got=error.got
                ) from error
            joints.append(values)
            names.append(str(name))
        measured = np.array(poses)
        nominal, parameters = fit_serial_arm(np.array(joints, dtype=float), measured)
        kind = f"measured poses of {len(joints[0])} joints, against their best screw axes"
        return SampleFile(PoseSamples(errors_of_poses(nominal, measured), tuple(names), parameters), kind)


def _all_numbers(values: Iterable[object]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) and math.isfinite(v) for v in values)
