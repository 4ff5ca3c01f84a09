"""Samples of easy_handeye: each a robot's transform and a board's, by name (m)."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..kinds.pose_message import parts_of_pose, pose_of_parts
from ..pose_file import PoseDocument
from .hand_eye_file import HandEyeFile

__all__ = ["TransformPairs"]

_BOARD = ("tracking", "optical", "marker", "board", "target")
_PARAMETERS = (
    "calibration_type eye_on_hand name robot_base_frame robot_effector_frame tracking_base_frame tracking_marker_frame "
    "freehand_robot_movement move_group move_group_namespace namespace"
)
_TYPES: dict[str, Literal["camera", "board"]] = {
    "eye_in_hand": "camera",
    "eye_on_hand": "camera",
    "eye_on_base": "board",
    "eye_to_hand": "board",
}


class TransformPairs:
    """``samples`` with ``robot`` and ``tracking`` (or ``optical``), and ``parameters`` that say what is in the hand."""

    name = "easy_handeye samples (YAML)"
    form = "samples: robot and tracking (or optical), each translation and rotation by name; m; parameters beside them"
    cannot_say = "what the robot carries, where parameters.calibration_type is absent: --in-hand camera or board"

    def recognises(self, document: PoseDocument) -> bool:
        """By samples of a robot's transform."""
        samples = _samples(document)
        return bool(samples) and isinstance(samples[0], dict) and "robot" in samples[0]

    def read(self, document: PoseDocument) -> HandEyeFile:
        """The pairs."""
        value, lines = document.trees[0].value, document.trees[0].lines
        top: dict[str, Any] = value if isinstance(value, dict) else {}
        left = [key for key in top if key not in ("parameters", "samples")]
        parameters = top.get("parameters") or {}
        if not isinstance(parameters, dict):
            raise document.error("not parameters", line=lines.get(("parameters",)), got=str(parameters)[:60])
        left += [f"parameters.{key}" for key in parameters if key not in _PARAMETERS.split()]
        if left:
            raise document.error("a key is not used", key=", ".join(left), hint="take it out")
        robot, board, names = [], [], []
        for k, sample in enumerate(_samples(document)):
            line = next((lines[path] for path in ((k,), ("samples", k)) if path in lines), None)
            keys = [] if not isinstance(sample, dict) else [key for key in _BOARD if key in sample]
            if not isinstance(sample, dict) or "robot" not in sample or len(keys) != 1 or len(sample) != 2:
                got = ", ".join(sample) if isinstance(sample, dict) else str(sample)[:60]
                expected = f"robot and one of {', '.join(_BOARD)}"
                raise document.error("not a pair of transforms", line=line, got=got, expected=expected)
            robot.append(_transform(document, line, sample["robot"]))
            board.append(_transform(document, line, sample[keys[0]]))
            names.append(f"sample {k + 1}")
        return HandEyeFile(self.name, np.array(robot), np.array(board), _in_hand(document, parameters), tuple(names))


def _samples(document: PoseDocument) -> list[Any]:
    value = document.trees[0].value if document.trees else None
    samples = value.get("samples") if isinstance(value, dict) else value
    return samples if isinstance(samples, list) else []


def _transform(document: PoseDocument, line: int | None, value: object) -> NDArray[np.float64]:
    found = parts_of_pose(value)
    if found is None:
        raise document.error("not a transform", line=line, got=str(value)[:60], expected="translation and rotation")
    parts, _, left = found
    if left:
        raise document.error("a key is not used", line=line, key=", ".join(left), hint="take it out")
    pose = pose_of_parts(document, line, parts)
    pose[:3, 3] *= 1e3
    return pose


def _in_hand(document: PoseDocument, parameters: dict[str, Any]) -> Literal["camera", "board"] | None:
    said = parameters.get("calibration_type")
    flag = parameters.get("eye_on_hand")
    if said is not None and str(said) not in _TYPES:
        expected = ", ".join(_TYPES)
        raise document.error("unknown type of calibration", key="calibration_type", got=str(said), expected=expected)
    if said is None and flag is None:
        return None
    by_flag: Literal["camera", "board"] | None = None if flag is None else "camera" if flag is True else "board"
    by_type = None if said is None else _TYPES[str(said)]
    if by_flag and by_type and by_flag != by_type:
        raise document.error("two keys contradict each other", key="calibration_type, eye_on_hand")
    return by_type or by_flag
