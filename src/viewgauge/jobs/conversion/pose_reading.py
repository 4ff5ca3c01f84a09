"""A file of poses alone, as ``characterize`` meets it: what was read, and a stated covariance written for a plan."""

from __future__ import annotations

import hashlib
from os import PathLike
from pathlib import Path

import numpy as np

from ...exceptions import InputError
from ...findings import Finding
from ...formats.poses.board_views_file import is_board_file
from ...formats.poses.covariance_file import write_covariance
from ...formats.poses.hand_eye.hand_eye_formats import is_hand_eye_file
from ...formats.poses.pose_file import PoseConventions, PoseFile
from ...formats.poses.pose_formats import is_pose_file, read_poses

__all__ = ["covariance_findings", "read_poses_alone", "write_stated_covariance"]

_SAME = 1e-6


def read_poses_alone(path: str | PathLike[str], conventions: PoseConventions | None = None) -> PoseFile | None:
    """The poses of a file that holds poses alone; None where it holds samples of a pose error, or nothing known.

    Raises
    ------
    InputError
        If the file cannot be read or does not say what its numbers mean.
    """
    file = Path(path)
    if is_board_file(file) or is_hand_eye_file(file) or not is_pose_file(file):
        return None
    return read_poses(file, conventions)


def covariance_findings(poses: PoseFile) -> tuple[Finding, ...]:
    """Whether a stated covariance depends on the frame's axes, which turn with the camera in a plan."""
    if poses.covariance is None:
        return ()
    turn = np.kron(np.eye(2), poses.poses[0][:3, :3].T)
    turned = turn @ poses.covariance @ turn.T
    if np.abs(turned - poses.covariance).max() <= _SAME * np.abs(poses.covariance).max():
        return ()
    return (
        Finding(
            "covariance_axes",
            "the covariance is stated along the axes of a fixed frame, and a plan takes it along those of "
            "pose_uncertainty.frame, which move with the camera",
            "a covariance along axes of the camera or of the flange",
        ),
    )


def write_stated_covariance(poses: PoseFile, source: str | PathLike[str], path: str | PathLike[str]) -> None:
    """Write the covariance that a file states, without degrees of freedom.

    Raises
    ------
    InputError
        If the file states none.
    """
    if poses.covariance is None:
        raise InputError(
            "the file holds poses alone: no pose uncertainty can be written",
            file=source,
            got=f"{len(poses.names)} poses ({poses.format})",
            expected="commanded poses with measured ones, repeated visits, errors, pairs, or images of a board",
            hint="viewgauge convert writes the poses as viewpoints",
        )
    digest = hashlib.sha256(Path(source).read_bytes()).hexdigest()
    write_covariance(path, poses.covariance, None, np.zeros(6), {Path(source).name: digest})
