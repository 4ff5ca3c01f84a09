"""Universal Robots: poses ``p[x, y, z, rx, ry, rz]`` in a script or a log."""

from __future__ import annotations

import re

import numpy as np

from ..pose_file import PoseConventions, PoseDocument, PoseFile, rigid
from ..pose_meaning import ask, length_unit, rotation_matrices, to_mm

__all__ = ["RobotScript"]

_POSE = re.compile(r"(?:(\w+)\s*=\s*)?\bp\[([^\]]*)\]")


class RobotScript:
    """Poses in text; m, a rotation vector in rad."""

    key = "ur-script"
    name = "Universal Robots p[x, y, z, rx, ry, rz]"
    form = "poses p[...] in a script or a log; m, rotation vector in rad"
    cannot_say = "the frames (base, feature, TCP)"

    def recognises(self, document: PoseDocument) -> bool:
        """By p[ and six numbers."""
        return any(match[2].count(",") == 5 for match in _POSE.finditer(document.text))

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses, by the names that they are given to."""
        names, lines, rows = [], [], []
        for match in _POSE.finditer(document.text):
            line = document.text.count("\n", 0, match.start()) + 1
            try:
                numbers = [float(cell) for cell in match[2].split(",")]
            except ValueError:
                numbers = []
            if len(numbers) != 6 or not np.isfinite(numbers).all() or max(map(abs, numbers)) > 1e7:
                raise document.error("not a pose of six numbers", line=line, got=match[0])
            names.append(match[1] or f"line {line}")
            lines.append(line)
            rows.append(numbers)
        values = np.array(rows)
        if conventions.unit is None and (question := length_unit(values[:, :3], "m")):
            raise ask(document, [question])
        unit = conventions.unit or "m"
        turns = rotation_matrices(conventions.rotation or "rotation-vector", values[:, 3:])
        poses = [
            rigid(document, line, p, R) for line, p, R in zip(lines, values[:, :3] * to_mm(unit), turns, strict=True)
        ]
        if len(set(names)) < len(names):
            names = [f"{name}/{k}" for k, name in enumerate(names, 1)]
        return PoseFile(self.name, tuple(names), np.array(poses), (f"{unit}; rotation vector in rad",))
