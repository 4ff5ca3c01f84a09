"""Calibration targets, the ChArUco board, and corners in an image (OpenCV, imported here only)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError

__all__ = [
    "Board",
    "Intrinsics",
    "Target",
    "board_pose",
    "find_corners",
    "fit_intrinsics",
    "image_size",
    "robot_world_hand_eye",
]


def opencv() -> Any:
    """OpenCV; raises InputError where it is not installed."""
    try:
        import cv2
    except ImportError as error:
        raise InputError(
            "OpenCV is not installed, which reads and writes images", hint='pip install "viewgauge[images]"'
        ) from error
    return cv2


def marker_dictionary(name: str | int) -> Any:
    """A dictionary of markers by OpenCV's name, such as ``DICT_6X6_250``, or number; raises TypeError or an error of
    OpenCV's for one that it does not have.
    """
    cv2 = opencv()
    number: Any = getattr(cv2.aruco, name, "unknown") if isinstance(name, str) else name
    return cv2.aruco.getPredefinedDictionary(number)


class Target(Protocol):
    """A calibration target."""

    @property
    def pitch_mm(self) -> float:
        """Distance of neighbours, for messages."""
        ...

    @property
    def points_mm(self) -> NDArray[np.float64]:
        """``(k, 3)``: points by their id, frame of the target, z = 0."""
        ...

    @property
    def symmetries(self) -> tuple[NDArray[np.int64], ...]:
        """For each turn that cannot be told from none in an image, the id that each point takes."""
        ...

    def find(self, grey: Any) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids ``(n,)`` and places ``(n, 2)`` px of its points in a grey image."""
        ...


@dataclass(frozen=True)
class Board:
    """A ChArUco board.

    Parameters
    ----------
    columns, rows
        Squares.
    square_mm, marker_mm
        Sides.
    dictionary
        Of the markers, by OpenCV's name, such as ``DICT_6X6_250``, or number.
    """

    columns: int
    rows: int
    square_mm: float
    marker_mm: float
    dictionary: str | int

    symmetries = ()

    @property
    def pitch_mm(self) -> float:
        """Of its corners."""
        return self.square_mm

    def find(self, grey: Any) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids and places px of the corners that are seen."""
        places, ids, _, _ = opencv().aruco.CharucoDetector(self._made).detectBoard(grey)
        if ids is None:
            return np.zeros(0, np.int64), np.zeros((0, 2))
        return ids.ravel().astype(np.int64), places.reshape(-1, 2).astype(float)

    @cached_property
    def points_mm(self) -> NDArray[np.float64]:
        """``(k, 3)``: inner corners by their id, board frame, z = 0."""
        return np.asarray(self._made.getChessboardCorners(), dtype=float)

    @cached_property
    def _made(self) -> Any:
        cv2 = opencv()
        try:
            markers = marker_dictionary(self.dictionary)
            return cv2.aruco.CharucoBoard((self.columns, self.rows), self.square_mm, self.marker_mm, markers)
        except (cv2.error, TypeError, SystemError) as error:
            raise InputError(
                "not a ChArUco board",
                key="board",
                got=f"{self.columns} x {self.rows}, {self.square_mm} and {self.marker_mm} mm, {self.dictionary}",
                expected="at least 3 x 3 squares, markers smaller than them, a dictionary such as DICT_6X6_250",
            ) from error


def find_corners(image: str | os.PathLike[str], board: Target) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Ids ``(n,)`` and places ``(n, 2)`` px (0 = centre of the first pixel) of a board's corners in an image.

    Raises
    ------
    InputError
        If the image cannot be read.
    """
    cv2 = opencv()
    if not Path(image).is_file():
        raise InputError("the file does not exist", file=image, hint="check the path")
    grey = cv2.imread(os.fspath(image), cv2.IMREAD_GRAYSCALE)
    if grey is None:
        raise InputError("the image cannot be read", file=image, expected="PNG, JPEG, TIFF or BMP")
    return board.find(grey)


def image_size(image: str | os.PathLike[str]) -> tuple[int, int]:
    """Columns and rows of an image that can be read."""
    rows, columns = opencv().imread(os.fspath(image), 0).shape[:2]
    return columns, rows


@dataclass(frozen=True)
class Intrinsics:
    """A camera as OpenCV has it.

    Parameters
    ----------
    matrix
        ``(3, 3)``: fx, fy, cx, cy, px.
    distortion
        ``(5,)``: k1, k2, p1, p2, k3.
    rms_px
        What fitting them left of the corners, px a coordinate; None where they were given.
    """

    matrix: NDArray[np.float64]
    distortion: NDArray[np.float64]
    rms_px: float | None = None

    def undistorted(self, places_px: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, 2)`` px: where a pinhole camera of the same matrix would see what was seen at places ``(n, 2)``."""
        cv2 = opencv()
        return np.asarray(
            cv2.undistortPoints(places_px.reshape(-1, 1, 2), self.matrix, self.distortion, P=self.matrix)
        ).reshape(-1, 2)


def fit_intrinsics(
    points_mm: Sequence[NDArray[np.float64]],
    places_px: Sequence[NDArray[np.float64]],
    resolution: tuple[int, int],
    start: Intrinsics | None = None,
) -> Intrinsics:
    """Intrinsics with distortion (k1, k2, p1, p2) from views of a board (Zhang 2000, by OpenCV)."""
    cv2 = opencv()
    flags, matrix, distortion = cv2.CALIB_FIX_K3, None, None
    if start is not None:
        flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        matrix, distortion = start.matrix.copy(), np.zeros(5)
    try:
        rms, matrix, distortion, _, _ = cv2.calibrateCamera(
            [p.astype(np.float32) for p in points_mm],
            [p.astype(np.float32) for p in places_px],
            resolution,
            matrix,
            distortion,
            flags=flags,
        )
    except cv2.error as error:
        raise InputError("no camera explains the corners", key="images", hint="more views, more turned") from error
    # OpenCV's rms is of distances; of coordinates it is smaller by the root of two
    return Intrinsics(np.asarray(matrix), np.asarray(distortion).ravel()[:5], float(rms) / np.sqrt(2))


def board_pose(
    points_mm: NDArray[np.float64], places_px: NDArray[np.float64], intrinsics: Intrinsics
) -> NDArray[np.float64]:
    """``T_camera_board`` ``(4, 4)`` mm from corners: of the two poses that a plane has, the one that leaves less."""
    cv2 = opencv()
    given = (points_mm, places_px, intrinsics.matrix, intrinsics.distortion)
    found, turn, shift = cv2.solvePnP(*given, flags=cv2.SOLVEPNP_IPPE)
    if not found:
        raise InputError("no pose explains the corners", key="corners", got=f"{len(points_mm)} corners")
    turn, shift = cv2.solvePnPRefineLM(*given, turn, shift)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = cv2.Rodrigues(turn)[0], shift.ravel()
    return T


def robot_world_hand_eye(
    T_base_flange: NDArray[np.float64], M: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A first X and Y ``(4, 4)`` with ``Y M_i = T_base_flange_i X`` for poses ``(n, 4, 4)`` (Shah 2013, by OpenCV)."""
    cv2 = opencv()
    A, B = np.linalg.inv(M), np.linalg.inv(T_base_flange)
    R_Y, t_Y, R_X, t_X = cv2.calibrateRobotWorldHandEye(
        list(A[:, :3, :3]),
        list(A[:, :3, 3]),
        list(B[:, :3, :3]),
        list(B[:, :3, 3]),
        method=cv2.CALIB_ROBOT_WORLD_HAND_EYE_SHAH,
    )
    inverse_X, inverse_Y = np.eye(4), np.eye(4)
    inverse_X[:3, :3], inverse_X[:3, 3] = R_X, t_X.ravel()
    inverse_Y[:3, :3], inverse_Y[:3, 3] = R_Y, t_Y.ravel()
    return np.asarray(np.linalg.inv(inverse_X), dtype=float), np.asarray(np.linalg.inv(inverse_Y), dtype=float)
