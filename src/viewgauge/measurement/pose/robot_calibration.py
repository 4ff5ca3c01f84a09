"""Hand-eye and robot-world calibration from views of a board, and the pose errors that it leaves.

With a camera in the robot's hand X is the camera's pose on the flange and Y the board's in the base frame; with the
board in its hand X is the board's on the flange and Y the camera's in the base frame. With ``M`` the pose of what is
in the hand as the image tells it, seen from what is not (the board's from the camera or its inverse),
``T_base_flange X = Y M`` in both cases; what is left of it is the robot's pose error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import Lens, invert, point_jacobian, transform
from .board import Intrinsics, board_pose, fit_intrinsics, robot_world_hand_eye
from .pose_samples import errors_of_poses

__all__ = ["BoardViews", "RobotCalibration", "calibrate_robot", "folds_of"]

_FEWEST = 5
_ROUNDS = 8  # of weighing the errors by their own covariance
_UNIT = np.array([1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6])  # mm, rad: steps of differences
_RADIUS_MM = 300.0  # in the first round a turn of one rad counts as much as this shift


@dataclass(frozen=True)
class RobotCalibration:
    """X and Y ``(4, 4)`` mm, and the covariance ``(6, 6)`` of the pose errors that they leave, flange frame."""

    X: NDArray[np.float64]
    Y: NDArray[np.float64]
    covariance: NDArray[np.float64]
    degrees_of_freedom: int

    def errors(self, T_base_flange: NDArray[np.float64], M: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, 6)`` pose errors of the flange, flange frame, of poses ``(n, 4, 4)`` that were commanded."""
        return errors_of_poses(T_base_flange, self.Y @ M @ invert(self.X))

    def predicted(self, T_base_flange: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, 4, 4)``: M as the robot's poses alone say it."""
        return np.asarray(invert(self.Y) @ T_base_flange @ self.X)


def calibrate_robot(T_base_flange: NDArray[np.float64], M: NDArray[np.float64]) -> RobotCalibration:
    """X and Y of the greatest likelihood for normal pose errors of any covariance, which is found with them.

    First by OpenCV (Shah, *J. Mechanisms Robotics* 5 (2013) 031007), then by least squares of the pose errors, weighed
    by the inverse of their own covariance again and again.

    Parameters
    ----------
    T_base_flange, M
        ``(n, 4, 4)`` mm.

    Raises
    ------
    InputError
        If there are fewer than five views.
    """
    from scipy.optimize import least_squares

    n = len(T_base_flange)
    if n < _FEWEST:
        raise InputError(
            "too few views for a hand-eye calibration", key="views", got=n, expected=f"{_FEWEST} or more with a board"
        )
    X0, Y0 = robot_world_hand_eye(T_base_flange, M)
    freedom = n - 2  # twelve parameters of six errors a view
    weight = np.diag([1.0, 1, 1, _RADIUS_MM, _RADIUS_MM, _RADIUS_MM])
    x = np.zeros(12)

    def placed(x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return X0 @ _displacement(x[:6]), Y0 @ _displacement(x[6:])

    def left(x: NDArray[np.float64]) -> NDArray[np.float64]:
        X, Y = placed(x)
        return errors_of_poses(T_base_flange, Y @ M @ invert(X))

    covariance = np.eye(6)
    for _ in range(_ROUNDS):
        by = weight

        def weighed(x: NDArray[np.float64], by: NDArray[np.float64] = by) -> NDArray[np.float64]:
            return np.asarray((left(x) @ by.T).ravel())

        x = least_squares(weighed, x, x_scale="jac").x
        errors = left(x)
        covariance = errors.T @ errors / freedom
        deviation = np.sqrt(np.maximum(covariance.diagonal(), np.finfo(float).tiny))
        if n < 2 * 6 + 2:  # too few for correlations
            weight = np.diag(1 / deviation)
        else:
            weight = np.linalg.inv(np.linalg.cholesky(covariance + 1e-12 * np.diag(deviation**2)))
    return RobotCalibration(*placed(x), covariance, freedom)


@dataclass(frozen=True)
class BoardViews:
    """Views of a board, and where the robot was told to be.

    Parameters
    ----------
    names
        Of the n views.
    T_base_flange
        ``(n, 4, 4)`` mm.
    points_mm, places_px
        Of each view: corners seen, ``(k, 3)`` in the board frame and ``(k, 2)`` in the image.
    resolution
        Columns and rows of the images.
    in_hand
        What the robot carries: "camera" or "board".
    """

    names: tuple[str, ...]
    T_base_flange: NDArray[np.float64]
    points_mm: tuple[NDArray[np.float64], ...]
    places_px: tuple[NDArray[np.float64], ...]
    resolution: tuple[int, int]
    in_hand: Literal["camera", "board"]

    def fitted(self, start: Intrinsics | None = None) -> Intrinsics:
        """The camera by all the views."""
        return fit_intrinsics(self.points_mm, self.places_px, self.resolution, start)

    def boards(self, rows: Sequence[int], camera: Intrinsics) -> NDArray[np.float64]:
        """``(n, 4, 4)`` mm: ``T_camera_board`` of some of the views."""
        return np.array([board_pose(self.points_mm[k], self.places_px[k], camera) for k in rows])

    def calibrated(
        self, rows: Sequence[int], given: Intrinsics | None = None, start: Intrinsics | None = None
    ) -> tuple[Intrinsics, RobotCalibration]:
        """Camera and robot by some of the views alone, by index."""
        points, places = [self.points_mm[k] for k in rows], [self.places_px[k] for k in rows]
        camera = given or fit_intrinsics(points, places, self.resolution, start)
        return camera, calibrate_robot(self.T_base_flange[list(rows)], self.seen(rows, camera))

    def seen(self, rows: Sequence[int], camera: Intrinsics) -> NDArray[np.float64]:
        """``(n, 4, 4)`` mm: M of some of the views."""
        poses = self.boards(rows, camera)
        return poses if self.in_hand == "board" else invert(poses)

    def noise(self, camera: Intrinsics, robot: RobotCalibration) -> NDArray[np.float64]:
        """``(n, 6, 6)``: covariance of what the corners' noise adds to the pose errors, flange frame, first order.

        Each corner is off by the camera's rms, in u and v alike.
        """
        if camera.rms_px is None:
            raise ValueError("the noise of the corners is known of a camera that was fitted")
        every = range(len(self.names))
        M = self.seen(every, camera)
        focal = np.array([camera.matrix[0, 0], camera.matrix[1, 1]])
        T_camera_board = M if self.in_hand == "board" else invert(M)
        covariances = []
        for k in every:
            J = point_jacobian(transform(T_camera_board[k], self.points_mm[k]), 1.0) * focal[:, None]
            J = J.reshape(-1, 6)  # px per mm and rad of a displacement of the board, camera frame
            moved = np.array([_displacement(step * _UNIT[p] * np.eye(6)[p]) for p in range(6) for step in (1, -1)])
            boards = moved @ T_camera_board[k]
            seen = boards if self.in_hand == "board" else invert(boards)
            errors = robot.errors(np.broadcast_to(self.T_base_flange[k], seen.shape), seen)
            A = ((errors[::2] - errors[1::2]) / (2 * _UNIT[:, None])).T
            covariances.append(camera.rms_px**2 * A @ np.linalg.inv(J.T @ J) @ A.T)
        return np.array(covariances)

    def intrinsics_covariance(self, camera: Intrinsics) -> NDArray[np.float64]:
        """``(8, 8)`` of fx, fy, cx, cy, px, and k1, k2, p1, p2, of a camera that was fitted to all the views.

        That of the least squares over the camera and all poses of the board: the inverse of the Schur complement of the
        poses in the normal equations (Triggs et al., *Vision Algorithms*, LNCS 1883 (2000) 298, sec. 6), times the
        variance that the corners were left with.
        """
        focal = np.array([camera.matrix[0, 0], camera.matrix[1, 1]])
        lens = Lens("radial-tangential", tuple(camera.distortion[:4]))
        normal, left, count = np.zeros((8, 8)), 0.0, 0
        for points, places in zip(self.points_mm, self.places_px, strict=True):
            seen = transform(board_pose(points, places, camera), points)
            ideal = seen[:, :2] / seen[:, 2:]
            distorted = lens.distort(ideal)
            of_camera = np.zeros((len(points), 2, 8))
            of_camera[:, 0, 0], of_camera[:, 1, 1] = distorted[:, 0], distorted[:, 1]
            of_camera[:, 0, 2] = of_camera[:, 1, 3] = 1.0
            of_camera[:, :, 4:] = focal[:, None] * lens.coefficient_jacobian(ideal)
            of_pose = focal[:, None] * (lens.jacobian(ideal) @ point_jacobian(seen, 1.0))
            A = of_camera.reshape(-1, 8)
            Q, _ = np.linalg.qr(of_pose.reshape(-1, 6))
            free = A - Q @ (Q.T @ A)  # what no pose of this view makes up for
            normal += free.T @ free
            residual = places - (distorted * focal + camera.matrix[:2, 2])
            left, count = left + float((residual**2).sum()), count + 2 * len(points)
        freedom = count - 8 - 6 * len(self.names)
        if freedom < 1:
            raise InputError("too few corners for the camera's uncertainty", key="images", got=f"{count // 2} corners")
        return np.asarray(np.linalg.inv(normal) * left / freedom)

    def held_out(
        self, folds: Sequence[Sequence[int]], given: Intrinsics | None = None, start: Intrinsics | None = None
    ) -> NDArray[np.float64]:
        """``(n, 6)`` pose errors of each view, by a calibration of camera and robot that has not seen it.

        Parameters
        ----------
        folds
            Parts of the views, by index, each left out in its turn.
        """
        every = np.arange(len(self.names))
        errors = np.zeros((len(every), 6))
        for fold in folds:
            camera, robot = self.calibrated(np.setdiff1d(every, fold).tolist(), given, start)
            errors[list(fold)] = robot.errors(self.T_base_flange[list(fold)], self.seen(fold, camera))
        return errors


def folds_of(count: int, folds: int, seed: int) -> list[list[int]]:
    """Indices up to ``count`` in so many parts of nearly the same size, drawn at random."""
    order = np.random.default_rng(seed).permutation(count)
    return [sorted(part.tolist()) for part in np.array_split(order, min(folds, count))]


def _displacement(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(4, 4)`` of a shift, mm, and a rotation vector, rad."""
    from scipy.spatial.transform import RigidTransform, Rotation

    turn = Rotation.from_rotvec(parameters[3:])
    return np.asarray(RigidTransform.from_components(parameters[:3], turn).as_matrix())
