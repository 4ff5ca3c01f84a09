"""Rendered images against areas of polygons and plain geometry; poses of acquisitions against the errors that were
drawn.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from viewgauge.exceptions import InputError
from viewgauge.geometry import Lens, PoseError, invert, look_at, transform
from viewgauge.measurement import errors_of_poses
from viewgauge.sensors import Camera, Window
from viewgauge.simulation.displaced_poses import displaced_poses
from viewgauge.simulation.full_camera import exact_length_errors
from viewgauge.simulation.image_sensor import ImageSensor
from viewgauge.simulation.renderer import FIBONACCI, Renderer

CAMERA = Camera(12.0, (0.005, 0.005), (120, 90))
PLATE = np.array([[-4.0, -3, 0], [4, -3, 0], [4, 3, 0], [-4, 3, 0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def above(distance=250.0, roll=0.0):
    return look_at(np.array([[0.0, 0, distance]]), np.zeros((1, 3)), np.array([roll]))[0]


def clipped(polygon, axis, bound, sign):
    """Sutherland and Hodgman's clipping of a polygon (n, 2) to sign * coordinate <= sign * bound."""
    kept = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        inside = [sign * p[axis] <= sign * bound for p in (a, b)]
        if inside[0]:
            kept.append(a)
        if inside[0] != inside[1]:
            kept.append(a + (bound - a[axis]) / (b[axis] - a[axis]) * (b - a))
    return np.array(kept).reshape(-1, 2)


def area_in_pixel(polygon, u, v):
    for axis, centre in ((0, u), (1, v)):
        for bound, sign in ((centre - 0.5, -1), (centre + 0.5, 1)):
            if len(polygon) < 3:
                return 0.0
            polygon = clipped(polygon, axis, bound, sign)
    if len(polygon) < 3:
        return 0.0
    x, y = polygon.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


@pytest.mark.parametrize("roll", [0.0, 0.3, 1.1])
@pytest.mark.parametrize("rays", [34, 233])
def test_coverage_is_the_exact_area(roll, rays):
    """Of each pixel; along rows and columns to 1/N, at other angles to 2/N^(3/4)."""
    T = above(roll=roll)
    found = Renderer(PLATE, TRIANGLES, rays_per_pixel=rays).coverage(T, CAMERA)
    corners = CAMERA.to_pixels(CAMERA.project(transform(invert(T), PLATE)))
    exact = np.array([[area_in_pixel(corners, u, v) for u in range(120)] for v in range(90)])
    assert 0 < exact.sum() < 120 * 90
    assert ((exact > 0.01) & (exact < 0.99)).sum() > 100, "there are edges"
    limit = 1.5 / rays if roll == 0 else 2 / rays**0.75
    assert np.abs(found - exact).max() <= limit
    assert found.sum() == pytest.approx(exact.sum(), rel=1e-3)


@pytest.mark.parametrize(
    "lens", [Lens("radial-tangential", (-0.25, 0.1, 2e-3, -1e-3)), Lens("equidistant", (0.02, -0.01, 0.0, 0.0))]
)
def test_a_lens_bends_what_is_seen_where_the_camera_says(lens):
    """The area of a plate's image: a polygon whose sides are divided and put where the lens shows each piece."""
    wide, T = replace(CAMERA, focal_length_mm=0.5), above(distance=12.0, roll=0.3)
    camera = replace(wide, lens=lens)
    found = Renderer(PLATE, TRIANGLES, rays_per_pixel=89).coverage(T, camera)
    sides = [np.linspace(a, b, 400, endpoint=False) for a, b in zip(PLATE, np.roll(PLATE, -1, axis=0), strict=True)]
    places = camera.to_pixels(camera.project(transform(invert(T), np.concatenate(sides))))
    x, y = (places - places.mean(axis=0)).T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    straight = Renderer(PLATE, TRIANGLES, rays_per_pixel=89).coverage(T, wide).sum()
    assert abs(straight - area) > 20, "the lens matters"
    assert found.sum() == pytest.approx(area, rel=2e-4)


def test_a_window_is_a_part_of_the_image():
    renderer, T = Renderer(PLATE, TRIANGLES), above(roll=0.4)
    whole = renderer.radiance(T, CAMERA)
    window = Window(30, 20, 75, 61)
    assert (renderer.radiance(T, CAMERA, window) == whole[20:61, 30:75]).all()


def test_faces_differ_and_the_background_is_dark():
    corners = np.array([[x, y, z] for x in (-5, 5) for y in (-5, 5) for z in (-5, 5)], dtype=float)
    faces = [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]]
    triangles = np.array([t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])])
    renderer = Renderer(corners, triangles)
    T = look_at(np.array([[120.0, -180, 150]]), np.zeros((1, 3)), np.zeros(1))[0]
    image = renderer.radiance(T, CAMERA)
    values, counts = np.unique(image.round(4), return_counts=True)
    shades = values[counts > 50]
    assert len(shades) == 4, "three faces and the background"
    assert shades[0] < 0.05
    assert np.diff(shades).min() > 0.09


def test_the_paper_s_pixel_is_on_when_more_than_half_is_covered():
    light = np.array([[0.0, 0.49, 0.5, 0.51, 1.0]], dtype=np.float32)
    grey = ImageSensor(black_and_white=True).grey(light, np.random.default_rng(0))
    assert grey.tolist() == [[0, 0, 0, 255, 255]]


@pytest.mark.parametrize("bits", [8, 12])
def test_noise_blur_and_bits(bits):
    full = 2**bits - 1
    light = np.zeros((200, 400), dtype=np.float32)
    light[:, 200:] = 0.8
    clean = ImageSensor(bits=bits).grey(light, np.random.default_rng(0))
    assert set(np.unique(clean)) == {0, round(0.8 * full)}
    noisy = ImageSensor(noise=0.02, bits=bits).grey(light, np.random.default_rng(1)).astype(float)
    # 80,000 pixels: a deviation is off by 0.25 % (one sigma); rounding adds 1/12
    assert noisy[:, 200:].std() == pytest.approx(np.hypot(0.02 * full, 12**-0.5), rel=0.0125)
    blurred = ImageSensor(blur_px=3.0, bits=bits).grey(light, np.random.default_rng(2))[100].astype(float) / (
        0.8 * full
    )
    slope = np.diff(blurred)
    centre = slope @ np.arange(399) / slope.sum()
    assert centre == pytest.approx(199, abs=0.05)
    assert np.sqrt(slope @ (np.arange(399) - centre) ** 2 / slope.sum()) == pytest.approx(3.0, rel=0.02)


def test_bad_numbers_are_reported():
    for change in ({"blur_px": -1.0}, {"noise": float("nan")}, {"bits": 10}):
        with pytest.raises(InputError, match=next(iter(change))):
            ImageSensor(**change)
    with pytest.raises(InputError, match="rays"):
        Renderer(PLATE, TRIANGLES, rays_per_pixel=30)
    assert FIBONACCI[3] == 34


def test_acquisitions_are_displaced_by_the_pose_error_s_errors():
    """A segment's image length in the acquisitions follows the law drawn apart from them: Kolmogorov and Smirnov,
    1e-3.
    """
    error = PoseError.from_standard_deviations((0.2, 0.1, 0.4), (1e-3, 2e-3, 5e-4), pivot_mm=(10, -20, -60))
    viewpoint = look_at(np.array([[90.0, -60, 220]]), np.zeros((1, 3)), np.array([0.3]))[0]
    poses = displaced_poses(viewpoint, error, 3000, np.random.default_rng(4))
    assert errors_of_poses(viewpoint @ error.T_camera_frame, poses @ error.T_camera_frame).std(axis=0) == pytest.approx(
        np.sqrt(error.covariance.diagonal()), rel=0.06
    )
    ends = np.array([[-30.0, 5, 4], [25, -12, 0]])
    seen = CAMERA.project(transform(invert(poses)[:, None], ends))
    length = np.linalg.norm(seen[:, 1] - seen[:, 0], axis=1)
    nominal = np.linalg.norm(np.diff(CAMERA.project(transform(invert(viewpoint), ends)), axis=0))
    twist = np.random.default_rng(9).standard_normal((100_000, 6)) @ error.factor.T
    expected = exact_length_errors(transform(invert(viewpoint), ends), CAMERA, error, twist, np.zeros((100_000, 2)))
    assert kstest(length - nominal, expected).pvalue > 1e-3


def test_what_acquisitions_share_is_drawn_once():
    common = np.diag([0.5, 0.5, 0.5, 1e-3, 1e-3, 1e-3]) ** 2
    own = common / 100
    error = PoseError(common + own, common_covariance=common)
    viewpoint = above()
    errors = errors_of_poses(
        np.broadcast_to(viewpoint, (200, 4, 4)), displaced_poses(viewpoint, error, 200, np.random.default_rng(2))
    )
    assert errors.std(axis=0) == pytest.approx(np.sqrt(own.diagonal()), rel=0.25)
    assert np.abs(errors.mean(axis=0)).max() > 3 * errors.std(axis=0)[0]
