"""ROS messages as ``topic echo`` prints them: Pose, PoseStamped, PoseWithCovariance, TransformStamped (m, rad)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....exceptions import InputError
from ....geometry import pose_from_quaternion
from ..pose_file import PoseConventions, PoseDocument, PoseFile
from ..pose_meaning import ask, length_unit, to_mm

__all__ = ["PoseMessages", "parts_of_pose", "pose_of_parts"]

_HARMLESS = frozenset(("header", "child_frame_id"))
_PAIRS = (("position", "orientation"), ("translation", "rotation"))


class PoseMessages:
    """YAML documents, each a message; ``---`` between them."""

    key = "ros"
    name = "ROS Pose, PoseStamped, PoseWithCovariance, TransformStamped (YAML)"
    form = "position and orientation (or translation and rotation) by name; m; a covariance of 36 numbers, m and rad"
    cannot_say = "whether the pose is the flange's or a camera's; the unit is asked for where metres are implausible"

    def recognises(self, document: PoseDocument) -> bool:
        """By position and orientation at the end of keys that messages have."""
        return bool(document.trees) and parts_of_pose(document.trees[0].value) is not None

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses, and the covariance where there is one message that has one."""
        names, poses, covariances, frames = [], [], [], set()
        for tree in document.trees:
            line = min(tree.lines.values(), default=None)
            value = tree.value
            found = parts_of_pose(value)
            if found is None or not isinstance(value, dict):
                raise document.error("not a message of a pose", line=line, expected="position and orientation")
            parts, covariance, left = found
            if left:
                raise document.error("a key is not used", line=line, key=", ".join(left), hint="take it out")
            header = value.get("header")
            header = header if isinstance(header, dict) else {}
            frames.add(str(header.get("frame_id", "")))
            poses.append(pose_of_parts(document, line, parts))
            names.append(_stamp(header.get("stamp")) or f"line {line}")
            if covariance is not None:
                covariances.append(_covariance(document, line, covariance))
        if len(set(names)) < len(names):
            names = [f"{name}/{k}" for k, name in enumerate(names, 1)]
        matrices = np.array(poses)
        if conventions.unit is None and (question := length_unit(matrices[:, :3, 3], "m")):
            raise ask(document, [question])
        unit = conventions.unit or "m"
        matrices[:, :3, 3] *= to_mm(unit)
        frame = next(iter(frames)) if len(frames) == 1 else ", ".join(sorted(frames))
        notes = [f"{unit}; in the frame {frame or 'that the file does not name'}"]
        covariance = None
        if covariances and all(np.array_equal(other, covariances[0]) for other in covariances):
            scale = np.array([to_mm(unit)] * 3 + [1.0] * 3)
            if covariances[0].any():
                covariance = covariances[0] * np.outer(scale, scale)
                notes.append(f"covariance along the axes of {frame or 'the fixed frame'}, as ROS states it")
            else:
                notes.append("the covariance is all 0, which says that it is not known: not used")
        elif covariances:
            raise document.error(
                "the messages have different covariances", expected="one covariance", hint="give one message"
            )
        return PoseFile(self.name, tuple(names), matrices, tuple(notes), covariance)


def pose_of_parts(document: PoseDocument, line: int | None, parts: tuple[object, object]) -> NDArray[np.float64]:
    """``(4, 4)``, length unit as written, of x, y, z and x, y, z, w by name; raises InputError."""
    numbers = []
    for part, keys in zip(parts, ("xyz", "wxyz"), strict=True):
        value: Any = part
        if not isinstance(value, dict) or set(value) != set(keys):
            got = ", ".join(value) if isinstance(value, dict) else str(value)
            raise document.error("not a part of a pose", line=line, got=got[:80], expected=", ".join(keys))
        numbers.append([value[key] for key in keys])
        for key in keys:
            number = value[key]
            if not isinstance(number, int | float) or isinstance(number, bool) or not abs(number) < 1e7:
                raise document.error("not a finite number of a pose", line=line, key=key, got=str(number)[:40])
    try:
        return pose_from_quaternion(numbers[0], numbers[1])
    except InputError as error:
        raise document.error(error.problem, line=line, got=str(error.got), expected=error.expected) from error


def parts_of_pose(value: object) -> tuple[tuple[object, object], object, list[str]] | None:
    """Position and orientation, the covariance beside them, and keys that are not used; None where there is none."""
    covariance, left = None, list[str]()
    for _ in range(4):
        if not isinstance(value, dict):
            return None
        pair = next((pair for pair in _PAIRS if set(pair) <= value.keys()), None)
        inner = next((key for key in ("pose", "transform") if key in value), None)
        known = set(pair or ()) | {"covariance", inner or ""} | _HARMLESS
        left += [key for key in value if key not in known]
        covariance = value.get("covariance", covariance)
        if pair is not None:
            return (value[pair[0]], value[pair[1]]), covariance, left
        if inner is None:
            return None
        value = value[inner]
    return None


def _stamp(stamp: object) -> str:
    if not isinstance(stamp, dict):
        return ""
    seconds = stamp.get("sec", stamp.get("secs"))
    nanoseconds = stamp.get("nanosec", stamp.get("nsecs", 0))
    return f"{seconds}.{nanoseconds:09d}" if isinstance(seconds, int) and isinstance(nanoseconds, int) else ""


def _covariance(document: PoseDocument, line: int | None, value: object) -> NDArray[np.float64]:
    usable = isinstance(value, list) and len(value) == 36
    if not usable or not all(isinstance(v, int | float) and abs(v) < 1e12 for v in value):  # type: ignore[attr-defined]
        raise document.error("not a covariance", line=line, key="covariance", expected="36 finite numbers, m and rad")
    matrix = np.array(value, dtype=float).reshape(6, 6)
    scale = max(float(np.abs(matrix).max()), np.finfo(float).tiny)
    if np.abs(matrix - matrix.T).max() > 1e-9 * scale or np.linalg.eigvalsh(matrix).min() < -1e-9 * scale:
        raise document.error(
            "not a covariance", line=line, key="covariance", expected="a symmetric matrix without negative variances"
        )
    return matrix
