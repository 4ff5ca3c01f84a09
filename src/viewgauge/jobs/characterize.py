"""From samples of a pose error to the covariance file that a plan reads."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from ..execution.progress import Progress, Silent
from ..formats.cameras.camera_file import CameraFile
from ..formats.cameras.opencv import write_opencv_camera
from ..formats.poses.board_views_file import is_board_file, read_board_views
from ..formats.poses.covariance_file import write_covariance
from ..formats.poses.pose_samples_file import SampleFile, read_pose_samples
from ..geometry import Lens, invert, quaternion_from_pose
from ..measurement import PoseErrorEstimate, PoseSamples, estimate_pose_error, small_sample_factor
from ..measurement.pose.board import Intrinsics
from ..measurement.pose.robot_calibration import RobotCalibration

__all__ = [
    "BoardCalibration",
    "Characterization",
    "characterize",
    "describe_characterization",
    "write_calibration",
    "write_covariance_of",
]

_INTRINSICS = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")
_AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Characterization:
    """How well a camera pose is held, from how many samples of which kind.

    Parameters
    ----------
    inputs
        SHA-256 of the file, by its name.
    """

    pose_error: PoseErrorEstimate
    samples: int
    kind: str
    inputs: dict[str, str]
    board: BoardCalibration | None = None


@dataclass(frozen=True)
class BoardCalibration:
    """What images of a board give beside the pose errors, by all views together.

    Parameters
    ----------
    camera, resolution
        Its intrinsics, and the columns and rows of the images.
    camera_covariance
        ``(8, 8)`` of fx, fy, cx, cy, px, and k1, k2, p1, p2.
    robot
        X and Y: with the camera in hand its pose on the flange, and the board's in the base frame.
    camera_in_hand
        Else the robot carries the board.
    left_out
        Views that were not used, with the reason.
    """

    camera: Intrinsics
    resolution: tuple[int, int]
    camera_covariance: NDArray[np.float64]
    robot: RobotCalibration
    camera_in_hand: bool
    left_out: tuple[str, ...]


def characterize(samples: str | PathLike[str], *, progress: Progress | None = None) -> Characterization:
    """Covariance, mean, confidence and normality of a pose error.

    Of images of a board the error of each view is that of a calibration of camera and robot which has not seen it.

    Parameters
    ----------
    samples
        File of samples (:mod:`~viewgauge.formats.poses.pose_samples_file`): poses commanded and measured, repeated
        visits, errors, or joints and measured poses; or of images of a board and robot poses
        (:mod:`~viewgauge.formats.poses.board_views_file`).

    Raises
    ------
    InputError
        If the file cannot be used, or has too few samples.
    """
    path, board = Path(samples), None
    if is_board_file(path):
        with (progress or Silent()).stage("Finding the board in the images, and calibrating without each"):
            file, board = _from_board(path)
    else:
        file = read_pose_samples(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    pose_error = estimate_pose_error(file.samples, file.groups)
    return Characterization(pose_error, len(file.samples.errors), file.kind, {path.name: digest}, board)


def _from_board(path: Path) -> tuple[SampleFile, BoardCalibration]:
    found = read_board_views(path)
    views, start = found.views, found.intrinsics
    every = list(range(len(views.names)))
    camera, robot = views.calibrated(every, start=start)
    errors = views.held_out([[k] for k in every], start=start)
    in_hand = views.in_hand == "camera"
    kind = f"views of a board, the {views.in_hand} in the robot's hand, each by a calibration without it"
    samples = PoseSamples(errors, views.names, parameters=12, noise=views.noise(camera, robot))
    covariance = views.intrinsics_covariance(camera)
    board = BoardCalibration(camera, views.resolution, covariance, robot, in_hand, found.left_out)
    return SampleFile(samples, kind), board


def write_covariance_of(character: Characterization, path: str | PathLike[str], *, with_mean: bool = False) -> None:
    """Write the covariance file that ``pose_uncertainty.covariance`` of an inspection names.

    Parameters
    ----------
    with_mean
        The systematic part is not taken away by calibration: it counts as if it were drawn anew (second moment about
        zero).
    """
    pose_error = character.pose_error
    covariance = pose_error.second_moment if with_mean else pose_error.covariance
    write_covariance(path, covariance, pose_error.degrees_of_freedom, pose_error.mean, character.inputs)


def write_calibration(character: Characterization, path: str | PathLike[str]) -> None:
    """Write the camera that images of a board gave, with its covariance, as OpenCV's YAML (``camera.calibration``).

    Raises
    ------
    InputError
        If the samples were not images of a board.
    """
    board = character.board
    if board is None:
        raise InputError(
            "there is no camera to write: the samples are not images of a board",
            key="--camera",
            got=character.kind,
            expected="a list of images of a board and robot poses",
        )
    (fx, _, cx), (_, fy, cy), _ = board.camera.matrix.tolist()
    lens = Lens("radial-tangential", tuple(board.camera.distortion[:4].tolist()))
    covariance = tuple(tuple(row) for row in board.camera_covariance.tolist())
    write_opencv_camera(path, CameraFile("OpenCV", (fx, fy), (cx, cy), lens, board.resolution, covariance))


def describe_characterization(character: Characterization) -> dict[str, Any]:
    """As JSON-ready data: mm and rad; what is not defined is null."""
    pose_error = character.pose_error
    return {
        "inputs": character.inputs,
        "kind": character.kind,
        "samples": character.samples,
        "degrees_of_freedom": pose_error.degrees_of_freedom,
        "covariance": pose_error.covariance.tolist(),
        "axes": [
            {
                "axis": axis,
                "standard_deviation": float(pose_error.deviation[k]),
                "standard_deviation_interval": pose_error.deviation_interval[k].tolist(),
                "mean": float(pose_error.mean[k]),
                "mean_interval": pose_error.mean_interval[k].tolist(),
                "normality_p": float(pose_error.normality[k]),
                "noise_share": None if pose_error.noise_share is None else float(pose_error.noise_share[k]),
            }
            for k, axis in enumerate(_AXES)
        ],
        "correlation": (
            pose_error.covariance / np.outer(_safe(pose_error.deviation), _safe(pose_error.deviation))
        ).tolist(),
        "skewness_p": None if np.isnan(pose_error.skewness_p) else pose_error.skewness_p,
        "kurtosis_p": None if np.isnan(pose_error.kurtosis_p) else pose_error.kurtosis_p,
        "outliers": list(pose_error.outliers),
        "factor_at_95": small_sample_factor(pose_error.degrees_of_freedom, 0.95),
        "board": None if character.board is None else _board_document(character.board),
    }


def _board_document(board: BoardCalibration) -> dict[str, Any]:
    """With the camera in hand the flange in the camera frame is the pivot that the covariance belongs to."""
    return {
        "camera_matrix_px": board.camera.matrix.tolist(),
        "distortion": board.camera.distortion.tolist(),
        "standard_uncertainty": dict(
            zip(_INTRINSICS, np.sqrt(board.camera_covariance.diagonal()).tolist(), strict=True)
        ),
        "rms_px": board.camera.rms_px,
        "in_hand": "camera" if board.camera_in_hand else "board",
        "X": board.robot.X.tolist(),
        "Y": board.robot.Y.tolist(),
        "pivot": _pivot(board) if board.camera_in_hand else None,
        "left_out": list(board.left_out),
    }


def _pivot(board: BoardCalibration) -> dict[str, list[float]]:
    T_camera_flange = invert(board.robot.X)
    return {
        "position_mm": T_camera_flange[:3, 3].tolist(),
        "quaternion": quaternion_from_pose(T_camera_flange).tolist(),
    }


def _safe(deviation: np.ndarray) -> np.ndarray:
    return np.where(deviation > 0, deviation, 1.0)
