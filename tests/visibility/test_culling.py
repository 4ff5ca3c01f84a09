"""The compiled culling against the conditions written out in NumPy."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.geometry import VIEWS, invert, look_at, transform, view_block
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.sensors import Camera
from viewgauge.visibility import REASONS, VISIBLE, Culling, ObservationLimits


def reference(T_part_camera, measurands: MeasurandTable, camera: Camera, limits: ObservationLimits, slack: float):
    """``(n, g)`` reasons, with every threshold moved by a relative slack against (negative) or for the measurand."""
    points = transform(invert(T_part_camera)[:, None, None], measurands.points)
    with np.errstate(invalid="ignore"):
        pixels = camera.to_pixels(camera.project(points))
        low, high = limits.margin_px - 0.5, np.asarray(camera.resolution) - 0.5 - limits.margin_px
        reach = slack * np.asarray(camera.resolution)
        sight = T_part_camera[:, None, None, :3, 3] - measurands.points
        sight = sight / np.maximum(np.linalg.norm(sight, axis=-1, keepdims=True), 1e-300)
        cosine = np.einsum("ngec,gekc->ngek", sight, measurands.normals)
        cosine = np.where((measurands.normals != 0).any(axis=-1), cosine, -2.0)  # padding faces nobody
        length = np.linalg.norm(pixels[..., 1, :] - pixels[..., 0, :], axis=-1)
        conditions = (
            (points[..., 2] > -slack).all(axis=-1),
            ((pixels >= low - reach) & (pixels <= high + reach)).all(axis=(-1, -2)),
            (cosine > np.sin(limits.grazing_angle_rad) - slack).any(axis=-1).all(axis=-1),
            length >= limits.minimum_length_px * (1 - slack),
            (camera.blur_px(points[..., 2]) <= camera.blur_limit_px * (1 + slack)).all(axis=-1),
        )
    reason = np.full(length.shape, VISIBLE, dtype=np.int8)
    for code in reversed(range(len(conditions))):
        reason[~conditions[code]] = code
    return reason


def random_measurands(rng: np.random.Generator, count: int) -> MeasurandTable:
    normals = rng.normal(size=(count, 2, 3, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals[rng.random((count, 2, 3)) < 0.3] = 0.0  # also without any: it never faces
    normals = np.take_along_axis(normals, (normals == 0).all(-1).argsort(axis=-1, kind="stable")[..., None], axis=2)
    points = rng.uniform(-30, 30, (count, 2, 3))
    points[:: max(1, count // 3), 1] = points[:: max(1, count // 3), 0]  # of no length
    return MeasurandTable(points, normals, np.zeros(count, dtype=bool), np.arange(count), np.arange(count))


@given(
    seed=st.integers(0, 2**32 - 1),
    viewpoints=st.integers(1, VIEWS),
    grazing=st.sampled_from([0.0, 0.2, 1.2]),
    shortest=st.sampled_from([0.0, 40.0, 900.0]),
    aperture=st.sampled_from([None, 2.0, 8.0]),
    principal=st.sampled_from([None, (700.0, 900.5)]),
)
def test_every_reason_is_that_of_the_conditions_written_out(seed, viewpoints, grazing, shortest, aperture, principal):
    rng = np.random.default_rng(seed)
    measurands = random_measurands(rng, 7)
    camera = Camera(
        16.0,
        (0.00345, 0.005),
        (2448, 2048),
        principal_point_px=principal,
        f_number=aperture,
        focus_distance_mm=None if aperture is None else 250.0,
        blur_limit_px=2.0,
    )
    limits = ObservationLimits(margin_px=5.0, minimum_length_px=shortest, grazing_angle_rad=grazing)
    eyes = rng.normal(size=(viewpoints, 3)) * rng.uniform(20, 400, (viewpoints, 1))
    poses = look_at(eyes, rng.uniform(-40, 40, (viewpoints, 3)), rng.uniform(0, 6, viewpoints))
    ours = Culling(measurands, camera, limits).reasons(view_block(poses), viewpoints)[:, :viewpoints].T
    strict, lenient = (reference(poses, measurands, camera, limits, slack) for slack in (-1e-9, 1e-9))
    clear = strict == lenient  # not within rounding of a threshold
    assert clear.mean() > 0.9
    np.testing.assert_array_equal(ours[clear], strict[clear])


def test_the_property_test_meets_every_reason():
    rng = np.random.default_rng(3)
    measurands = random_measurands(rng, 200)
    camera = Camera(16.0, (0.00345, 0.005), (2448, 2048), f_number=2.0, focus_distance_mm=250.0, blur_limit_px=2.0)
    eyes = rng.normal(size=(VIEWS, 3)) * rng.uniform(20, 400, (VIEWS, 1))
    poses = look_at(eyes, rng.uniform(-40, 40, (VIEWS, 3)))
    limits = ObservationLimits(minimum_length_px=200.0)
    found = np.unique(Culling(measurands, camera, limits).reasons(view_block(poses), VIEWS))
    assert {REASONS[k] for k in found} == set(REASONS) - {"occluded"}
