"""Fanuc: the positions of a program as text (.ls)."""

from __future__ import annotations

import re

import numpy as np

from ..pose_file import PoseConventions, PoseDocument, PoseFile, rigid
from ..pose_meaning import rotation_matrices

__all__ = ["FanucProgram"]

_POSITION = re.compile(r"\bPR?\s*\[\s*(\d+)\s*(?::\s*([^\]]*))?\]\s*\{(.*?)\}\s*;", re.S)
_GROUP = re.compile(r"\bGP(\d+)\s*:")
_VALUE = re.compile(r"\b([XYZWPR])\s*=\s*([^\s,]+)\s*(mm|deg)?", re.I)
_JOINT = re.compile(r"\bJ\d\s*=")
_UNITS = {"X": "mm", "Y": "mm", "Z": "mm", "W": "deg", "P": "deg", "R": "deg"}


class FanucProgram:
    """The section /POS of a program."""

    key = "fanuc-ls"
    name = "Fanuc program (.ls)"
    form = "the section /POS: P[n] with X, Y, Z in mm and W, P, R in deg, about the fixed x, y, z"
    cannot_say = "joint positions are not converted: have the controller write them as positions"

    def recognises(self, document: PoseDocument) -> bool:
        """By /PROG and /POS."""
        return "/POS" in document.text and ("/PROG" in document.text or bool(_POSITION.search(document.text)))

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses of the only motion group."""
        if conventions.unit not in (None, "mm") or conventions.angle not in (None, "deg"):
            raise document.error("the file states its units, mm and deg", key="--unit, --angle", hint="leave them out")
        text = document.text[document.text.index("/POS") :]
        skipped = document.text[: document.text.index("/POS")].count("\n")
        names, poses, frames = [], [], set()
        for match in _POSITION.finditer(text):
            line = skipped + text.count("\n", 0, match.start()) + 1
            name = match[2].strip().strip('"') if match[2] and match[2].strip(' "') else f"P[{match[1]}]"
            groups = _GROUP.findall(match[3])
            if len(groups) > 1:
                raise document.error(
                    "a position moves several motion groups",
                    line=line,
                    got=", ".join(f"GP{group}" for group in groups),
                    expected="one group, the robot",
                )
            values = {}
            for axis, number, unit in _VALUE.findall(match[3]):
                axis = axis.upper()
                try:
                    values[axis] = float(number)
                except ValueError:
                    raise document.error("not a number", line=line, key=axis, got=number) from None
                if unit and unit.lower() != _UNITS[axis]:
                    raise document.error("another unit", line=line, key=axis, got=unit, expected=_UNITS[axis])
            if _JOINT.search(match[3]) or values.keys() != _UNITS.keys():
                raise document.error(
                    "not a position X, Y, Z, W, P, R",
                    line=line,
                    got=" ".join(match[3].split())[:80],
                    hint="have the controller write joint positions as positions",
                )
            if not np.isfinite(list(values.values())).all() or max(map(abs, values.values())) > 1e7:
                raise document.error("no position and no angle is so large", line=line, got=str(values))
            frames.update(re.findall(r"\bU[FT]\s*:\s*\w+", match[3]))
            turn = rotation_matrices("fixed-xyz", np.radians([[values[axis] for axis in "WPR"]]))[0]
            poses.append(rigid(document, line, [values[axis] for axis in "XYZ"], turn))
            names.append(name)
        if not poses:
            raise document.error("the section /POS has no position", expected="P[1]{ ... X = ... mm, ... };")
        said = ", ".join(sorted(" ".join(frame.split()) for frame in frames)) or "frames not named"
        return PoseFile(
            self.name, tuple(names), np.array(poses), (f"W, P, R about the fixed x, y, z; mm, deg; {said}",)
        )
