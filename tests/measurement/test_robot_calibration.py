"""Camera and robot from views of a board: what was put in comes out, held-out errors are the robot's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from viewgauge.exceptions import InputError
from viewgauge.geometry import PoseError, invert, transform
from viewgauge.measurement import PoseSamples, estimate_pose_error
from viewgauge.measurement.pose.board import Board, Intrinsics, board_pose, find_corners, fit_intrinsics
from viewgauge.measurement.pose.robot_calibration import BoardViews, calibrate_robot, folds_of
from viewgauge.simulation.full_camera import draw_pose_errors

cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed")

BOARD = Board(7, 9, 30.0, 22.0, "DICT_5X5_250")
CAMERA = Intrinsics(np.array([[1500.0, 0, 810], [0, 1505, 590], [0, 0, 1]]), np.array([-0.12, 0.08, 5e-4, -3e-4, 0.0]))
POSE_ERROR = PoseError.from_standard_deviations((0.4, 0.3, 0.5), (8e-4, 5e-4, 6e-4))
SIZE = (1600, 1200)


def pose(position, rotvec):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_rotvec(rotvec).as_matrix(), position
    return T


X = pose([40.0, -25, 110], [0.2, -1.1, 0.4])
Y = pose([900.0, 150, 500], [1.9, 0.4, -0.6])


def views_of(in_hand, n, noise_px, pose_error, seed):
    """Views of a board that the robot reaches with errors, corners seen by OpenCV's camera with noise."""
    rng = np.random.default_rng(seed)
    shown = []
    while len(shown) < n:
        turn = rng.uniform([-0.6, -0.6, -1.5], [0.6, 0.6, 1.5])
        T = pose([rng.uniform(-150, 50), rng.uniform(-180, 20), rng.uniform(550, 850)], turn)
        places = seen(T)
        if ((places > 20) & (places < np.array(SIZE) - 20)).all():
            shown.append(T)
    M = np.array(shown) if in_hand == "board" else invert(np.array(shown))
    reached = Y @ M @ invert(X)
    errors = draw_pose_errors(pose_error, n, rng)
    commanded = reached @ errors  # reached = commanded @ inverse of the displacement
    corners = [seen(T) + noise_px * rng.standard_normal((len(BOARD.points_mm), 2)) for T in shown]
    names = tuple(f"v{k}" for k in range(n))
    return BoardViews(names, commanded, (BOARD.points_mm,) * n, tuple(corners), SIZE, in_hand)


def seen(T):
    turn = cv2.Rodrigues(T[:3, :3])[0]
    places, _ = cv2.projectPoints(BOARD.points_mm, turn, T[:3, 3], CAMERA.matrix, CAMERA.distortion)
    return places.reshape(-1, 2)


@pytest.mark.parametrize("in_hand", ["camera", "board"])
def test_without_errors_camera_and_robot_come_out(in_hand):
    views = views_of(in_hand, 12, 0.0, PoseError(np.zeros((6, 6))), 1)
    camera, robot = views.calibrated(range(12))
    assert camera.matrix == pytest.approx(CAMERA.matrix, abs=0.05)
    assert camera.distortion == pytest.approx(CAMERA.distortion, abs=2e-3)
    assert pytest.approx(X, abs=0.02) == robot.X
    assert pytest.approx(Y, abs=0.02) == robot.Y
    assert np.abs(robot.predicted(views.T_base_flange) - views.seen(range(12), camera)).max() < 0.03


@pytest.mark.parametrize("in_hand", ["camera", "board"])
def test_held_out_errors_are_those_of_the_robot(in_hand):
    """60 views, 58 degrees of freedom: deviations are off by 9 % (one sigma); 4.5 sigma, seed fixed."""
    views = views_of(in_hand, 60, 0.05, POSE_ERROR, 2)
    errors = views.held_out(folds_of(60, 10, 0))
    found = estimate_pose_error(PoseSamples(errors, views.names, parameters=12))
    assert found.degrees_of_freedom == 58
    assert found.deviation == pytest.approx(np.sqrt(POSE_ERROR.covariance.diagonal()), rel=0.42)
    assert np.abs(found.mean / found.deviation).max() < 4.5 / np.sqrt(60)


def test_a_view_does_not_explain_its_own_error():
    """Twice the same data but for one view: its held-out error moves by as much as its pose, others hardly."""
    views = views_of("board", 15, 0.05, POSE_ERROR, 3)
    shift = pose([50.0, 0, 0], [0, 0, 0])
    wrong = views.T_base_flange.copy()
    wrong[4] = wrong[4] @ shift
    moved = BoardViews(views.names, wrong, views.points_mm, views.places_px, SIZE, "board")
    alone = [[k] for k in range(15)]
    change = moved.held_out(alone)[4] - views.held_out(alone)[4]
    assert change[0] == pytest.approx(50, abs=2)
    assert np.abs(change[1:3]).max() < 2


def test_the_noise_of_the_corners_is_reported_apart_from_the_robot():
    """0.3 px corners double the variance of the turns; without it the robot's own is left.

    80 views: of a variance with as much noise again 23 % is chance (one sigma), of the root of three of them 7 %.
    """
    pose_error = PoseError.from_standard_deviations(0.3, 1e-3)
    views = views_of("board", 80, 0.3, pose_error, 5)
    camera, robot = views.calibrated(range(80))
    assert camera.rms_px == pytest.approx(0.3, rel=0.05)
    errors, noise = views.held_out(folds_of(80, 8, 0)), views.noise(camera, robot)
    with_noise = estimate_pose_error(PoseSamples(errors, views.names, parameters=12))
    expected = pose_error.covariance.diagonal() + noise.diagonal(axis1=1, axis2=2).mean(axis=0)
    assert with_noise.covariance.diagonal() == pytest.approx(expected, rel=0.8)
    found = estimate_pose_error(PoseSamples(errors, views.names, parameters=12, noise=noise))
    assert found.noise_share.max() > 0.3
    assert (found.deviation < with_noise.deviation).all()
    total = np.sqrt(found.covariance[:3, :3].trace()), np.sqrt(found.covariance[3:, 3:].trace())
    assert total == pytest.approx((0.3 * np.sqrt(3), 1e-3 * np.sqrt(3)), rel=0.3)


def test_corners_in_an_image_are_where_the_board_is(tmp_path):
    """A board drawn flat and seen from the front at 4 px a millimetre, shifted by known fractions of a pixel."""
    scale, shift = 4.0, np.array([33.3, 21.7])
    drawn = BOARD._made.generateImage((int(7 * 30 * scale), int(9 * 30 * scale)), marginSize=0)
    warp = np.array([[1.0, 0, shift[0]], [0, 1, shift[1]]])
    image = cv2.warpAffine(drawn, warp, (drawn.shape[1] + 80, drawn.shape[0] + 80), borderValue=255)
    path = tmp_path / "board.png"
    cv2.imwrite(str(path), image)
    ids, places = find_corners(path, BOARD)
    assert sorted(ids) == list(range(len(BOARD.points_mm)))
    expected = BOARD.points_mm[ids, :2] * scale - 0.5 + shift  # pixel centres are whole numbers
    assert np.abs(places - expected).max() < 0.3


def test_a_board_s_pose_and_camera_from_clean_corners():
    T = pose([-80.0, -110, 700], [0.3, -0.4, 0.5])
    assert board_pose(BOARD.points_mm, seen(T), CAMERA) == pytest.approx(T, abs=1e-3)
    undistorted = CAMERA.undistorted(seen(T))
    inside = transform(T, BOARD.points_mm)
    expected = inside[:, :2] / inside[:, 2:] * [1500, 1505] + [810, 590]
    assert undistorted == pytest.approx(expected, abs=1e-3)


def test_too_little_is_refused():
    views = views_of("board", 5, 0.0, POSE_ERROR, 4)
    with pytest.raises(InputError, match="too few views"):
        calibrate_robot(views.T_base_flange[:4], views.seen(range(4), CAMERA))
    with pytest.raises(InputError, match="not a ChArUco board"):
        _ = Board(2, 2, 10.0, 20.0, "DICT_5X5_250").points_mm
    with pytest.raises(InputError, match="not a ChArUco board"):
        _ = Board(5, 7, 30.0, 20.0, "DICT_NONE").points_mm
    with pytest.raises(InputError, match="does not exist"):
        find_corners("none.png", BOARD)
    assert fit_intrinsics(views.points_mm, views.places_px, SIZE).rms_px < 1e-2


def test_the_covariance_of_the_camera_is_opencv_s_and_that_of_fits_to_noise():
    """Against the standard deviations of OpenCV's own normal equations, and against 60 fits to other noise."""
    clean = views_of("board", 12, 0.0, POSE_ERROR, seed=5)
    rng, found, reported = np.random.default_rng(9), [], []
    for _ in range(60):
        places = tuple(p + 0.2 * rng.standard_normal(p.shape) for p in clean.places_px)
        views = BoardViews(clean.names, clean.T_base_flange, clean.points_mm, places, SIZE, "board")
        camera = fit_intrinsics(views.points_mm, places, SIZE)
        found.append(np.r_[camera.matrix[[0, 1, 0, 1], [0, 1, 2, 2]], camera.distortion[:4]])
        reported.append(views.intrinsics_covariance(camera))
    flat = [p.astype(np.float32) for p in clean.points_mm], [p.astype(np.float32) for p in places]
    deviations = cv2.calibrateCameraExtended(*flat, SIZE, None, None, flags=cv2.CALIB_FIX_K3)[5].ravel()[:8]
    # theirs of float32 corners, and with another count of degrees of freedom: 1 %
    assert np.sqrt(reported[-1].diagonal()) == pytest.approx(deviations, rel=0.02)
    # chi-square of 60 x 8: each within 1 +- 0.27 with probability 0.9973; their mean product with the predicted
    expected = np.mean(reported, axis=0)
    z = np.linalg.solve(np.linalg.cholesky(expected), (np.array(found) - np.mean(found, axis=0)).T)
    assert (z**2).sum() / (59 * 8) == pytest.approx(1.0, abs=3 * np.sqrt(2 / (59 * 8)))
