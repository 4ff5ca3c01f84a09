"""The pinhole camera: projection, pixels, focus."""

import math

import numpy as np
import pytest

import viewgauge as vg

CAMERA = {"focal_length_mm": 16.0, "pixel_pitch_mm": (0.004, 0.005), "resolution": (640, 481)}


def camera(**changes):
    return vg.Camera(**{**CAMERA, **changes})


def test_a_point_images_where_its_ray_meets_the_image_plane():
    # the ray t * p meets the plane z = f at t = f / Z; u to the right and v down, like x and y
    point = np.array([30.0, -20.0, 400.0])
    t = 16.0 / 400.0
    np.testing.assert_allclose(camera().project(point), (t * point)[:2], rtol=1e-15)
    np.testing.assert_array_equal(camera().project([0.0, 0.0, 123.0]), [0, 0])


def test_points_at_or_behind_the_centre_of_projection_have_no_image():
    image = camera().project([[1.0, 1, 0], [1, 1, -5], [0, 0, 0], [1, 1, math.nan], [1, 1, 5]])
    assert np.isnan(image[:4]).all()
    assert np.isfinite(image[4]).all()


def test_projection_keeps_the_shape_of_arrays():
    points = np.random.default_rng(1).uniform(1, 9, (4, 2, 3))
    image = camera().project(points)
    assert image.shape == (4, 2, 2)
    np.testing.assert_array_equal(image[3, 1], camera().project(points[3, 1]))


def test_pixel_zero_is_the_centre_of_the_top_left_pixel():
    cam = camera()
    # the sensor is 640 x 0.004 by 481 x 0.005 mm, centred: its top-left corner lies half a pixel before (0, 0)
    np.testing.assert_allclose(cam.to_pixels([-1.28, -1.2025]), [-0.5, -0.5], atol=1e-12)
    np.testing.assert_allclose(cam.to_pixels([1.28, 1.2025]), [639.5, 480.5], atol=1e-12)
    assert cam.principal_point == (319.5, 240.0)


def test_a_stated_principal_point_shifts_the_pixels():
    cam = camera(principal_point_px=(300.0, 250.25))
    np.testing.assert_allclose(cam.to_pixels([[0, 0], [0.004, -0.005]]), [[300, 250.25], [301, 249.25]])


def test_half_the_view_ends_at_the_rim_of_the_outer_pixels():
    cam = camera()
    u, v = cam.half_field_of_view_rad
    rim = cam.to_pixels(cam.project([1000 * math.tan(u), 1000 * math.tan(v), 1000.0]))
    np.testing.assert_allclose(rim, [639.5, 480.5], rtol=1e-12)


def test_edge_resolution_scales_the_pitch_in_quantization_only():
    fine = camera(edge_resolution_px=0.1)
    np.testing.assert_allclose(fine.quantization_step_mm, [0.0004, 0.0005])
    assert camera().quantization_step_mm == (0.004, 0.005)
    assert camera(edge_resolution_px=0).quantization_step_mm == (0, 0)
    np.testing.assert_array_equal(fine.to_pixels([1, 1]), camera().to_pixels([1, 1]))


def blur_by_rays(f, n, focus, depth, pitch):
    """Trace the two marginal rays of a point on the axis through a thin lens to the sensor, px."""
    sensor = 1 / (1 / f - 1 / focus)  # where a point at the focus distance is sharp
    heights = []
    for rim in (f / n / 2, -f / n / 2):
        slope = rim / depth - rim / f  # of the ray after the lens
        heights.append(rim + slope * sensor)
    return abs(heights[0] - heights[1]) / pitch


@pytest.mark.parametrize("depth", [40.0, 250.0, 399.0, 400.0, 401.0, 900.0, 1e7])
@pytest.mark.parametrize(("f", "n", "focus"), [(16.0, 8.0, 400.0), (50.0, 2.8, 300.0), (25.0, 16.0, 26.0)])
def test_blur_is_the_width_of_the_cone_of_rays_at_the_sensor(depth, f, n, focus):
    cam = camera(focal_length_mm=f, f_number=n, focus_distance_mm=focus)
    # atol: the traced heights cancel near focus
    assert cam.blur_px(depth) == pytest.approx(blur_by_rays(f, n, focus, depth, 0.004), rel=1e-12, abs=1e-9)


def test_blur_in_special_places():
    cam = camera(f_number=4.0, focus_distance_mm=400.0)
    np.testing.assert_array_equal(cam.blur_px([400.0, 0.0, -1.0]), [0, np.inf, np.inf])
    assert cam.blur_px(np.ones((2, 3))).shape == (2, 3)
    np.testing.assert_array_equal(camera().blur_px([1.0, 1e9]), [0, 0])  # no aperture stated: all in focus


@pytest.mark.parametrize(
    ("changes", "telling"),
    [
        ({"focal_length_mm": 0}, "focal_length_mm"),
        ({"focal_length_mm": -16.0}, "focal_length_mm"),
        ({"focal_length_mm": math.nan}, "focal_length_mm"),
        ({"focal_length_mm": "16 mm"}, "focal_length_mm"),
        ({"pixel_pitch_mm": (0.004, 0.0)}, "pixel_pitch_mm"),
        ({"pixel_pitch_mm": (math.inf, 0.004)}, "pixel_pitch_mm"),
        ({"pixel_pitch_mm": 0.004}, "two finite numbers"),
        ({"pixel_pitch_mm": (0.004,)}, "two finite numbers"),
        ({"resolution": (640, 0)}, "whole numbers"),
        ({"resolution": (640.5, 480)}, "whole numbers"),
        ({"resolution": (640, math.nan)}, "resolution"),
        ({"resolution": (math.inf, 480)}, "resolution"),
        ({"resolution": 640}, "resolution"),
        ({"edge_resolution_px": -0.1}, "edge_resolution_px"),
        ({"edge_resolution_px": math.nan}, "edge_resolution_px"),
        ({"principal_point_px": (1.0, math.nan)}, "principal_point_px"),
        ({"principal_point_px": 3}, "principal_point_px"),
        ({"blur_limit_px": 0}, "blur_limit_px"),
        ({"f_number": 8.0}, "focus distance"),
        ({"f_number": 0.0, "focus_distance_mm": 400.0}, "f_number"),
        ({"f_number": 8.0, "focus_distance_mm": 16.0}, "longer than the focal length"),
    ],
)
def test_an_impossible_camera_is_refused_by_the_name_of_what_is_wrong(changes, telling):
    with pytest.raises(vg.InputError, match=telling):
        camera(**changes)
