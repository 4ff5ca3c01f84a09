"""Calibrations as other programs write them: what is read, what OpenCV makes of what is written, what is refused."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.cameras.camera_file import Stated
from viewgauge.formats.cameras.camera_formats import read_camera_file
from viewgauge.formats.cameras.opencv import write_opencv_camera
from viewgauge.geometry import Lens
from viewgauge.sensors import Camera

MATRIX = np.array([[2801.25, 0.0, 1012.5], [0.0, 2799.75, 770.125], [0.0, 0.0, 1.0]])
FIVE = np.array([-0.21, 0.105, 3e-4, -2e-4, 0.01])

ROS = """\
image_width: 2048
image_height: 1536
camera_name: head
camera_matrix:
  rows: 3
  cols: 3
  data: [2801.25, 0, 1012.5, 0, 2799.75, 770.125, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.21, 0.105, 0.0003, -0.0002, 0.01]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
projection_matrix: {rows: 3, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}
"""
TOPIC = """\
height: 1536
width: 2048
distortion_model: "plumb_bob"
D: [-0.21, 0.105, 0.0003, -0.0002, 0.01]
K: [2801.25, 0.0, 1012.5, 0.0, 2799.75, 770.125, 0.0, 0.0, 1.0]
"""
KALIBR = """\
cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.21, 0.105, 0.0003, -0.0002]
  distortion_model: radtan
  intrinsics: [2801.25, 2799.75, 1012.5, 770.125]
  resolution: [2048, 1536]
  rostopic: /head/left
cam1:
  camera_model: pinhole
  distortion_coeffs: [0.01, -0.002, 0.003, -0.001]
  distortion_model: equidistant
  intrinsics: [801.5, 802.5, 640.25, 480.75]
  resolution: [1280, 960]
  rostopic: /head/right
"""


def read(tmp_path, text, name=None):
    path = tmp_path / "camera.yaml"
    path.write_text(text)
    return read_camera_file(path, name)


@pytest.mark.parametrize("text", [ROS, TOPIC])
def test_ros_camera_info(tmp_path, text):
    found = read(tmp_path, text)
    assert found.format == "ROS camera_info"
    assert (found.focal_length_px, found.principal_point_px) == ((2801.25, 2799.75), (1012.5, 770.125))
    assert found.resolution == (2048, 1536)
    assert found.lens == Lens("radial-tangential", tuple(FIVE))
    assert found.covariance is None


def test_kalibr(tmp_path):
    left, right = (read(tmp_path, KALIBR, name) for name in ("cam0", "cam1"))
    assert left.format == right.format == "Kalibr"
    assert left.lens == Lens("radial-tangential", (-0.21, 0.105, 0.0003, -0.0002))
    assert right.lens == Lens("equidistant", (0.01, -0.002, 0.003, -0.001))
    assert (right.focal_length_px, right.principal_point_px) == ((801.5, 802.5), (640.25, 480.75))
    assert (left.resolution, right.resolution) == ((2048, 1536), (1280, 960))


def write_with_opencv(path, distortion, fisheye=False, **more):
    """As OpenCV's own calibration sample does."""
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    file.write("image_width", 2048)
    file.write("image_height", 1536)
    if fisheye:
        file.write("fisheye_model", 1)
    file.write("camera_matrix", MATRIX)
    file.write("distortion_coefficients", distortion)
    for name, value in more.items():
        file.write(name, value)
    file.release()


@pytest.mark.parametrize("count", [4, 5, 8, 12, 14])
@pytest.mark.parametrize("column", [False, True])
def test_what_opencv_writes(tmp_path, count, column):
    coefficients = np.zeros(count)
    coefficients[:4] = FIVE[:4]
    path = tmp_path / "camera.yml"
    write_with_opencv(path, coefficients[:, None] if column else coefficients[None, :])
    if count == 4:
        with pytest.raises(InspectionFileError, match="does not say of which model"):
            read_camera_file(path)
    found = read_camera_file(path, Stated(model="radial-tangential" if count == 4 else None))
    assert found.format == "OpenCV"
    assert (found.focal_length_px, found.principal_point_px) == ((2801.25, 2799.75), (1012.5, 770.125))
    assert found.lens is not None
    assert found.lens.coefficients == tuple(coefficients[: min(count, 12)])
    assert found.resolution == (2048, 1536)


def test_what_opencv_writes_of_a_fisheye(tmp_path):
    path = tmp_path / "camera.yml"
    write_with_opencv(path, np.array([[0.01, -0.002, 0.003, -0.001]]), fisheye=True)
    assert read_camera_file(path).lens == Lens("equidistant", (0.01, -0.002, 0.003, -0.001))


def test_standard_deviations_beside_what_opencv_writes(tmp_path):
    # as cv2.calibrateCameraExtended returns them: 18, of which those that were not fitted are 0
    deviations = np.zeros((18, 1))
    deviations[:9, 0] = [0.5, 0.6, 0.7, 0.8, 1e-3, 2e-3, 1e-5, 2e-5, 3e-3]
    path = tmp_path / "camera.yml"
    write_with_opencv(path, FIVE[None, :], intrinsics_standard_deviations=deviations)
    covariance = read_camera_file(path).covariance
    assert covariance is not None
    assert np.allclose(np.asarray(covariance), np.diag(deviations[:9, 0] ** 2), rtol=1e-12)


cameras = st.builds(
    lambda focal, aspect, centre, coefficients, size, deviations: Camera(
        focal_length_mm=focal,
        pixel_pitch_mm=(0.00345, 0.00345 * aspect),
        resolution=size,
        principal_point_px=centre,
        lens=Lens("radial-tangential", coefficients) if coefficients else None,
        intrinsics_covariance=tuple(map(tuple, np.diag(np.square(deviations[: 4 + len(coefficients)])).tolist())),
    ),
    st.floats(8, 100),
    st.floats(0.9, 1.1),
    st.tuples(st.floats(300, 340), st.floats(220, 260)),
    st.sampled_from([(), (1e-3, -1e-4, 1e-5, 0.0), tuple(FIVE), (*FIVE, 1e-3, 2e-3, 1e-3), (*FIVE, *(1e-4,) * 7)]),
    st.tuples(st.integers(600, 680), st.integers(440, 520)),
    st.lists(st.floats(0, 1), min_size=16, max_size=16),
)


@given(cameras)
def test_a_written_calibration_is_read_back_to_the_last_digit(tmp_path_factory, camera):
    path = tmp_path_factory.mktemp("camera") / "camera.yaml"
    write_opencv_camera(path, camera)
    found = read_camera_file(path)
    assert found.resolution == camera.resolution
    assert found.lens == camera.lens
    assert found.principal_point_px == camera.principal_point
    assert found.covariance == camera.intrinsics_covariance
    focal = tuple(camera.focal_length_mm / pitch for pitch in camera.pixel_pitch_mm)
    assert found.focal_length_px == focal


@pytest.mark.parametrize("coefficients", [FIVE[:4], FIVE, np.r_[FIVE, 1e-3, 2e-3, 1e-3]])
def test_opencv_reads_what_is_written_and_puts_points_in_the_same_pixels(tmp_path, coefficients):
    camera = Camera(16.0, (0.00345, 0.0035), (2448, 2048), lens=Lens("radial-tangential", tuple(coefficients)))
    path = tmp_path / "camera.yaml"
    write_opencv_camera(path, camera)
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, distortion = (file.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients"))
    assert (file.getNode("image_width").real(), file.getNode("image_height").real()) == (2448, 2048)
    points = np.random.default_rng(3).uniform([-60, -50, 400], [60, 50, 600], (50, 3))
    theirs = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, distortion)[0][:, 0]
    # our rounding and theirs: 1e-9 px
    assert np.abs(camera.to_pixels(camera.project(points)) - theirs).max() < 1e-9


def test_a_fisheye_goes_to_opencv_and_back(tmp_path):
    lens = Lens("equidistant", (0.01, -0.002, 0.003, -0.001))
    camera = Camera(4.0, (0.00345, 0.00345), (1280, 960), lens=lens)
    path = tmp_path / "camera.yaml"
    write_opencv_camera(path, camera)
    assert read_camera_file(path).lens == lens
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix, distortion = (file.getNode(name).mat() for name in ("camera_matrix", "distortion_coefficients"))
    points = np.random.default_rng(3).uniform([-200, -150, 400], [200, 150, 600], (50, 1, 3))
    theirs = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), matrix, distortion)[0][:, 0]
    assert np.abs(camera.to_pixels(camera.project(points[:, 0])) - theirs).max() < 1e-9


def without(text, line):
    return "\n".join(each for each in text.splitlines() if not each.strip().startswith(line)) + "\n"


BAD = [
    ("", None, None, "not a calibration of a camera"),
    ("- 1\n- 2\n", None, None, "not a calibration of a camera"),
    ("a: [1\n", None, None, "not valid YAML"),
    ("focal: 3\n", None, None, "no camera matrix"),
    (without(TOPIC, "K:"), None, None, "no camera matrix"),
    (TOPIC.replace("plumb_bob", "fov"), None, "distortion_model", "unknown distortion model"),
    (TOPIC.replace("0.01]", "0.01, 3]"), None, "D", "another number of coefficients"),
    (TOPIC.replace("0.01]", ".nan]"), None, "D", "not a list of numbers"),
    (TOPIC.replace("[-0.21, 0.105, 0.0003, -0.0002, 0.01]", "many"), None, "D", "not a list of numbers"),
    (TOPIC.replace("0.0, 0.0, 1.0]", "1.0]"), None, "K", "another number of values"),
    (TOPIC.replace("2801.25, 0.0,", "2801.25, 3.0,"), None, "K", "skew is not known"),
    (TOPIC.replace("2801.25", "-2801.25"), None, "K", "focal length must be positive"),
    (TOPIC.replace("2048", "2048.5"), None, "width", "not columns and rows"),
    (TOPIC.replace("2048", "wide"), None, "width", "not a number"),
    (TOPIC + "intrinsics_covariance: [1, 2, 3]\n", None, "intrinsics_covariance", "another number of values"),
    (TOPIC + "intrinsics_standard_deviations: [1, 2]\n", None, "intrinsics_standard_deviations", "9 numbers"),
    (TOPIC, "cam0", None, "one camera without a name"),
    (KALIBR, None, None, "several cameras"),
    (KALIBR, "cam7", None, "no such camera"),
    (KALIBR.replace("pinhole", "omni"), "cam0", "cam0.camera_model", "unknown camera model"),
    (KALIBR.replace("radtan", "fov"), "cam0", "cam0.distortion_model", "unknown distortion model"),
    (
        KALIBR.replace("[2801.25, 2799.75, 1012.5, 770.125]", "[1, 2]"),
        "cam0",
        "cam0.intrinsics",
        "4 or 9 or 12 finite numbers",
    ),
    (KALIBR.replace("[2801.25, ", "[0, "), "cam0", "cam0.intrinsics", "must be positive"),
]


@pytest.mark.parametrize(("text", "name", "key", "telling"), BAD)
def test_a_bad_calibration_is_reported_with_file_and_key(tmp_path, text, name, key, telling):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, text, name)
    assert telling in str(caught.value)
    assert str(tmp_path / "camera.yaml") in str(caught.value)
    if key is not None:
        assert caught.value.key == key


def test_a_tilted_sensor_is_refused(tmp_path):
    path = tmp_path / "camera.yml"
    tilted = np.zeros((1, 14))
    tilted[0, 12] = 0.01
    write_with_opencv(path, tilted)
    with pytest.raises(InspectionFileError, match="tilted sensor"):
        read_camera_file(path)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InspectionFileError, match="does not exist"):
        read_camera_file(tmp_path / "none.yaml")
