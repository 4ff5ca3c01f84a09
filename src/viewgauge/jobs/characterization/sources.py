"""From a file to samples of the pose error: samples by themselves, images of a board, pairs of robot and board."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from ...exceptions import InputError
from ...execution.progress import Progress
from ...findings import Finding, admit
from ...formats.poses.board_views_file import is_board_file, read_board_views
from ...formats.poses.hand_eye.hand_eye_formats import is_hand_eye_file, read_hand_eye
from ...formats.poses.pose_file import PoseConventions
from ...formats.poses.pose_samples_file import SampleFile, read_pose_samples
from ...measurement import PoseSamples
from ...measurement.pose.board_orientation import oriented
from ...measurement.pose.hand_eye_findings import hand_eye_findings, likely_in_hand, seen_from_board
from ...measurement.pose.robot_calibration import calibrate_robot
from ...measurement.pose.sample_findings import error_findings
from .character import BoardCalibration, HandEye

__all__ = ["InHand", "Source", "read_source"]

InHand = Literal["camera", "board"]

_PARAMETERS = 12  # of X and Y


@dataclass(frozen=True)
class Source:
    """Samples, what else the file gave, and findings that are to be shown."""

    file: SampleFile
    board: BoardCalibration | None = None
    hand_eye: HandEye | None = None
    findings: tuple[Finding, ...] = ()


def read_source(
    path: Path, progress: Progress, conventions: PoseConventions | None, in_hand: InHand | None, accept: Collection[str]
) -> Source:
    """Samples of a file of any kind; raises InputError where it cannot be used or is refused as implausible."""
    if is_board_file(path):
        with progress.stage("Finding the board in the images, and calibrating without each"):
            source = _of_board(path, in_hand, accept)
    elif is_hand_eye_file(path):
        with progress.stage("Calibrating hand and eye"):
            source = _of_pairs(path, in_hand, accept)
    else:
        file = read_pose_samples(path, conventions)
        source = Source(file, findings=admit(file.findings, accept))
    samples = source.file.samples
    findings = admit(_numbers_of(samples, str(path)), accept)
    return Source(source.file, source.board, source.hand_eye, (*source.findings, *findings))


def _numbers_of(samples: PoseSamples, where: str) -> Iterator[Finding]:
    yield from error_findings(samples.errors, samples.names, where)


def _of_board(path: Path, in_hand: InHand | None, accept: Collection[str]) -> Source:
    found = read_board_views(path, in_hand)
    views, start = found.views, found.intrinsics
    every = list(range(len(views.names)))
    camera = views.fitted(start)
    if found.target is not None:
        views = oriented(views, found.target.symmetries, found.target.points_mm, camera)
    boards = views.boards(every, camera)
    if not found.says_in_hand:
        carried = likely_in_hand(views.T_base_flange, boards)
        if carried is None:
            raise _both_alike(path, "static_camera: false (camera in hand) or true (board in hand)")
        views = replace(views, in_hand=carried)
    pitch = None if found.target is None else found.target.pitch_mm
    findings = admit(hand_eye_findings(views.T_base_flange, boards, views.in_hand, pitch, str(path)), accept)
    camera, robot = views.calibrated(every, given=camera)
    errors = views.held_out([[k] for k in every], start=start)
    kind = f"views of a board, the {views.in_hand} in the robot's hand, each by a calibration without it"
    samples = PoseSamples(errors, views.names, parameters=_PARAMETERS, noise=views.noise(camera, robot))
    hand_eye = HandEye(robot, views.in_hand == "camera", found.left_out)
    board = BoardCalibration(camera, views.resolution, views.intrinsics_covariance(camera), hand_eye)
    return Source(SampleFile(samples, kind), board, hand_eye, findings)


def _of_pairs(path: Path, in_hand: InHand | None, accept: Collection[str]) -> Source:
    pairs = read_hand_eye(path)
    robot_poses, boards = pairs.T_base_flange, pairs.T_camera_board
    carried = in_hand or pairs.in_hand or likely_in_hand(robot_poses, boards)
    if carried is None:
        raise _both_alike(path, "--in-hand camera (eye in hand) or --in-hand board (eye on base)")
    findings = admit(hand_eye_findings(robot_poses, boards, carried, None, str(path)), accept)
    M = seen_from_board(boards, carried)
    robot = calibrate_robot(robot_poses, M)
    samples = PoseSamples(robot.errors(robot_poses, M), pairs.names, parameters=_PARAMETERS)
    kind = f"{pairs.format}, the {carried} in the robot's hand, what one calibration leaves of all"
    return Source(SampleFile(samples, kind), None, HandEye(robot, carried == "camera"), findings)


def _both_alike(path: Path, expected: str) -> InputError:
    problem = "the file does not say whether the robot carries the camera or the board, and both explain it alike"
    return InputError(problem, file=path, expected=expected)
