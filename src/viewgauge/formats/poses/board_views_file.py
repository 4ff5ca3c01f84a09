"""Robot poses and images of a calibration board, as ROS-Industrial's ``industrial_calibration`` lists them (m, rad).

YAML with ``data`` (a list of ``image`` and ``pose`` files), ``target_finder`` (``rows``, ``cols``, ``chessboard_dim``,
``aruco_marker_dim``, ``dictionary`` of a ChArUco board), ``static_camera`` (true where the robot carries the board)
and, to start from, ``intrinsics`` (``fx, fy, cx, cy``, px). A pose file has ``x, y, z, qw, qx, qy, qz`` of the
flange in the base frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import pose_from_quaternion
from ...measurement.pose.board import Board, Intrinsics, find_corners, image_size
from ...measurement.pose.robot_calibration import BoardViews
from ..files.problems import Problems
from ..files.text import read_text
from ..files.yaml_tree import parse_yaml

__all__ = ["BoardFile", "is_board_file", "read_board_views"]

FEWEST_CORNERS = 8
"""The least number of corners of a view: fewer leave its pose too doubtful."""


@dataclass(frozen=True)
class BoardFile:
    """The views, the intrinsics that the file states (None if none), and views left out, with the reason."""

    views: BoardViews
    intrinsics: Intrinsics | None
    left_out: tuple[str, ...]
    pitch_mm: float


def is_board_file(path: Path) -> bool:
    """Whether a YAML file lists images of a board."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        return False
    problems = Problems(path)
    tree = parse_yaml(read_text(path, InputError), problems)
    return isinstance(tree.value, dict) and {"data", "target_finder"} <= tree.value.keys()


def read_board_views(path: Path, in_hand: Literal["camera", "board"] | None = None) -> BoardFile:
    """Corners in the images, and the robot's poses.

    Parameters
    ----------
    in_hand
        What the robot carries, where the file does not say it.

    Raises
    ------
    InputError
        If a file is missing or wrong, with its name and line; or OpenCV is not installed.
    """
    value, lines = _tree(path)
    finder = value.get("target_finder")
    expected = "rows, cols, chessboard_dim, aruco_marker_dim (m), dictionary"
    names = ("rows", "cols", "chessboard_dim", "aruco_marker_dim")
    if not isinstance(finder, dict) or not all(_is_number(finder.get(name)) for name in names):
        line = lines.get(("target_finder",))
        raise InputError("not a ChArUco board", file=path, line=line, key="target_finder", expected=expected)
    board = Board(
        int(finder["cols"]),
        int(finder["rows"]),
        1e3 * finder["chessboard_dim"],
        1e3 * finder["aruco_marker_dim"],
        finder.get("dictionary", 10),
    )
    entries = value.get("data")
    if not isinstance(entries, list) or not entries:
        raise InputError("no views", file=path, key="data", expected="a list of image and pose files")
    names_, poses, points, places, left_out = [], [], [], [], []
    size: tuple[int, int] | None = None
    for k, entry in enumerate(entries):
        line = lines.get(("data", k))
        if not isinstance(entry, dict) or not all(isinstance(entry.get(key), str) for key in ("image", "pose")):
            raise InputError("not a view", file=path, line=line, key=f"data[{k}]", expected="image and pose files")
        image = path.parent / entry["image"]
        ids, found = find_corners(image, board)
        if len(ids) < FEWEST_CORNERS:
            left_out.append(f"{entry['image']}: {len(ids)} corners found")
            continue
        this = image_size(image)
        if size is not None and this != size:
            got = f"{this[0]} x {this[1]}, {size[0]} x {size[1]} before"
            raise InputError("the images are not of one size", file=image, got=got)
        size = this
        names_.append(entry["image"])
        poses.append(_pose(path.parent / entry["pose"]))
        points.append(board.points_mm[ids])
        places.append(found)
    if size is None:
        raise InputError("the board is found in no image", file=path, key="target_finder", hint="check the board")
    views = BoardViews(
        tuple(names_),
        np.array(poses),
        tuple(points),
        tuple(places),
        size,
        in_hand or ("board" if value.get("static_camera") is True else "camera"),
    )
    return BoardFile(views, _intrinsics(path, value.get("intrinsics"), lines), tuple(left_out), board.square_mm)


def _tree(path: Path) -> tuple[dict[str, Any], dict[Any, int]]:
    problems = Problems(path)
    tree = parse_yaml(read_text(path, InputError), problems)
    problems.raise_if_any()
    if not isinstance(tree.value, dict):
        raise InputError("not a mapping of keys to values", file=path)
    return tree.value, tree.lines


def _pose(path: Path) -> NDArray[np.float64]:
    value, _ = _tree(path)
    keys = ("x", "y", "z", "qw", "qx", "qy", "qz")
    if not all(_is_number(value.get(key)) for key in keys):
        raise InputError("not a pose", file=path, expected="x, y, z (m), qw, qx, qy, qz")
    try:
        return pose_from_quaternion([1e3 * value[key] for key in "xyz"], [value[key] for key in keys[3:]])
    except InputError as error:
        raise InputError(error.problem, file=path, got=error.got, hint=error.hint) from error


def _intrinsics(path: Path, value: object, lines: dict[Any, int]) -> Intrinsics | None:
    if value is None:
        return None
    keys = ("fx", "fy", "cx", "cy")
    if not isinstance(value, dict) or not all(_is_number(value.get(key)) for key in keys):
        line = lines.get(("intrinsics",))
        raise InputError("not intrinsics", file=path, line=line, key="intrinsics", expected="fx, fy, cx, cy (px)")
    fx, fy, cx, cy = (float(value[key]) for key in keys)
    return Intrinsics(np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]), np.zeros(5))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
