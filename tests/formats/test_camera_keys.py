"""The inspection file's keys of distortion, calibration, its uncertainty and the edge detector."""

from __future__ import annotations

import numpy as np
import pytest

from inspections import CAMERA_KEYS, PART_LINES, POSE_UNCERTAINTY_LINES, REQUIREMENT_LINES
from viewgauge.errors import edge_point_deviation
from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.geometry import Lens
from viewgauge.sensors import EdgeDetector

TEXT = PART_LINES + "camera:\n%s\n" + POSE_UNCERTAINTY_LINES + REQUIREMENT_LINES
OWN = CAMERA_KEYS
FILED = "  calibration: camera.yaml\n  pixel_pitch: 3.45 um\n"
TOPIC = """\
height: 2048
width: 2448
distortion_model: "plumb_bob"
D: [-0.1, 0.02, 0.0003, -0.0002, 0.01]
K: [4640.0, 0.0, 1220.5, 0.0, 4641.0, 1022.25, 0.0, 0.0, 1.0]
intrinsics_standard_deviations: [0.5, 0.6, 0.7, 0.8, 0.001, 0.002, 0.00001, 0.00002, 0.003]
"""


def read(tmp_path, camera, calibration=TOPIC):
    (tmp_path / "inspection.yaml").write_text(TEXT % camera.rstrip("\n"))
    (tmp_path / "camera.yaml").write_text(calibration)
    return read_inspection_file(tmp_path / "inspection.yaml")


def test_without_them_the_camera_is_the_paper_s(tmp_path):
    camera = read(tmp_path, OWN).setup.camera
    assert camera.is_plain
    assert camera.edge_resolution_px == 1.0


def test_distortion_and_its_uncertainty(tmp_path):
    uncertainty = "{focal_length: '[0.5, 0.6] px', principal_point: 0.8 px, distortion: [0.001, 0.002, 0, 0]}"
    camera = read(
        tmp_path, f"{OWN}  distortion: [-0.1, 0.02, 0, 0]\n  calibration_uncertainty: {uncertainty}"
    ).setup.camera
    assert camera.lens == Lens("radial-tangential", (-0.1, 0.02, 0.0, 0.0))
    expected = np.diag(np.square([0.5, 0.6, 0.8, 0.8, 0.001, 0.002, 0, 0]))
    np.testing.assert_allclose(np.asarray(camera.intrinsics_covariance), expected, rtol=1e-15)


def test_a_fisheye(tmp_path):
    camera = read(tmp_path, f"{OWN}  distortion: [0.1, 0, 0, 0]\n  distortion_model: equidistant").setup.camera
    assert camera.lens == Lens("equidistant", (0.1, 0.0, 0.0, 0.0))


def test_a_calibration_file(tmp_path):
    file = read(tmp_path, FILED)
    camera = file.setup.camera
    assert file.other_files == (tmp_path / "camera.yaml",)
    assert camera.resolution == (2448, 2048)
    assert camera.focal_length_mm == pytest.approx(4640 * 0.00345, rel=1e-15)
    fx, fy = (camera.focal_length_mm / pitch for pitch in camera.pixel_pitch_mm)
    assert (fx, fy) == pytest.approx((4640.0, 4641.0), rel=1e-15)
    assert camera.principal_point == (1220.5, 1022.25)
    assert camera.lens == Lens("radial-tangential", (-0.1, 0.02, 0.0003, -0.0002, 0.01))
    deviations = np.sqrt(np.diag(np.asarray(camera.intrinsics_covariance)))
    assert deviations == pytest.approx([0.5, 0.6, 0.7, 0.8, 1e-3, 2e-3, 1e-5, 2e-5, 3e-3], rel=1e-12)


def test_a_stated_uncertainty_is_before_the_file_s(tmp_path):
    more = "  calibration_uncertainty: {focal_length: 2 px, principal_point: 3 px}"
    camera = read(tmp_path, FILED + more).setup.camera
    assert np.diag(np.asarray(camera.intrinsics_covariance)) == pytest.approx([4, 4, 9, 9, 0, 0, 0, 0, 0])


@pytest.mark.parametrize(
    ("keys", "edge_detector"),
    [
        ("{noise: 0.1 px}", EdgeDetector(0.1)),
        ("{noise: 0 px, offset: 0.05 px}", EdgeDetector(0.0, 0.05)),
        ("{noise: 0.1 px, edge_points: 20, clear_of_corner: 5 px}", EdgeDetector(0.1, 0.0, 20, 5.0)),
        ("{signal_to_noise: 40, blur: 0.6 px}", EdgeDetector(float(edge_point_deviation(40, 0.6)))),
        (
            "{signal_to_noise: 40, blur: 0.6 px, samples: 5, smoothing: 1 px}",
            EdgeDetector(float(edge_point_deviation(40, 0.6, 5, 1.0))),
        ),
    ],
)
def test_edge_detectors(tmp_path, keys, edge_detector):
    camera = read(tmp_path, f"{OWN}  edge_detector: {keys}").setup.camera
    assert camera.edge_detector == edge_detector
    assert camera.quantization_step_mm == (0.0, 0.0)


BAD = [
    (OWN + "  edge_detector: {}", "camera.edge_detector", "the noise of an edge point is stated once"),
    (
        OWN + "  edge_detector: {noise: 0.1 px, signal_to_noise: 40, blur: 1 px}",
        "camera.edge_detector.noise",
        "stated once",
    ),
    (OWN + "  edge_detector: {noise: 0.1 px, blur: 1 px}", "camera.edge_detector.noise", "stands for blur"),
    (OWN + "  edge_detector: {signal_to_noise: 40}", "camera.edge_detector.blur", "required key missing"),
    (
        OWN + "  edge_detector: {signal_to_noise: 0, blur: 1 px}",
        "camera.edge_detector.signal_to_noise",
        "not a positive number",
    ),
    (
        OWN + "  edge_detector: {signal_to_noise: 40 dB, blur: 1 px}",
        "camera.edge_detector.signal_to_noise",
        "not a positive",
    ),
    (OWN + "  edge_detector: {noise: 0.1}", "camera.edge_detector.noise", "the unit is missing"),
    (OWN + "  edge_detector: {noise: -0.1 px}", "camera.edge_detector.noise", "must not be negative"),
    (OWN + "  edge_detector: {noise: .nan px}", "camera.edge_detector.noise", "not finite"),
    (OWN + "  edge_detector: {noise: 0.1 mm}", "camera.edge_detector.noise", "'mm' is not a unit of number of pixels"),
    (
        OWN + "  edge_detector: {noise: 0.1 px, edge_points: 1}",
        "camera.edge_detector.edge_points",
        "greater than or equal to 2",
    ),
    (OWN + "  edge_detector: {noise: 0.1 px, edge_points: 2.5}", "camera.edge_detector.edge_points", "a whole number"),
    (OWN + "  edge_detector: {nosie: 0.1 px}", "camera.edge_detector.nosie", "did you mean 'noise'?"),
    (OWN + "  edge_detector: subpixel", "camera.edge_detector", "not a section of keys"),
    (
        OWN + "  edge_detector: {noise: 0.1 px, quantization: 0.1 px}",
        "camera.edge_detector.quantization",
        "takes the place",
    ),
    (OWN + "  distortion: [0.1]", "camera.distortion", "4 or 5 or 8 or 12 numbers"),
    (OWN + "  distortion: 0.1", "camera.distortion", "not a list of numbers"),
    (OWN + "  distortion: [a, 0, 0, 0]", "camera.distortion", "not a list of numbers"),
    (OWN + "  distortion: [.nan, 0, 0, 0]", "camera.distortion", "finite"),
    (OWN + "  distortion: [-30, 0, 0, 0]", "camera.distortion", "two directions in one place"),
    (OWN + "  distortion: [0, 0, 0, 0]\n  distortion_model: fov", "camera.distortion_model", "unknown lens model"),
    (OWN + "  calibration_uncertainty: {focal_length: 1 px}", "camera.calibration_uncertainty.principal_point", "key"),
    (
        OWN + "  calibration_uncertainty: {focal_length: 1 px, principal_point: 1 px, distortion: [1]}",
        "camera.calibration_uncertainty.distortion",
        "not a standard uncertainty of each coefficient",
    ),
    (OWN + "  calibration_uncertainty: 3 px", "camera.calibration_uncertainty", "not a section of keys"),
    (OWN + "  calibration_camera: cam0", "camera.calibration_camera", "unknown key"),
    (FILED + "  focal_length: 16 mm", "camera.focal_length", "the calibration file says it"),
    (FILED + "  distortion: [0, 0, 0, 0]", "camera.distortion", "the calibration file says it"),
    (FILED + "  resolution: [640, 480]", "camera.resolution", "images of another size"),
    (FILED.replace("3.45 um", "'[3.45, 4] um'"), "camera.pixel_pitch", "of another shape"),
    (FILED.replace("camera.yaml", "none.yaml"), "camera.calibration", "does not exist"),
    (FILED.replace("camera.yaml", ""), "camera.calibration", "no value"),
    (FILED + "  calibration_camera: cam7", None, "one camera without a name"),
    (FILED + "  calibration_uncertainty: {focal_length: -1 px, principal_point: 1 px}", None, "must not be negative"),
    ("  calibration: camera.yaml", "camera.pixel_pitch", "required key missing"),
]


@pytest.mark.parametrize(("camera", "key", "telling"), BAD)
def test_what_is_wrong_is_reported_with_its_key(tmp_path, camera, key, telling):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, camera)
    assert telling in str(caught.value)
    if key is not None:
        assert caught.value.key == key


def test_a_calibration_without_a_size_needs_one(tmp_path):
    sizeless = TOPIC.replace("height: 2048\nwidth: 2448\n", "")
    with pytest.raises(InspectionFileError, match="the calibration file does not say it"):
        read(tmp_path, FILED, sizeless)
    assert read(tmp_path, FILED + "  resolution: [2448, 2048]", sizeless).setup.camera.resolution == (2448, 2048)


def test_what_is_wrong_in_the_calibration_file_is_reported_with_its_line(tmp_path):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, FILED, TOPIC.replace("plumb_bob", "fov"))
    assert caught.value.file == str(tmp_path / "camera.yaml")
    assert caught.value.line == 3
    assert "unknown distortion model" in str(caught.value)


def test_a_covariance_that_is_none_is_reported(tmp_path):
    bad = TOPIC[: TOPIC.index("intrinsics_st")] + "intrinsics_covariance: [%s]\n"
    matrix = np.eye(9)
    matrix[0, 1] = 5.0
    with pytest.raises(InspectionFileError, match="not a covariance"):
        read(tmp_path, FILED, bad % ", ".join(map(str, matrix.ravel())))
