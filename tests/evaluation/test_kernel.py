"""The compiled kernel and columns against the joint model in NumPy, and against 25 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.evaluation import image_segment
from viewgauge.evaluation.compiled.kernel import ProbabilityKernel
from viewgauge.evaluation.compiled.pair_columns import PairColumns
from viewgauge.evaluation.validity import _sizes
from viewgauge.geometry import VIEWS, PoseError, invert, look_at, transform, view_block
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.sensors import Camera
from viewgauge.visibility import VISIBLE

CAMERA = Camera(16.0, (0.00345, 0.0055), (2448, 2048), edge_resolution_px=0.5)


def random_pose_error(rng: np.random.Generator, size: float) -> PoseError:
    """A full 6x6 covariance, of any rank from 0 to 6, in a pose error frame turned and shifted against the camera's."""
    mixing = rng.normal(size=(6, 6)) @ np.diag(rng.random(6) < 0.8)
    scale = size * np.array([0.1, 0.1, 0.1, 3e-4, 3e-4, 3e-4])
    pose = look_at(rng.uniform(10, 80, 3), rng.uniform(-5, 5, 3), 0.3)
    return PoseError((scale[:, None] * mixing) @ (scale[:, None] * mixing).T, T_camera_frame=pose)


def random_pairs(rng: np.random.Generator, viewpoints: int, count: int):
    points = rng.uniform(-40, 40, (count, 2, 3))
    normals = np.zeros((count, 2, 1, 3))
    measurands = MeasurandTable(points, normals, np.zeros(count, dtype=bool), np.arange(count), np.arange(count))
    eyes = rng.normal(size=(viewpoints, 3))
    eyes *= rng.uniform(150, 600, (viewpoints, 1)) / np.linalg.norm(eyes, axis=1, keepdims=True)
    return measurands, look_at(eyes, rng.uniform(-40, 40, (viewpoints, 3)), rng.uniform(0, 6, viewpoints))


def all_visible(measurands: MeasurandTable):
    return np.full((len(measurands), VIEWS), VISIBLE, dtype=np.int8)


@given(
    seed=st.integers(0, 2**32 - 1),
    viewpoints=st.integers(1, VIEWS),
    size=st.sampled_from([0.0, 1e-3, 0.1, 1.0, 30.0]),
    tolerance=st.sampled_from([0.0, 1e-5, 1e-3, 0.02, 3.0]),
)
def test_the_kernel_is_the_joint_model_in_numpy(seed, viewpoints, size, tolerance):
    rng = np.random.default_rng(seed)
    pose_error = random_pose_error(rng, size)
    measurands, poses = random_pairs(rng, viewpoints, 40)  # more than a tile
    T = tolerance * rng.uniform(0.5, 2, len(measurands))
    kernel = ProbabilityKernel(measurands, T, CAMERA, pose_error)
    probability, margin = kernel.probabilities(view_block(poses), viewpoints, all_visible(measurands))
    points = transform(invert(poses)[:, None, None], measurands.points)
    image = image_segment(points[..., 0, :], points[..., 1, :], CAMERA, pose_error)
    law = image.total_error()
    np.testing.assert_allclose(probability[:, :viewpoints].T, image.success_probability(T), rtol=0, atol=2e-11)
    expected = np.divide((T * image.length_mm) ** 2, law.var(), out=np.zeros(law.var().shape), where=law.var() > 0)
    np.testing.assert_allclose(margin[:, :viewpoints].T, expected, rtol=1e-6)


def test_pairs_that_are_not_visible_count_nothing():
    rng = np.random.default_rng(4)
    measurands, poses = random_pairs(rng, 100, 70)
    reason = rng.integers(0, VISIBLE + 1, (70, VIEWS)).astype(np.int8)
    reason[5] = 2
    kernel = ProbabilityKernel(measurands, np.full(70, 0.01), CAMERA, random_pose_error(rng, 1.0))
    some, margin = kernel.probabilities(view_block(poses), 100, reason)
    every, _ = kernel.probabilities(view_block(poses), 100, all_visible(measurands))
    seen = reason[:, :100] == VISIBLE
    np.testing.assert_array_equal(some[:, :100], np.where(seen, every[:, :100], 0.0))
    assert (margin[:, :100][~seen] == 0).all()


def along_the_axes():
    """Poses and measurands whose images lie along u, along v, nearly so, and at 45 degrees."""
    angles = np.deg2rad([0.0, 90.0, 1e-9, 90 - 1e-7, 1e-4, 45.0, 30.0])
    points = np.array([[[0, 0, 0], [20 * np.cos(a), 20 * np.sin(a), 0]] for a in angles])
    normals = np.zeros((len(points), 2, 1, 3))
    measurands = MeasurandTable(
        points, normals, np.zeros(len(points), bool), np.arange(len(points)), np.arange(len(points))
    )
    pose = np.eye(4)
    pose[:3, :3], pose[2, 3] = np.diag([1.0, -1.0, -1.0]), 400.0
    return measurands, pose[None]


@pytest.mark.parametrize(("translation", "rotation"), [(0.1, 3e-4), (2e-3, 1e-6), (2.0, 1e-3)])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-3, 5e-3])
def test_under_1e_9_of_25_digits_also_at_hard_angles(translation, rotation, tolerance):
    measurands, poses = along_the_axes()
    pose_error = PoseError.from_standard_deviations(translation, rotation, pivot_mm=(5.0, 0.0, -16.0))
    kernel = ProbabilityKernel(measurands, np.full(len(measurands), tolerance), CAMERA, pose_error)
    ours, _ = kernel.probabilities(view_block(poses), 1, all_visible(measurands))
    with mpmath.workdps(25):
        for g, pair in enumerate(measurands.points):
            expected = in_25_digits(pair, poses[0], pose_error, tolerance)
            assert abs(ours[g, 0] - expected) < 1e-9, f"measurand {g}"


def in_25_digits(pair, pose, pose_error: PoseError, tolerance: float):
    """By numerical derivatives of the projection and the Fourier integral of the law: no formula is shared."""
    mpf = mpmath.mpf
    R, eye = mpmath.matrix(pose[:3, :3].tolist()), mpmath.matrix(pose[:3, 3].tolist())
    ends = [R.T * (mpmath.matrix(p.tolist()) - eye) for p in pair]
    f, pivot = mpf(CAMERA.focal_length_mm), [mpf(c) for c in pose_error.pivot_mm]

    def length(t):
        images = []
        for p in ends:
            q = [p[k] - pivot[k] for k in range(3)]
            turned = [t[4] * q[2] - t[5] * q[1], t[5] * q[0] - t[3] * q[2], t[3] * q[1] - t[4] * q[0]]
            X, Y, Z = (p[k] + turned[k] + t[k] for k in range(3))
            images.append((f * X / Z, f * Y / Z))
        return mpmath.hypot(images[1][0] - images[0][0], images[1][1] - images[0][1]), images

    zero = [mpf(0)] * 6
    L, images = length(zero)
    h, variance = mpf(10) ** -8, mpf(0)
    for k in range(6):
        up, down = ([h * s if j == k else mpf(0) for j in range(6)] for s in (1, -1))
        slope = (length(up)[0] - length(down)[0]) / (2 * h)
        variance += slope**2 * mpf(pose_error.covariance[k, k])
    steps = [mpf(step) for step in CAMERA.quantization_step_mm]
    a, b = (abs(images[1][k] - images[0][k]) / L * steps[k] for k in range(2))
    x = tolerance * L
    # the Fourier series of the law repeated at a distance at which the copies do not meet: P(|error| <= x) is exact
    base = mpmath.pi / (a + b + 12 * mpmath.sqrt(variance) + x)
    total, k, size = x * base / mpmath.pi, 0, mpf(1)
    while size * k > 1e-12 or k < 10:
        k += 1
        w = k * base
        size = mpmath.exp(-variance * w**2 / 2) / k / mpmath.pi * 2
        size *= min(1, (2 / (a * w)) ** 2 if a > 0 else 1) * min(1, (2 / (b * w)) ** 2 if b > 0 else 1)
        law = mpmath.exp(-variance * w**2 / 2) * mpmath.sinc(a * w / 2) ** 2 * mpmath.sinc(b * w / 2) ** 2
        total += 2 / mpmath.pi * mpmath.sin(w * x) / k * law
    return total


@given(seed=st.integers(0, 2**32 - 1), size=st.sampled_from([0.0, 1e-3, 1.0, 100.0]))
def test_the_columns_are_those_of_the_model_in_numpy(seed, size):
    rng = np.random.default_rng(seed)
    pose_error = random_pose_error(rng, size)
    measurands, poses = random_pairs(rng, 12, 9)
    viewpoint, measurand = (k.ravel() for k in np.indices((12, 9)))
    ours = PairColumns(measurands, CAMERA, pose_error).of(view_block(poses), viewpoint, measurand)
    points = transform(invert(poses)[viewpoint][:, None], measurands.points[measurand])
    image = image_segment(points[:, 0], points[:, 1], CAMERA, pose_error)
    direction = np.stack([np.cos(image.angle_rad), np.sin(image.angle_rad)], axis=-1)
    per_mm = np.linalg.norm(direction / np.asarray(CAMERA.pixel_pitch_mm), axis=-1)
    pixels = np.diff(CAMERA.to_pixels(CAMERA.project(points)), axis=-2)[:, 0]
    np.testing.assert_allclose(ours.length_px, np.hypot(*pixels.T), rtol=1e-9)
    np.testing.assert_allclose(np.cos(ours.angle_rad - image.angle_rad), 1.0, atol=1e-12)
    sigma = image.sigma_displacement_mm * per_mm
    # a variance that cancels to nothing is known to rounding of the largest term only
    np.testing.assert_allclose(ours.sigma_displacement_px, sigma, rtol=1e-6, atol=1e-6 * max(size, 1e-9) * 100)
    np.testing.assert_allclose(ours.expected_accuracy, image.expected_accuracy(), atol=1e-7)
    sizes = _sizes(points, CAMERA, pose_error)
    np.testing.assert_allclose(ours.neglected, sizes.neglected, rtol=1e-5)
