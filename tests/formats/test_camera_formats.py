"""Calibrations under the names, orders and forms that programs write; every key used, harmless, or named."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

from viewgauge.exceptions import InputError, InspectionFileError
from viewgauge.formats.cameras.camera_file import CameraFile, Stated
from viewgauge.formats.cameras.camera_formats import read_camera_file
from viewgauge.formats.cameras.writing.camera_writers import CAMERA_WRITERS
from viewgauge.geometry import Lens
from viewgauge.jobs.calibration import read_calibration

K = [[1400.5, 0, 801.25], [0, 1401.5, 603.5], [0, 0, 1]]
ROW = [value for row in K for value in row]
FIVE = [-0.2, 0.08, 0.0003, -0.0002, 0.01]
SIZE = (1600, 1200)


def read(tmp_path, content, stated=None, name="camera.yaml"):
    path = tmp_path / name
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return read_camera_file(path, stated)


def require_this_camera(found, size=None):
    assert found.focal_length_px == (1400.5, 1401.5)
    assert found.principal_point_px == (801.25, 603.5)
    assert found.lens == Lens("radial-tangential", tuple(FIVE))
    assert found.resolution == size


@pytest.mark.parametrize(
    "matrix", ["camera_matrix", "cameraMatrix", "Camera-Matrix", "K", "mtx", "intrinsic", "intrinsics"]
)
@pytest.mark.parametrize(
    "distortion", ["dist_coeff", "dist_coeffs", "distortion_coefficients", "distortion_coeffs", "D", "dist", "distCoef"]
)
def test_names_of_matrix_and_coefficients(tmp_path, matrix, distortion):
    require_this_camera(read(tmp_path, {matrix: K, distortion: FIVE}))


@pytest.mark.parametrize(
    "values", [K, ROW, {"rows": 3, "cols": 3, "data": ROW}, {"data": K}, [1400.5, 1401.5, 801.25, 603.5]]
)
@pytest.mark.parametrize("coefficients", [FIVE, [FIVE], [[c] for c in FIVE], [[[c] for c in FIVE]], {"data": [FIVE]}])
def test_forms_of_matrix_and_coefficients(tmp_path, values, coefficients):
    require_this_camera(read(tmp_path, {"K": values, "D": coefficients}))


@pytest.mark.parametrize(
    "size",
    [
        {"width": 1600, "height": 1200},
        {"image_size": [1600, 1200]},
        {"DIM": [1600, 1200]},
        {"resolution": {"width": 1600, "height": 1200}},
        {"shape": [1200, 1600, 3]},
        {"img_width": 1600, "img_height": 1200, "size": [1600, 1200]},
    ],
)
def test_names_of_the_size(tmp_path, size):
    require_this_camera(read(tmp_path, {"K": K, "D": FIVE, **size}), SIZE)


BY_NAME = {"k1": -0.2, "k2": 0.08, "p1": 0.0003, "p2": -0.0002, "k3": 0.01}
NUMBERS = {"fx": 1400.5, "fy": 1401.5, "cx": 801.25, "cy": 603.5}


@pytest.mark.parametrize(
    "content",
    [
        {**NUMBERS, **BY_NAME},
        {"focal_length": [1400.5, 1401.5], "principal_point": [801.25, 603.5], "D": FIVE},
        {"calibration": {"intrinsics": NUMBERS, "distortion": BY_NAME}},
        {"intrinsics": NUMBERS, "distortion": {"model": "plumb_bob", "coefficients": FIVE}},
        {f"Camera.{key}": value for key, value in {**NUMBERS, **BY_NAME}.items()},
        {"model_type": "PINHOLE", "projection_parameters": NUMBERS, "distortion_parameters": BY_NAME},
        {"K": K, **NUMBERS, "D": FIVE, "focal_length_mm": 12, "calibration_date": "today", "board_width": 9, "R": K},
        {"intrinsics": {"K": K}, "distortion": {"type": "radtan", "parameters": {"rows": 5, "cols": 1, "data": FIVE}}},
    ],
    ids=range(8),
)
def test_numbers_of_their_own_and_sections(tmp_path, content):
    require_this_camera(read(tmp_path, content))


STEREO = {"M1": K, "D1": FIVE, "M2": [[900, 0, 800], [0, 900, 600], [0, 0, 1]], "D2": [0.1, 0, 0, 0, 0]}


@pytest.mark.parametrize(
    ("content", "names"),
    [
        (
            {**STEREO, "R": K, "T": [1, 0, 0], "E": K, "F": K, "R1": K, "P1": K, "Q": K, "size": [1600, 1200]},
            ("1", "2"),
        ),
        ({"camera_matrix_left": K, "dist_left": FIVE, "camera_matrix_right": K, "dist_right": FIVE}, ("left", "right")),
        ({"left": {"K": K, "D": FIVE}, "right": {"K": K, "D": FIVE}, "baseline": 0.1}, ("left", "right")),
        ([{"name": "a", "K": K, "D": FIVE}, {"name": "b", "K": K, "D": FIVE}], ("a", "b")),
    ],
    ids=range(4),
)
def test_several_cameras_are_asked_for_by_name(tmp_path, content, names):
    with pytest.raises(InspectionFileError, match="several cameras") as caught:
        read(tmp_path, content)
    assert caught.value.expected == " or ".join(names)
    require_this_camera(read(tmp_path, content, names[0]), SIZE if "size" in content else None)


@pytest.mark.parametrize(
    "key", ["dist_polynomial", "lens_shift", "focal_scale", "xi", "radial_correction", "binning", "crop", "Distorted_K"]
)
def test_an_unknown_key_is_named(tmp_path, key):
    with pytest.raises(InspectionFileError, match="not known here") as caught:
        read(tmp_path, {"K": K, "D": FIVE, key: [1.5]})
    assert caught.value.key == key


def test_a_key_beside_the_camera_is_named_too(tmp_path):
    with pytest.raises(InspectionFileError, match="not known here") as caught:
        read(tmp_path, {"cam": {"K": K, "D": FIVE}, "image_scale": 0.5})
    assert caught.value.key == "image_scale"


BAD = [
    ({"K": K, "D": FIVE, "dist": [0.1, 0, 0, 0, 0]}, "differently"),
    ({"K": K, "fx": 1300, "D": FIVE}, "differently in the matrix"),
    ({"K": K, "D": FIVE, "width": 1600}, "only one side"),
    ({"K": K, "D": FIVE, "width": 1600, "height": 1200, "image_size": [1200, 1600]}, "two sizes"),
    ({"K": [[0.9, 0, 0.5], [0, 1.2, 0.5], [0, 0, 1]], "D": FIVE}, "no focal length in px"),
    ({"K": [[1400, 0, 800], [0, 1400, 600], [0, 0, 2]], "D": FIVE}, "not a camera matrix"),
    ({"K": [0] * 9, "D": []}, "not a camera matrix"),
    ({"K": K, "D": [0.1, 0, 0, 0], "distortion_model": "plumb_bob", "fisheye": True}, "two models"),
    ({"K": K, "D": FIVE, "distortion_model": "none"}, "without distortion"),
    ({"K": K, "D": FIVE, "distortion_model": "fov"}, "unknown distortion model"),
    ({"K": K, "D": FIVE, "skew": 0.3}, "skew"),
    ({"fx": 1400, "fy": 1400, "cx": 800, "D": FIVE}, "missing"),
    ({"K": K, "D": FIVE, "binning_x": 1.5}, "not a binning"),
    ({"K": K, "D": FIVE, "size": SIZE, "roi": {"x_offset": 1000, "width": 800, "height": 2}}, "beyond"),
    ({"K": K, "D": FIVE, "roi": {"x_offset": 1, "angle": 3}}, "not known here"),
    ("[a]\nfx=1400\nfy=1400\ncx=800\ncy=600\nk1=0.1\n[odd]\nq=1\n", "section is not known"),
    ("[a]\nfx=1400\nfx=1300\n", "twice"),
    ("1 FOV 3000 2000 2600 2600 1500 1000 0.9\n", "unknown camera model"),
    ("1 PINHOLE 3000 2000 2600 2600\n", "another number of parameters"),
    ("{'lensmodel': 'LENSMODEL_CAHVOR', 'intrinsics': [1], 'imagersize': [4, 3]}", "CAHVOR"),
    ("{'lensmodel': 'LENSMODEL_OPENCV4', 'intrinsics': (", "not valid syntax"),
    ("<!DOCTYPE a><opencv_storage></opencv_storage>", "document type"),
    ("<opencv_storage><a></opencv_storage>", "not valid XML"),
    ("a: 1\n---\na: 2\n", "documents that differ"),
    ("ParGroup: P:\nFocus:f: 12;\nSx:s: 2e-6;\nSy:s: 2e-6;\nCx:c: 9;\nCy:c: 8;\nImageWidth:w: 9;\nImageHeight:h: 9;\n",
     "not a focal length in m"),
    ("ParGroup: P:\nMagnification:m: 0.3;\n", "telecentric"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "telling"), BAD)
def test_what_cannot_be_used_is_refused(tmp_path, content, telling):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, content)
    assert telling in str(caught.value)
    assert "camera.yaml" in str(caught.value)


def test_four_coefficients_are_asked_for_with_a_proposal(tmp_path):
    wide = {"K": [[430, 0, 800], [0, 430, 600], [0, 0, 1]], "D": [0.01, -0.002, 0.03, 0.02], "DIM": SIZE}
    with pytest.raises(InspectionFileError, match="does not say of which model") as caught:
        read(tmp_path, wide)
    assert "Probably fisheye" in str(caught.value.hint)
    assert read(tmp_path, wide, Stated(model="fisheye")).lens == Lens("equidistant", (0.01, -0.002, 0.03, 0.02))
    assert read(tmp_path, wide, Stated(model="radtan")).lens.model == "radial-tangential"
    assert read(tmp_path, {**wide, "fisheye_model": 1}).lens.model == "equidistant"
    with pytest.raises(InspectionFileError, match="another model"):
        read(tmp_path, {**wide, "fisheye_model": 1}, Stated(model="radtan"))
    with pytest.raises(InspectionFileError, match="not a lens model"):
        read(tmp_path, wide, Stated(model="good"))


IMPLAUSIBLE = [
    ({"K": K, "D": FIVE, "width": 1200, "height": 1600}, "principal_point", "exchanged", False),
    ({"K": K, "D": FIVE, "width": 1280, "height": 960}, "principal_point", "1600 x 1200", False),
    ({"fx": 1400, "fy": 1400, "cx": 1.5, "cy": -2, "D": FIVE, "width": 1600, "height": 1200}, "principal_point",
     "from the middle", True),
    ({"K": [[12, 0, 3.6], [0, 12, 2.7], [0, 0, 1]], "D": FIVE, "size": SIZE}, "field_of_view", "in mm", True),
    ({"K": [[1400, 0, 800], [0, 1050, 600], [0, 0, 1]], "D": FIVE}, "focal_length_ratio", "4:3", False),
    ({"K": K, "D": [-0.2, 0.08, 0.02, 0.001, 0.001]}, "tangential_distortion", "another order", False),
    ({"K": [[700, 0, 800], [0, 700, 600], [0, 0, 1]], "D": [-0.2, 0, 0, 0, 0]}, "lens_turns_back",
     "another model", True),
    ({"K": K}, "no_distortion", "left out", False),
    ({"K": np.transpose(K).tolist(), "D": FIVE}, "transposed_matrix", "MATLAB", True),
]  # fmt: skip


@pytest.mark.parametrize(("content", "name", "cause", "refused"), IMPLAUSIBLE)
def test_what_no_calibration_has_is_a_finding(tmp_path, content, name, cause, refused):
    (finding,) = read(tmp_path, content).findings
    assert (finding.name, finding.refused) == (name, refused)
    assert cause in finding.cause
    if refused:
        with pytest.raises(InputError, match=name):
            read_calibration(tmp_path / "camera.yaml")
        assert read_calibration(tmp_path / "camera.yaml", None, [name]).findings == ()


def test_binning_and_region(tmp_path):
    content = {"K": ROW, "D": FIVE, "distortion_model": "plumb_bob", "width": 1600, "height": 1200}
    part = {"roi": {"x_offset": 200, "y_offset": 100, "width": 800, "height": 600, "do_rectify": True}}
    found = read(tmp_path, {**content, **part, "binning_x": 4, "binning_y": 2})
    # the centre of four binned pixels 0 to 3 is at 1.5: ((x - 200) - 1.5) / 4
    assert found.focal_length_px == (1400.5 / 4, 1401.5 / 2)
    assert found.principal_point_px == ((601.25 - 1.5) / 4, (503.5 - 0.5) / 2)
    assert found.resolution == (200, 300)
    assert not found.findings  # the principal point is where the whole image's is


def halcon(**values):
    usual = {
        "Focus": 0.0124,
        "Sx": 2.4e-6,
        "Sy": 2.4e-6,
        "Cx": 1230.4,
        "Cy": 1019.2,
        "ImageWidth": 2448,
        "ImageHeight": 2048,
    }
    lines = [f'{name}:x: {value!r};\n\tDESCR = "a value";\n' for name, value in {**usual, **values}.items()]
    return 'ParGroup: Parameters:\n    "Internal camera parameters";\n\n' + "".join(lines)


@pytest.mark.parametrize(
    "values", [{"Kappa": -500.0}, {"Kappa": 800.0}, {"K1": 400.0, "K2": 2e6, "P1": 0.005, "P2": -0.01}]
)
def test_halcon_from_the_sensor_to_the_ray(tmp_path, values):
    """By HALCON's formulas, in m on the sensor."""
    found = read(tmp_path, halcon(**values), name="camera.cal")
    pixels = np.random.default_rng(5).uniform([0, 0], [2448, 2048], (200, 2))
    u, v = (pixels - [1230.4, 1019.2]).T * 2.4e-6
    r2 = u**2 + v**2
    if "Kappa" in values:
        flat = np.stack([u, v]) / (1 + values["Kappa"] * r2)
    else:
        radial = 1 + values["K1"] * r2 + values["K2"] * r2**2
        P1, P2 = values["P1"], values["P2"]
        flat = np.stack([
            u * radial + P1 * (r2 + 2 * u**2) + 2 * P2 * u * v, v * radial + 2 * P1 * u * v + P2 * (r2 + 2 * v**2)
        ])  # fmt: skip
    seen = found.lens.distort(flat.T / 0.0124) * found.focal_length_px + found.principal_point_px
    assert np.abs(seen - pixels).max() < 0.01
    assert "converted" in found.notes[0]


@pytest.mark.parametrize("model", ["inverse_brown_conrady", "modified_brown_conrady"])
def test_realsense_models_are_converted(tmp_path, model):
    c = [-0.05, 0.06, 2e-5, -3e-5, 0.0]  # a larger tangential part of an inverse model is refused
    content = {
        "width": 1280,
        "height": 720,
        "fx": 920.0,
        "fy": 919.0,
        "ppx": 640.5,
        "ppy": 361.5,
        "model": model,
        "coeffs": c,
    }
    found = read(tmp_path, content, name="camera.json")
    x, y = np.random.default_rng(6).uniform([-0.6, -0.35], [0.6, 0.35], (200, 2)).T
    r2 = x**2 + y**2
    f = 1 + c[0] * r2 + c[1] * r2**2 + c[4] * r2**3
    a, b = (x * f, y * f) if model == "modified_brown_conrady" else (x, y)
    out = np.stack(
        [x * f + 2 * c[2] * a * b + c[3] * (r2 + 2 * a**2), y * f + 2 * c[3] * a * b + c[2] * (r2 + 2 * b**2)], 1
    )
    rays, places = (np.stack([x, y], 1), out) if model == "modified_brown_conrady" else (out, np.stack([x, y], 1))
    assert np.abs(found.lens.distort(rays) - places).max() * 920 < 0.01
    with pytest.raises(InspectionFileError, match="size"):
        read(tmp_path, {key: value for key, value in content.items() if key not in ("width", "height")})


def test_matlab_and_open3d(tmp_path):
    matlab = {"IntrinsicMatrix": np.transpose(K).tolist(), "RadialDistortion": FIVE[:2], "ImageSize": [1200, 1600]}
    found = read(tmp_path, matlab)
    assert found.principal_point_px == (800.25, 602.5)
    assert (found.resolution, found.format) == (SIZE, "MATLAB")
    assert found.lens == Lens("radial-tangential", (-0.2, 0.08, 0.0, 0.0))
    newer = {"K": K, "FocalLength": [1400.5, 1401.5], "PrincipalPoint": [801.25, 603.5], "Skew": 0}
    assert read(tmp_path, {**newer, "RadialDistortion": FIVE[:2]}).principal_point_px == (800.25, 602.5)
    flat = {"width": 1600, "height": 1200, "intrinsic_matrix": np.transpose(K).reshape(-1).tolist()}
    assert read(tmp_path, flat).principal_point_px == (801.25, 603.5)


@pytest.mark.parametrize("suffix", [".yml", ".json", ".xml"])
@pytest.mark.parametrize("count", [5, 8, 12])
def test_what_opencv_writes_in_each_of_its_forms(tmp_path, suffix, count):
    coefficients = np.r_[FIVE, np.full(count - 5, 1e-3)]
    path = tmp_path / f"camera{suffix}"
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in (("image_Width", 1600), ("image_Height", 1200), ("Camera_Matrix", np.array(K, dtype=float))):
        file.write(name, value)
    file.write("calibration_Time", "Mon 1 Jan 2024 10:00:00")
    file.write("Distortion_Coefficients", coefficients[:, None])
    file.release()
    found = read_camera_file(path)
    assert found.lens == Lens("radial-tangential", tuple(coefficients))
    assert found.resolution == SIZE


CAMERAS = {
    "none": None,
    "four": Lens("radial-tangential", (-0.2, 0.08, 0.0003, -0.0002)),
    "five": Lens("radial-tangential", tuple(FIVE)),
    "eight": Lens("radial-tangential", (*FIVE, 1e-3, 2e-3, 1e-3)),
    "fisheye": Lens("equidistant", (0.01, -0.002, 0.003, -0.001)),
}
CANNOT = {("kalibr", "five"), ("kalibr", "eight")}


@pytest.mark.parametrize("target", CAMERA_WRITERS)
@pytest.mark.parametrize("lens", CAMERAS)
def test_what_is_written_is_read_back(tmp_path, target, lens):
    camera = CameraFile("x", (1400.5, 1401.5), (801.25, 603.5), CAMERAS[lens], SIZE, None)
    path = tmp_path / "written.txt"
    if (target, lens) in CANNOT:
        with pytest.raises(InputError, match="no lens with these coefficients"):
            CAMERA_WRITERS[target].write(path, camera)
        return
    CAMERA_WRITERS[target].write(path, camera)
    found = read_camera_file(path)
    assert (found.focal_length_px, found.principal_point_px) == ((1400.5, 1401.5), (801.25, 603.5))
    assert found.resolution == SIZE
    points = np.random.default_rng(4).uniform(-0.5, 0.5, (20, 2))
    same = [points if each is None else each.distort(points) for each in (found.lens, CAMERAS[lens])]
    np.testing.assert_allclose(same[0], same[1], rtol=0, atol=1e-14)


def test_a_size_that_a_format_needs(tmp_path):
    camera = CameraFile("x", (1400.5, 1401.5), (801.25, 603.5), None, None, None)
    with pytest.raises(InputError, match="needs the size"):
        CAMERA_WRITERS["ros"].write(tmp_path / "x.yaml", camera)
