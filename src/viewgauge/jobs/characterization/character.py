"""The results of a characterization, and as JSON-ready data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...findings import Finding
from ...geometry import invert, quaternion_from_pose
from ...measurement import PoseErrorEstimate, small_sample_factor
from ...measurement.pose.board import Intrinsics
from ...measurement.pose.robot_calibration import RobotCalibration

__all__ = ["BoardCalibration", "Characterization", "HandEye", "describe_characterization"]

_INTRINSICS = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")
_AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class HandEye:
    """Where the camera and the board are.

    Parameters
    ----------
    robot
        X and Y: with the camera in hand its pose on the flange, and the board's in the base frame; with the board in
        hand its pose on the flange, and the camera's in the base frame.
    camera_in_hand
        Else the robot carries the board.
    left_out
        Views that were not used, with the reason.
    """

    robot: RobotCalibration
    camera_in_hand: bool
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True)
class BoardCalibration:
    """The camera that images of a board give beside the pose errors, by all views together.

    Parameters
    ----------
    camera, resolution
        Its intrinsics, and the columns and rows of the images.
    camera_covariance
        ``(8, 8)`` of fx, fy, cx, cy, px, and k1, k2, p1, p2.
    """

    camera: Intrinsics
    resolution: tuple[int, int]
    camera_covariance: NDArray[np.float64]
    hand_eye: HandEye

    @property
    def robot(self) -> RobotCalibration:
        """X and Y."""
        return self.hand_eye.robot

    @property
    def left_out(self) -> tuple[str, ...]:
        """Views that were not used, with the reason."""
        return self.hand_eye.left_out


@dataclass(frozen=True)
class Characterization:
    """How well a camera pose is held, from how many samples of which kind.

    Parameters
    ----------
    inputs
        SHA-256 of the file, by its name.
    hand_eye, board
        Where samples were pairs of poses or images of a board, and where they were images.
    findings
        What is implausible and was not accepted, to be shown.
    """

    pose_error: PoseErrorEstimate
    samples: int
    kind: str
    inputs: dict[str, str]
    board: BoardCalibration | None = None
    hand_eye: HandEye | None = None
    findings: tuple[Finding, ...] = ()


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
        "hand_eye": None if character.hand_eye is None else _hand_eye_document(character.hand_eye),
        "board": None if character.board is None else _board_document(character.board),
        "findings": [finding.document() for finding in character.findings],
    }


def _hand_eye_document(hand_eye: HandEye) -> dict[str, Any]:
    """With the camera in hand the flange in the camera frame is the frame that the covariance belongs to."""
    names = ("camera_on_flange", "board_in_base") if hand_eye.camera_in_hand else ("board_on_flange", "camera_in_base")
    poses = dict(zip(names, (hand_eye.robot.X, hand_eye.robot.Y), strict=True))
    return {
        "in_hand": "camera" if hand_eye.camera_in_hand else "board",
        **{name: {**_placed(pose), "matrix": pose.tolist()} for name, pose in poses.items()},
        "frame": _placed(invert(hand_eye.robot.X)) if hand_eye.camera_in_hand else None,
        "left_out": list(hand_eye.left_out),
    }


def _board_document(board: BoardCalibration) -> dict[str, Any]:
    hand_eye = board.hand_eye
    return {
        "camera_matrix_px": board.camera.matrix.tolist(),
        "distortion": board.camera.distortion.tolist(),
        "standard_uncertainty": dict(
            zip(_INTRINSICS, np.sqrt(board.camera_covariance.diagonal()).tolist(), strict=True)
        ),
        "rms_px": board.camera.rms_px,
        "in_hand": "camera" if hand_eye.camera_in_hand else "board",
        "X": board.robot.X.tolist(),
        "Y": board.robot.Y.tolist(),
        "left_out": list(board.left_out),
    }


def _placed(pose: NDArray[np.float64]) -> dict[str, list[float]]:
    return {"position_mm": pose[:3, 3].tolist(), "quaternion": quaternion_from_pose(pose).tolist()}


def _safe(deviation: np.ndarray) -> np.ndarray:
    return np.where(deviation > 0, deviation, 1.0)
