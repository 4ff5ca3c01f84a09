"""Samples of MoveIt's hand-eye calibration: pairs of 4x4 matrices, row by row (m)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kinds.matrix_rows import poses_of_matrices
from ..pose_file import PoseConventions, PoseDocument
from .hand_eye_file import HandEyeFile

__all__ = ["MatrixPairs"]

_KEYS = ("effector_wrt_world", "object_wrt_sensor")


class MatrixPairs:
    """A list of ``effector_wrt_world`` and ``object_wrt_sensor``."""

    name = "MoveIt hand-eye samples (YAML)"
    form = "a list of effector_wrt_world and object_wrt_sensor, each 16 numbers, row by row; m"
    cannot_say = "what the robot carries: found by trying both, or --in-hand camera or board"

    def recognises(self, document: PoseDocument) -> bool:
        """By the keys of the first pair."""
        value = document.trees[0].value if document.trees else None
        return isinstance(value, list) and bool(value) and isinstance(value[0], dict) and _KEYS[0] in value[0]

    def read(self, document: PoseDocument) -> HandEyeFile:
        """The pairs."""
        value, lines = document.trees[0].value, document.trees[0].lines
        assert isinstance(value, list)
        rows: dict[str, list[NDArray[np.float64]]] = {key: [] for key in _KEYS}
        for k, pair in enumerate(value):
            line = lines.get((k,))
            if not isinstance(pair, dict) or set(pair) != set(_KEYS):
                got = ", ".join(map(str, pair))[:80] if isinstance(pair, dict) else str(pair)[:80]
                raise document.error("not a pair of matrices", line=line, got=got, expected=" and ".join(_KEYS))
            for key in _KEYS:
                rows[key].append(_matrix(document, line, key, pair[key]))
        at = tuple(lines.get((k,), 1) for k in range(len(value)))
        meant = PoseConventions(unit="m")
        robot, board = (poses_of_matrices(document, at, np.array(rows[key]), meant)[0] for key in _KEYS)
        return HandEyeFile(self.name, robot, board, None, tuple(f"sample {k + 1}" for k in range(len(value))))


def _matrix(document: PoseDocument, line: int | None, key: str, value: object) -> NDArray[np.float64]:
    flat = value if isinstance(value, list) else []
    if len(flat) == 4 and all(isinstance(row, list) for row in flat):
        flat = [number for row in flat for number in row]
    usable = all(isinstance(v, int | float) and not isinstance(v, bool) and abs(v) < 1e7 for v in flat)
    if len(flat) != 16 or not usable:
        raise document.error("not 16 finite numbers", line=line, key=key, got=str(value)[:60])
    return np.array(flat, dtype=float).reshape(4, 4)
