"""Principal distance, limited fields and usable regions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import viewgauge as vg
from cases.version_2 import CASES, copy_case
from inspections import BOX, sections, write_box
from viewgauge.exceptions import InputError, InspectionFileError
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.formats.inspection.inspection_text import read_inspection_text
from viewgauge.geometry import Lens
from viewgauge.part import Mesh
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.sensors import Camera, ImageCircle, ImagePolygon
from viewgauge.visibility import ObservationLimits
from viewgauge.visibility.culling import REASONS

shared = pytest.mark.skipif(not CASES.is_dir(), reason="the shared cases are not beside this checkout")
CAMERA = Camera(35.0, (0.00345, 0.00345), (2448, 2048))


def camera_of(tmp_path, *lines):
    camera = "\n  " + "\n  ".join(["pixel_pitch: 3.45 um", "resolution: [2448, 2048]", *lines])
    (tmp_path / "i.yaml").write_text(sections(**{**BOX, "camera": camera}))
    text = read_inspection_text(tmp_path / "i.yaml")
    return read_inspection_file(text).setup.camera, [finding.name for finding in text.findings]


@pytest.mark.parametrize(("f", "u", "c"), [(16.0, 320.0, 16.8421053), (16.0, 500.0, 16.5289256), (50.0, 300.0, 60.0)])
def test_the_principal_distance_is_that_of_the_thin_lens(f, u, c):
    camera = replace(CAMERA, focal_length_mm=f, focus_distance_mm=u)  # f u/(u - f), worked by hand
    assert camera.principal_distance_mm == pytest.approx(c, rel=1e-8)
    assert camera.project([10.0, 0.0, u])[0] == pytest.approx(10 * f / (u - f))  # the magnification


def test_without_a_focus_distance_it_is_the_focal_length():
    assert CAMERA.principal_distance_mm == 35.0
    assert replace(CAMERA, focus_distance_mm=1e300).principal_distance_mm == 35.0


def test_a_calibration_is_not_corrected_again(tmp_path):
    (tmp_path / "c.yaml").write_text(
        "image_width: 2448\nimage_height: 2048\ncamera_matrix: {rows: 3, cols: 3, data: [5000, 0, 1223.5, 0, 5000, "
        "1023.5, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: "
        "[0, 0, 0, 0, 0]}\n"
    )
    camera, _ = camera_of(tmp_path, "calibration: c.yaml", "focus_distance: 300 mm", "f_number: 8")
    assert camera.principal_distance_mm / 0.00345 == pytest.approx(5000, rel=1e-12)
    assert camera.focal_length_mm == pytest.approx(1 / (1 / 300 + 1 / 17.25))


@shared
def test_a_close_up_does_not_fit(tmp_path):
    path = copy_case(CASES / "plausibility" / "close_up.yaml", tmp_path)
    inspection = vg.load(path)
    assert 44 / 200 * inspection.camera.principal_distance_mm / 0.00345 == pytest.approx(2705, abs=0.5)
    ends = inspection.camera.to_pixels(inspection.camera.project([[-22.0, 0, 200], [22.0, 0, 200]]))
    assert ends[0, 0] < -0.5
    assert ends[1, 0] > 2447.5
    # along the image's diagonal, 3192 px, it does fit: only the camera turned by about 45 deg sees it
    for viewpoint in vg.plan(inspection).viewpoints:
        assert 0.3 < abs(viewpoint.T_part_camera[0, 0]) < 0.9


@shared
@pytest.mark.parametrize(("name", "radius"), [("folds_in_the_corner.yaml", 796), ("wide_beyond_90.yaml", 472)])
def test_a_shared_lens_is_used_as_far_as_it_holds(tmp_path, name, radius):
    path = copy_case(CASES / "camera_files" / "inspection.yaml", tmp_path)
    path.write_text(path.read_text().replace("opencv.yaml", name))
    text = read_inspection_text(path)
    camera = read_inspection_file(text).setup.camera
    assert [finding.name for finding in text.findings] == ["field_limited", "not_calibrated"]
    assert camera.field_radius_px == pytest.approx(radius, abs=1)


def test_a_lens_that_turns_back_is_used_up_to_there():
    lens = Lens("radial-tangential", (-0.9, 0, 0, 0))  # r (1 - 0.9 r^2) is largest at r = 1/sqrt(2.7)
    camera = Camera(8.0, (0.00345, 0.00345), (2448, 2048), lens=lens)
    r = 1 / math.sqrt(2.7)
    assert camera.field_tangent == pytest.approx(r, rel=1e-6)
    assert camera.field_radius_px == pytest.approx(r * (1 - 0.9 * r * r) * 8 / 0.00345, rel=1e-6)
    assert np.isnan(camera.from_pixels([0.0, 0.0])).all()
    assert np.isfinite(camera.from_pixels(camera.border_px)).all()


@pytest.mark.parametrize(
    ("region", "seen"),
    [
        (None, [True, True]),
        (ImageCircle((1223.5, 1023.5), 300.0), [True, False]),
        (ImagePolygon(((1000, 800), (1500, 800), (1500, 1300), (1000, 1300))), [True, False]),
    ],
)
def test_ends_outside_the_usable_region_are_out_of_view(region, seen):
    import trimesh

    from viewgauge.geometry import look_at
    from viewgauge.part.characteristic import Characteristic
    from viewgauge.part.characteristics.point_pairs import measurand_on_mesh
    from viewgauge.visibility import Occluder, observe

    plate = trimesh.creation.box((60, 60, 2))
    mesh = Mesh(np.array(plate.vertices), np.array(plate.faces))
    pairs = [measurand_on_mesh(mesh, [-5, -5, 1], [5, -5, 1]), measurand_on_mesh(mesh, [-30, -30, 1], [30, -30, 1])]
    table = MeasurandTable.of([Characteristic("a", "measurand", 1.0, None, (pair,)) for pair in pairs])
    camera = replace(CAMERA, focal_length_mm=16.0, usable_region=region)
    T = look_at(np.array([[0, 0, 601.0]]), np.zeros((1, 3)), np.zeros(1))
    reasons = observe(T, table, camera, Occluder(mesh), ObservationLimits())[0]
    assert [REASONS[code] == "" for code in reasons] == seen
    assert all(REASONS[code] in ("", "out_of_view") for code in reasons)


def test_the_usable_region_is_stated(tmp_path):
    focal = "focal_length: 16 mm"
    camera, _ = camera_of(tmp_path, focal, "usable_region: {circle: {diameter: 6.9 mm}}")
    np.testing.assert_allclose(camera.usable_region.parameters, [1223.5, 1023.5, 1000])
    camera, _ = camera_of(tmp_path, focal, 'usable_region: {polygon: ["[0, 0] px", "[900, 0] px", "[0, 900] px"]}')
    assert camera.usable_region == ImagePolygon(((0, 0), (900, 0), (0, 900)))
    for wrong in ("{}", "{circle: {}}", "{circle: {radius: 3 deg}}", '{polygon: ["[0, 0] px", "[1, 1] px"]}'):
        with pytest.raises(InspectionFileError, match=r"camera\.usable_region"):
            camera_of(tmp_path, focal, f"usable_region: {wrong}")


def test_what_is_not_modelled_is_named(tmp_path):
    focal = "focal_length: 16 mm"
    assert camera_of(tmp_path, focal, "shutter: rolling", "colour_filter: bayer")[1] == [
        "rolling_shutter",
        "colour_filter",
    ]
    assert camera_of(tmp_path, focal, "shutter: global")[1] == []
    with pytest.raises(InspectionFileError, match="telecentric lens is not modelled"):
        camera_of(tmp_path, "telecentric: {magnification: 0.5}")


def test_a_focus_nearer_than_the_focal_length_is_refused():
    with pytest.raises(InputError, match="longer than the focal length"):
        replace(CAMERA, focus_distance_mm=35.0)


def test_near_candidates_without_a_focus_distance_are_noted(tmp_path):
    write_box(tmp_path)
    text = sections(**{**BOX, "candidates": '{distance: "[300, 400] mm"}'})
    (tmp_path / "i.yaml").write_text(text)
    assert any("no focus_distance is given" in note for note in vg.load(tmp_path / "i.yaml").part.notes)
