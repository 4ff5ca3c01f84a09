"""From samples of a pose error to the covariance file that a plan reads."""

from __future__ import annotations

import hashlib
from collections.abc import Collection
from os import PathLike
from pathlib import Path

from ..exceptions import InputError
from ..execution.progress import Progress, Silent
from ..formats.cameras.camera_file import CameraFile
from ..formats.cameras.opencv import write_opencv_camera
from ..formats.poses.covariance_file import write_covariance
from ..formats.poses.pose_file import PoseConventions
from ..geometry import Lens
from ..measurement import estimate_pose_error
from .characterization.character import BoardCalibration, Characterization, HandEye, describe_characterization
from .characterization.sources import InHand, read_source

__all__ = [
    "BoardCalibration",
    "Characterization",
    "HandEye",
    "characterize",
    "describe_characterization",
    "write_calibration",
    "write_covariance_of",
]


def characterize(
    samples: str | PathLike[str],
    *,
    progress: Progress | None = None,
    conventions: PoseConventions | None = None,
    in_hand: InHand | None = None,
    accept: Collection[str] = (),
) -> Characterization:
    """Covariance, mean, confidence and normality of a pose error.

    Of images of a board the error of each view is that of a calibration of camera and robot which has not seen it.

    Parameters
    ----------
    samples
        File of samples (:mod:`~viewgauge.formats.poses.pose_samples_file`): poses commanded and measured, repeated
        visits, errors, or joints and measured poses; of images of a board and robot poses
        (:mod:`~viewgauge.formats.poses.board_views_file`); or of pairs of robot and board
        (:mod:`~viewgauge.formats.poses.hand_eye`).
    conventions
        What the names of the columns do not say of poses.
    in_hand
        What the robot carries, where the file does not say it.
    accept
        Names of findings that are meant so.

    Raises
    ------
    InputError
        If the file cannot be used, has too few samples, or is refused as implausible.
    """
    path = Path(samples)
    source = read_source(path, progress or Silent(), conventions, in_hand, accept)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    pose_error = estimate_pose_error(source.file.samples, source.file.groups)
    return Characterization(
        pose_error,
        len(source.file.samples.errors),
        source.file.kind,
        {path.name: digest},
        source.board,
        source.hand_eye,
        source.findings,
    )


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
