"""What is implausible in pairs of the robot's pose and the board's: what is in the hand, inverses, the scale."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...findings import Finding
from ...geometry import invert
from .board import robot_world_hand_eye
from .sample_findings import rotation_angles

__all__ = ["hand_eye_findings", "likely_in_hand", "scale_by_travel", "seen_from_board"]

_RADIUS_MM = 300.0
_BETTER = 5.0  # times smaller errors are what another reading must give
_DOUBTFUL = 0.01  # median error of which other readings are tried, of _RADIUS_MM and rad
_LEAST_SCALE, _MOST_SCALE, _SURE = 0.01, 0.1, 5.0
"""Share from which on the scale is named, and from which on refused; standard uncertainties that it must be off by."""
_FEWEST = 5
_FEWEST_DEG = 3.0

InHand = Literal["camera", "board"]
Poses = NDArray[np.float64]


def seen_from_board(T_camera_board: Poses, in_hand: InHand) -> Poses:
    """M ``(n, 4, 4)``: the pose of what is in the hand, seen from what is not."""
    return T_camera_board if in_hand == "board" else invert(T_camera_board)


def hand_eye_findings(
    T_base_flange: Poses, T_camera_board: Poses, in_hand: InHand, square_mm: float | None, where: str
) -> Iterator[Finding]:
    """Every finding of pairs of poses ``(n, 4, 4)`` mm.

    Parameters
    ----------
    square_mm
        Pitch of the board, for the message about its scale; None where the board is not known.
    """
    if len(T_base_flange) < _FEWEST:
        return
    turns = rotation_angles(np.broadcast_to(T_base_flange[0], T_base_flange.shape), T_base_flange)
    if np.degrees(turns.max()) < _FEWEST_DEG:
        found = f"the robot turns by at most {np.degrees(turns.max()):.2g} deg"
        yield Finding("hand_eye_motion", found, "30 deg and more about two axes", where=where, refused=True)
        return
    M = seen_from_board(T_camera_board, in_hand)
    left = _error(T_base_flange, M)
    scale, uncertainty = scale_by_travel(T_base_flange, M)
    explains = scale > 0 and _error(T_base_flange, _scaled(M, scale)) < max(left / 2, _DOUBTFUL)
    if left > _DOUBTFUL and not explains:
        best, cause = left / _BETTER, ""
        for other, text, robot, board in _readings(T_base_flange, T_camera_board, in_hand):
            by_other = _error(robot, seen_from_board(board, other))
            if by_other < best:
                best, cause = by_other, text
        if cause or left > 5 * _DOUBTFUL:
            found = (
                f"no hand-eye calibration explains the poses: it leaves {left * _RADIUS_MM:.3g} mm (with turns, median)"
            )
            cause = cause or "poses that do not belong to the images, or a board that moved"
            yield Finding("hand_eye", found, "some mm", cause, where, refused=True)
            return
    if explains and abs(scale - 1) > max(_LEAST_SCALE, _SURE * uncertainty):
        if square_mm is None:
            found = f"the robot's travel says that lengths of the board are {scale:.4g} times as large"
            usual = "1"
        else:
            found = (
                f"the robot's travel says {scale * square_mm:.4g} mm (u = {uncertainty * square_mm:.2g} mm) a square"
            )
            usual = f"{square_mm:.4g} mm, as the file states"
        cause = "the stated size of the board"
        if max(scale, 1 / scale) > 500:
            cause = "metres and millimetres: the robot's positions or the board's lengths are in another unit"
        yield Finding("board_scale", found, usual, cause, where, refused=abs(scale - 1) > _MOST_SCALE)


def likely_in_hand(T_base_flange: Poses, T_camera_board: Poses) -> InHand | None:
    """What the robot carries, where one reading leaves much smaller errors than the other; else None."""
    kinds: tuple[InHand, InHand] = ("camera", "board")
    errors = {kind: _error(T_base_flange, seen_from_board(T_camera_board, kind)) for kind in kinds}
    better = min(kinds, key=lambda kind: errors[kind])
    return better if errors[better] * _BETTER < max(errors.values()) else None


def scale_by_travel(T_base_flange: Poses, M: Poses) -> tuple[float, float]:
    """By what lengths of M ``(n, 4, 4)`` must be multiplied to agree with the robot's travel; its standard uncertainty.

    With the rotations of X and Y known, ``R_i t_X + t_i = s R_Y m_i + t_Y`` is linear in ``t_X``, ``t_Y`` and s.
    """
    _, Y = robot_world_hand_eye(T_base_flange, M)
    n = len(M)
    A = np.zeros((n, 3, 7))
    A[:, :, :3] = T_base_flange[:, :3, :3]
    A[:, :, 3:6] = -np.eye(3)
    A[:, :, 6] = -(Y[:3, :3] @ M[:, :3, 3, None])[..., 0]
    rows, right = A.reshape(-1, 7), -T_base_flange[:, :3, 3].ravel()
    found, _, rank, _ = np.linalg.lstsq(rows, right, rcond=None)
    if rank < 7:
        return 1.0, np.inf
    variance = float(((rows @ found - right) ** 2).sum()) / (3 * n - 7)
    covariance = np.linalg.inv(rows.T @ rows) * variance
    return float(found[6]), float(np.sqrt(covariance[6, 6]))


def _error(T_base_flange: Poses, M: Poses) -> float:
    """Median error that the linear calibration leaves, in rad, a shift counted by the radius."""
    try:
        X, Y = robot_world_hand_eye(T_base_flange, M)
    except (InputError, np.linalg.LinAlgError):
        return np.inf
    X, Y = _rigid(X), _rigid(Y)
    reached = Y @ M @ invert(X)
    shift = np.linalg.norm(reached[:, :3, 3] - T_base_flange[:, :3, 3], axis=1)
    return float(np.median(shift / _RADIUS_MM + rotation_angles(reached, T_base_flange)))


def _rigid(T: Poses) -> Poses:
    u, _, v = np.linalg.svd(T[:3, :3])
    nearest = T.copy()
    nearest[:3, :3] = u @ v * np.sign(np.linalg.det(u @ v))
    return nearest


def _readings(
    T_base_flange: Poses, T_camera_board: Poses, in_hand: InHand
) -> Iterator[tuple[InHand, str, Poses, Poses]]:
    other: InHand = "board" if in_hand == "camera" else "camera"
    flag = f"the {other} is in the robot's hand, not the {in_hand} (static_camera, calibration_type, --in-hand)"
    yield other, flag, T_base_flange, T_camera_board
    yield (
        in_hand,
        "the robot's poses are inverses (the base seen from the flange)",
        invert(T_base_flange),
        T_camera_board,
    )
    yield (
        in_hand,
        "the board's poses are inverses (the camera seen from the board)",
        T_base_flange,
        invert(T_camera_board),
    )
    yield in_hand, "all poses are inverses", invert(T_base_flange), invert(T_camera_board)


def _scaled(poses: Poses, factor: float) -> Poses:
    scaled = poses.copy()
    scaled[:, :3, 3] *= factor
    return scaled
