"""The section ``target_finder`` of a file of board images: which target, and of which size (m)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...exceptions import InputError
from ...measurement.pose.board import Board, Target
from ...measurement.pose.targets.chessboard import Chessboard
from ...measurement.pose.targets.circle_grid import CircleGrid
from ...measurement.pose.targets.tag_grid import TagGrid

__all__ = ["TARGETS", "TargetKind", "read_target"]


@dataclass(frozen=True)
class TargetKind:
    """A kind of target.

    Parameters
    ----------
    types
        Values of ``type``; the first is written, the others are of other programs.
    needed, optional
        Its keys: numbers, but ``dictionary`` and those that only tune another program's detector.
    """

    types: tuple[str, ...]
    needed: tuple[str, ...]
    optional: tuple[str, ...]
    build: Callable[[Mapping[str, Any]], Target]

    @property
    def form(self) -> str:
        """Keys in words."""
        return f"{self.types[0]}: {', '.join(self.needed)} (m)"


def _circles(pattern: Any) -> Callable[[Mapping[str, Any]], Target]:
    def build(value: Mapping[str, Any]) -> Target:
        detector = value.get("circle_detector_params")
        areas = detector if isinstance(detector, dict) and detector.get("filterByArea") is True else {}
        sizes = {"smallest_px": areas.get("minArea", 20.0), "largest_px": areas.get("maxArea", 20_000.0)}
        return CircleGrid(int(value["cols"]), int(value["rows"]), 1e3 * value["spacing"], pattern, **sizes)

    return build


TARGETS: tuple[TargetKind, ...] = (
    TargetKind(
        ("CharucoGridTargetFinder", "CharucoGridBoardTargetFinder"),
        ("rows", "cols", "chessboard_dim", "aruco_marker_dim"),
        ("dictionary",),
        lambda v: Board(
            int(v["cols"]),
            int(v["rows"]),
            1e3 * v["chessboard_dim"],
            1e3 * v["aruco_marker_dim"],
            v.get("dictionary", 10),
        ),
    ),
    TargetKind(
        ("ChessboardTargetFinder",),
        ("rows", "cols", "chessboard_dim"),
        (),
        lambda v: Chessboard(int(v["cols"]), int(v["rows"]), 1e3 * v["chessboard_dim"]),
    ),
    TargetKind(
        ("ModifiedCircleGridTargetFinder",),
        ("rows", "cols", "spacing"),
        ("circle_detector_params",),
        _circles("marked"),
    ),
    TargetKind(
        ("CircleGridTargetFinder",), ("rows", "cols", "spacing"), ("circle_detector_params",), _circles("symmetric")
    ),
    TargetKind(
        ("AsymmetricCircleGridTargetFinder",),
        ("rows", "cols", "spacing"),
        ("circle_detector_params",),
        _circles("asymmetric"),
    ),
    TargetKind(
        ("AprilTagGridTargetFinder", "ArucoGridTargetFinder", "ArucoGridBoardTargetFinder"),
        ("rows", "cols", "aruco_marker_dim", "gap"),
        ("dictionary",),
        lambda v: TagGrid(
            int(v["cols"]),
            int(v["rows"]),
            1e3 * v["aruco_marker_dim"],
            1e3 * v["gap"],
            v.get("dictionary", "DICT_APRILTAG_36h11"),
        ),
    ),
)
"""Kinds of targets; without ``type`` the first whose keys are those of the section."""


def read_target(path: Path, value: object, line: int | None) -> Target:
    """The target of a section.

    Raises
    ------
    InputError
        If its kind is not known, or a key is missing, wrong or not used.
    """
    place: dict[str, Any] = {"file": path, "line": line, "key": "target_finder"}
    if not isinstance(value, dict):
        raise InputError("not a target", **place, expected="; ".join(kind.form for kind in TARGETS))
    given = set(value) - {"type"}
    said = value.get("type")
    if said is not None:
        kinds = [kind for kind in TARGETS if said in kind.types]
    else:
        kinds = [kind for kind in TARGETS if set(kind.needed) <= given <= {*kind.needed, *kind.optional}]
        if len(kinds) > 1:
            kinds = [kind for kind in kinds if kind.types[0] != "ModifiedCircleGridTargetFinder"]
            types = " or ".join(kind.types[0] for kind in TARGETS if "spacing" in kind.needed)
            if "spacing" in given:
                raise InputError("the file does not say which grid of circles", **place, expected=f"type: {types}")
    if not kinds:
        got = said or ", ".join(sorted(given))
        expected = "; ".join(kind.form for kind in TARGETS)
        raise InputError("not a ChArUco board or another known target", **place, got=got, expected=expected)
    kind = kinds[0]
    wrong = [name for name in kind.needed if not _is_positive(value.get(name), whole=name in ("rows", "cols"))]
    if wrong:
        problem = "not a ChArUco board" if kind is TARGETS[0] else f"not a target of type {kind.types[0]}"
        got = ", ".join(f"{name}: {value.get(name)}" for name in wrong)
        raise InputError(problem, **place, got=got, expected=kind.form)
    left = given - {*kind.needed, *kind.optional}
    if left:
        raise InputError("a key is not used", **place, got=", ".join(sorted(left)), expected=kind.form)
    return kind.build(value)


def _is_positive(value: object, whole: bool) -> bool:
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        return False
    return 0 < value < 1e3 and (not whole or float(value).is_integer())
