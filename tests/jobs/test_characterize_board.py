"""From images of a board and a robot's poses to its pose errors; on images made here, and on a real robot's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from viewgauge.exceptions import InputError
from viewgauge.formats.cameras.camera_formats import read_camera_file
from viewgauge.geometry import PoseError, invert, quaternion_from_pose
from viewgauge.jobs.characterize import characterize, describe_characterization, write_calibration
from viewgauge.measurement.pose.board import Board
from viewgauge.simulation.full_camera import draw_pose_errors

cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed")

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "abb_charuco"
BOARD = Board(7, 5, 40.0, 30.0, "DICT_5X5_100")
K = np.array([[900.0, 0, 399.5], [0, 900.0, 299.5], [0, 0, 1]])
PX_PER_MM = 8.0


def pose(position, rotvec):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.from_rotvec(rotvec).as_matrix(), position
    return T


X, Y = pose([20.0, -15, 60], [0.1, 0.8, -0.3]), pose([700.0, 50, 300], [1.7, -0.2, 0.5])
POSE_ERROR = PoseError.from_standard_deviations(0.5, 1e-3)


def image_of(T):
    """The board as a pinhole camera sees it: a plane is mapped by a homography."""
    size = (int(7 * 40 * PX_PER_MM), int(5 * 40 * PX_PER_MM))
    drawn = BOARD._made.generateImage(size, marginSize=0)
    to_mm = np.array([[1 / PX_PER_MM, 0, 0.5 / PX_PER_MM], [0, 1 / PX_PER_MM, 0.5 / PX_PER_MM], [0, 0, 1]])
    H = K @ np.stack([T[:3, 0], T[:3, 1], T[:3, 3]], axis=1) @ to_mm
    big = np.diag([3.0, 3, 1]) @ np.array([[1, 0, 1 / 3], [0, 1, 1 / 3], [0, 0, 1]]) @ H  # three times finer, averaged
    wide = cv2.warpPerspective(drawn, big, (2400, 1800), flags=cv2.INTER_AREA, borderValue=128)
    return cv2.resize(wide, (800, 600), interpolation=cv2.INTER_AREA)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """14 images and poses of a robot that carries the board, with errors."""
    folder, rng = tmp_path_factory.mktemp("board"), np.random.default_rng(6)
    errors = draw_pose_errors(POSE_ERROR, 14, rng)
    listed = []
    for k in range(14):
        T = pose([rng.uniform(-160, -120), rng.uniform(-120, -90), rng.uniform(480, 620)], rng.uniform(-0.5, 0.5, 3))
        cv2.imwrite(str(folder / f"{k}.png"), image_of(T))
        commanded = Y @ T @ invert(X) @ errors[k]
        numbers = dict(zip("xyz", commanded[:3, 3] / 1e3, strict=True))
        numbers |= dict(zip(("qw", "qx", "qy", "qz"), quaternion_from_pose(commanded), strict=True))
        (folder / f"{k}.yaml").write_text("".join(f"{name}: {float(v)!r}\n" for name, v in numbers.items()))
        listed.append(f"  - {{image: {k}.png, pose: {k}.yaml}}\n")
    text = (
        "data:\n" + "".join(listed) + "target_finder: {rows: 5, cols: 7, chessboard_dim: 0.04, aruco_marker_dim: 0.03, "
        "dictionary: DICT_5X5_100}\nintrinsics: {fx: 880, fy: 880, cx: 400, cy: 300}\nstatic_camera: true\n"
    )
    (folder / "cal.yaml").write_text(text)
    return folder


def test_images_and_poses_to_the_robot_s_errors(folder):
    character = characterize(folder / "cal.yaml")
    document = describe_characterization(character)
    assert character.samples == 14
    assert document["board"]["in_hand"] == "board"
    assert document["board"]["rms_px"] < 0.15
    # by 14 poses with errors of 0.5 mm and 1 mrad, which bend the lens model as well
    assert np.array(document["board"]["camera_matrix_px"])[0, 0] == pytest.approx(900, rel=0.01)
    assert np.array(document["board"]["X"])[:3, 3] == pytest.approx(X[:3, 3], abs=3)
    sure = document["board"]["standard_uncertainty"]
    assert abs(np.array(document["board"]["camera_matrix_px"])[0, 0] - 900) < 4 * sure["fx"]
    # 12 degrees of freedom and six axes: their root mean square is off by 9 % (one sigma), and by the fit of the lens
    ratio = character.pose_error.deviation / np.sqrt(POSE_ERROR.covariance.diagonal())
    assert 0.5 < np.sqrt((ratio**2).mean()) < 2.0


def test_the_camera_is_written_for_opencv_and_the_inspection(folder, tmp_path):
    character = characterize(folder / "cal.yaml")
    write_calibration(character, tmp_path / "camera.yaml")
    read = read_camera_file(tmp_path / "camera.yaml")
    board = character.board
    assert board is not None
    assert read.resolution == (800, 600)
    assert read.focal_length_px == (board.camera.matrix[0, 0], board.camera.matrix[1, 1])
    assert np.array_equal(np.asarray(read.covariance), board.camera_covariance)
    file = cv2.FileStorage(str(tmp_path / "camera.yaml"), cv2.FILE_STORAGE_READ)
    assert np.array_equal(file.getNode("camera_matrix").mat(), board.camera.matrix)


@pytest.mark.parametrize(
    ("change", "telling"),
    [
        (("image: 3.png", "image: none.png"), "none.png: the file does not exist"),
        (("pose: 3.yaml", "pose: none.yaml"), "none.yaml: the file does not exist"),
        (("pose: 3.yaml", "pose: 3.png"), "3.png"),
        (("image: 3.png", "image: 3.yaml"), "the image cannot be read"),
        (("rows: 5", "rows: five"), "target_finder"),
        (("cols: 7", "cols: 2"), "found in no image"),
        (("dictionary: DICT_5X5_100", "dictionary: DICT_X"), "not a ChArUco board"),
        (("fx: 880", "fx: wide"), "intrinsics"),
        (("{image: 3.png, pose: 3.yaml}", "3.png"), "data[3]: not a view"),
    ],
)
def test_what_is_wrong_is_reported(folder, change, telling):
    bad = folder / "bad.yaml"
    bad.write_text((folder / "cal.yaml").read_text().replace(*change))
    with pytest.raises(InputError) as raised:
        characterize(bad)
    assert telling in str(raised.value)


@pytest.mark.skipif(not SHARED.is_dir(), reason="a real robot's images: ../shared/data/abb_charuco is absent")
def test_a_real_robot():
    """The figures that come with the data, by another analysis: 2-3 mm and 1.6-3 mrad, which are those of all axes."""
    character = characterize(SHARED / "cal_data.yaml")
    assert character.samples == 15
    assert character.board is not None
    assert character.board.left_out == ("images/2.png: 4 corners found",)
    position, turn = (np.linalg.norm(character.pose_error.deviation[part]) for part in (slice(0, 3), slice(3, 6)))
    assert 1.0 < position < 4.0
    assert 1e-3 < turn < 6e-3
