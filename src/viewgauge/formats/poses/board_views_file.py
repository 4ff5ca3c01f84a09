"""Robot poses and images of a calibration board, as ROS-Industrial's ``industrial_calibration`` lists them (m, rad).

YAML with ``data`` (a list of ``image`` and ``pose`` files), ``target_finder`` (:mod:`.target_section`),
``static_camera`` (true where the robot carries the board) and, to start from, ``intrinsics`` (``fx, fy, cx, cy``, px).
In place of images and target there may be ``corners`` files (:mod:`.corner_list`) and ``resolution``. A pose file has
``x, y, z, qw, qx, qy, qz`` of the flange in the base frame.
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
from ...measurement.pose.board import Intrinsics, Target, find_corners, image_size
from ...measurement.pose.robot_calibration import BoardViews
from ..files.problems import Problems
from ..files.text import read_text
from ..files.yaml_tree import parse_yaml
from .corner_list import read_corners
from .target_section import read_target

__all__ = ["BoardFile", "is_board_file", "read_board_views"]

_TAKE_OUT = "take it out"
FEWEST_CORNERS = 8
"""The least number of corners of a view: fewer leave its pose too doubtful."""


_HARMLESS = (
    "homography_threshold camera_mount_to_camera_guess target_mount_to_target_guess use_extrinsic_guesses use_opencv"
)
"""Settings and first guesses of another program: found here without them."""
_KEYS = frozenset(("data", "target_finder", "static_camera", "intrinsics", "resolution"))


@dataclass(frozen=True)
class BoardFile:
    """What the file lists.

    Parameters
    ----------
    target
        None where corners are listed in place of images.
    intrinsics
        Those that the file states; None if none.
    left_out
        Views that are not used, with the reason.
    says_in_hand
        Whether it says what the robot carries.
    """

    views: BoardViews
    target: Target | None
    intrinsics: Intrinsics | None
    left_out: tuple[str, ...]
    says_in_hand: bool


def is_board_file(path: Path) -> bool:
    """Whether a YAML file lists images of a board, or of corners of one."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        return False
    tree = parse_yaml(read_text(path, InputError), Problems(path))
    return (
        isinstance(tree.value, dict)
        and "data" in tree.value
        and bool({"target_finder", "resolution"} & set(tree.value))
    )


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
    left = [key for key in value if key not in _KEYS and key not in _HARMLESS.split()]
    if left:
        raise InputError(
            "a key is not used", file=path, line=lines.get((left[0],)), key=", ".join(left), hint=_TAKE_OUT
        )
    target = None
    if "target_finder" in value:
        target = read_target(path, value["target_finder"], lines.get(("target_finder",)))
    entries = value.get("data")
    if not isinstance(entries, list) or not entries:
        raise InputError("no views", file=path, key="data", expected="a list of image and pose files")
    gathered, size = _Gathered([], [], [], [], []), _resolution(path, value.get("resolution"))
    for k, entry in enumerate(entries):
        size = _add_view(gathered, path, k, entry, lines.get(("data", k)), target, size)
    if not gathered.names or size is None:
        raise InputError(
            "the board is found in no image",
            file=path,
            key="target_finder",
            got="; ".join(gathered.left_out[:3]),
            hint="check the board: rows and cols count the squares of a chessboard, the dots of a grid",
        )
    carried: Literal["camera", "board"] = "board" if value.get("static_camera") is True else "camera"
    views = BoardViews(
        tuple(gathered.names),
        np.array(gathered.poses),
        tuple(gathered.points),
        tuple(gathered.places),
        size,
        in_hand or carried,
    )
    says = in_hand is not None or isinstance(value.get("static_camera"), bool)
    intrinsics = _intrinsics(path, value.get("intrinsics"), lines)
    return BoardFile(views, target, intrinsics, tuple(gathered.left_out), says)


@dataclass
class _Gathered:
    """Views so far."""

    names: list[str]
    poses: list[NDArray[np.float64]]
    points: list[NDArray[np.float64]]
    places: list[NDArray[np.float64]]
    left_out: list[str]


def _add_view(
    gathered: _Gathered,
    path: Path,
    k: int,
    entry: object,
    line: int | None,
    target: Target | None,
    size: tuple[int, int] | None,
) -> tuple[int, int] | None:
    """Add a view, or the reason why it is left out; the size of the images."""
    keys = ("image", "pose") if target is not None else ("corners", "pose")
    if not isinstance(entry, dict) or not all(isinstance(entry.get(key), str) for key in keys) or len(entry) != 2:
        raise InputError("not a view", file=path, line=line, key=f"data[{k}]", expected=f"{keys[0]} and pose files")
    name = entry[keys[0]]
    if target is None:
        points, found = read_corners(path.parent / name)
    else:
        ids, found = find_corners(path.parent / name, target)
        points = target.points_mm[ids]
        if len(ids):
            this = image_size(path.parent / name)
            if size is not None and this != size:
                got = f"{this[0]} x {this[1]}, {size[0]} x {size[1]} before"
                raise InputError("the images are not of one size", file=path.parent / name, got=got)
            size = this
    if len(points) < FEWEST_CORNERS:
        gathered.left_out.append(f"{name}: {len(points)} corners found")
        return size
    gathered.names.append(name)
    gathered.poses.append(_pose(path.parent / entry["pose"]))
    gathered.points.append(points)
    gathered.places.append(found)
    return size


def _resolution(path: Path, value: object) -> tuple[int, int] | None:
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 2 or not all(_is_number(v) and v > 0 for v in value):
        raise InputError("not a resolution", file=path, key="resolution", got=value, expected="[columns, rows]")
    return int(value[0]), int(value[1])


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
    if not all(_is_number(value.get(key)) for key in keys) or len(value) != len(keys):
        raise InputError("not a pose", file=path, got=", ".join(value), expected="x, y, z (m), qw, qx, qy, qz")
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
