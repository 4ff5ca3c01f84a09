"""The text that ROS prints of a transform (``tf_echo``)."""

from __future__ import annotations

import re

import numpy as np

from ....exceptions import InputError
from ....geometry import pose_from_quaternion
from ..pose_file import PoseConventions, PoseDocument, PoseFile
from ..pose_meaning import ask, length_unit, rotation_matrices, to_mm

__all__ = ["TransformEcho"]

_TRANSLATION = re.compile(r"^\s*-?\s*Translation:\s*\[([^\]]*)\]", re.M)
_QUATERNION = re.compile(r"Quaternion\s*(?:\((\w+)\))?\s*\[([^\]]*)\]")
_ANGLES = re.compile(r"RPY\s*\((radian|degree)\)\s*\[([^\]]*)\]")
_TIME = re.compile(r"At time\s+([\d.]+)")


class TransformEcho:
    """Blocks of translation and rotation; the roll, pitch and yaw beside the quaternion are compared with it."""

    key = "tf-echo"
    name = "tf echo"
    form = "text with Translation: [x, y, z] and Quaternion [x, y, z, w]; m"
    cannot_say = "-"

    def recognises(self, document: PoseDocument) -> bool:
        """By its words."""
        return bool(_TRANSLATION.search(document.text)) and bool(_QUATERNION.search(document.text))

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses."""
        starts = [match.start() for match in _TRANSLATION.finditer(document.text)]
        names, poses, before = [], [], 0
        for start, end in zip(starts, [*starts[1:], len(document.text)], strict=True):
            block = document.text[start:end]
            line = document.text.count("\n", 0, start) + 1
            times = _TIME.findall(document.text[before:start])
            before = start
            quaternion = _QUATERNION.search(block)
            position = self._numbers(document, line, _TRANSLATION.search(block), 1, 3)
            parts = self._numbers(document, line, quaternion, 2, 4)
            order = (quaternion[1] if quaternion and quaternion[1] else "xyzw").lower()
            if order not in ("xyzw", "wxyz"):
                raise document.error("unknown order of the quaternion", line=line, got=order, expected="xyzw or wxyz")
            scalar_first = parts if order == "wxyz" else [parts[3], *parts[:3]]
            try:
                pose = pose_from_quaternion(position, scalar_first)
            except InputError as error:
                raise document.error(error.problem, line=line, got=str(error.got), expected=error.expected) from error
            for match in _ANGLES.finditer(block):
                angles = np.array(self._numbers(document, line, match, 2, 3))
                if match[1] == "degree":
                    angles = np.radians(angles)
                if np.abs(rotation_matrices("fixed-xyz", angles[None])[0] - pose[:3, :3]).max() > 0.01:
                    raise document.error(
                        "the quaternion and the roll, pitch and yaw beside it are two rotations",
                        line=line,
                        got=match[0],
                        expected="both the same; the quaternion in the order x, y, z, w",
                    )
            poses.append(pose)
            names.append(times[-1] if times else f"line {line}")
        if len(set(names)) < len(names):
            names = [f"{name}/{k}" for k, name in enumerate(names, 1)]
        matrices = np.array(poses)
        if conventions.unit is None and (question := length_unit(matrices[:, :3, 3], "m")):
            raise ask(document, [question])
        unit = conventions.unit or "m"
        matrices[:, :3, 3] *= to_mm(unit)
        return PoseFile(self.name, tuple(names), matrices, (f"{unit}; the quaternion agrees with roll, pitch and yaw",))

    def _numbers(
        self, document: PoseDocument, line: int, match: re.Match[str] | None, group: int, count: int
    ) -> list[float]:
        try:
            numbers = [float(cell) for cell in (match[group] if match else "").split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != count or not np.isfinite(numbers).all() or max(map(abs, numbers)) > 1e7:
            got = match[0] if match else None
            raise document.error(f"not {count} finite numbers", line=line, got=got, expected="[..., ...]")
        return numbers
