"""An upper bound of the probability over all poses: never below what a pose reaches, and near the highest."""

import math

import numpy as np
import pytest
from bounded_regions import Shell, characteristic, measurand, probabilities, random_poses
from hypothesis import given, settings
from hypothesis import strategies as st

from strategies import pose_covariances
from viewgauge.evaluation import Requirement, Setup, image_segment
from viewgauge.geometry import Lens, PoseError, look_at
from viewgauge.planning.bounds import Budget
from viewgauge.planning.bounds.box_bounds import OUT, box_bounds
from viewgauge.planning.bounds.branch_and_bound import _Search, probability_bound
from viewgauge.planning.bounds.distance_grid import DistanceGrid
from viewgauge.planning.bounds.eye_region import reachable_distances
from viewgauge.sensors import Camera, EdgeDetector
from viewgauge.visibility import ObservationLimits

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.2)
WIDE = Camera(6.0, (0.00345, 0.005), (2448, 1400), edge_resolution_px=1.0, principal_point_px=(900.0, 800.0))
SHARP_NEAR_300 = Camera(16.0, (0.00345, 0.00345), (2448, 2048), f_number=2.0, focus_distance_mm=300.0)
BENT = Camera(8.0, (0.00345, 0.00345), (2448, 2048), lens=Lens("radial-tangential", (-0.3, 0.15, 1e-3, -2e-3)))
LOCATED = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_detector=EdgeDetector(0.1, 0.03, 14, 5.0))
CALIBRATED = Camera(
    12.0,
    (0.00345, 0.0036),
    (2448, 2048),
    lens=Lens("equidistant", (0.03, -0.01, 0.0, 0.0)),
    intrinsics_covariance=tuple(map(tuple, np.diag([1.0, 1.0, 2.0, 2.0, 1e-6, 1e-6, 1e-8, 1e-8]).tolist())),
    edge_detector=EdgeDetector(0.2),
)
LIMITS = ObservationLimits()
POSE_ERROR = PoseError.from_standard_deviations(0.1, 3e-4, pivot_mm=(5.0, 0.0, -60.0))


def anything(shortest_mm=1.0, longest_mm=1e5):
    grid = DistanceGrid(shortest_mm, longest_mm)
    grid.fill()
    return grid


def bound_of(measured, allowed_mm, region, camera, error, limits=LIMITS, target=2.0, budget=None):
    """The bound of a characteristic of one measurand."""
    only = measured.measurands[0]
    ends, normals = np.stack([only.start, only.end]), np.stack([only.start_normals, only.end_normals])
    grid = reachable_distances(ends[None], normals[None], region, limits)
    length = only.length_mm
    setup = Setup(camera, error, Requirement("error", allowed_mm, 0.95), limits)
    return probability_bound(
        (length, length), allowed_mm / length, grid, setup, target=target, budget=budget or Budget()
    )


def way_to_lie(start, end):
    """The five parameters of a measurand before the camera, from their definition."""
    p = np.stack([start, end])
    if (p[1, 1] / p[1, 2] - p[0, 1] / p[0, 2]) < 0:
        p = p[::-1]
    w, q = 1 / p[:, 2], p[:, :2] / p[:, 2:]
    along = q[1] - q[0]
    L = np.linalg.norm(along)
    along /= L
    middle = q.mean(axis=0)
    alpha, beta = middle @ along, middle @ [-along[1], along[0]]
    k = (w[1] - w[0]) / L / w.mean()
    return p, (alpha, beta, math.atan2(along[1], along[0]), math.atan(k), math.log(w.mean()))


@given(st.integers(0, 2**32 - 1), pose_covariances(), st.sampled_from([CAMERA, WIDE]))
@settings(max_examples=150, deadline=None)
def test_five_parameters_give_the_errors_of_the_model(seed, covariance, camera):
    rng = np.random.default_rng(seed)
    error = PoseError(covariance, pivot_mm=(3.0, -8.0, -70.0))
    tangents = rng.uniform(-0.15, 0.15, 2)
    middle = np.array([*tangents, 1.0]) * rng.uniform(200, 900)
    half = rng.normal(size=3)
    half *= rng.uniform(5, 60) / np.linalg.norm(half)
    (start, end), parameters = way_to_lie(middle - half, middle + half)
    setup = Setup(camera, error, Requirement("accuracy", 0.99, 0.95), LIMITS)
    search = _Search((2 * np.linalg.norm(half),) * 2, 0.01, anything(), setup, rims=False)
    box, out, axis = np.repeat(np.array(parameters)[None, :, None], 2, axis=2), np.empty((1, OUT)), np.empty(1, int)
    box_bounds(box, *search._length, search._R, search._view, out, axis)
    image = image_segment(start, end, camera, error)
    f, L = camera.focal_length_mm, image.length_mm
    step = np.asarray(camera.quantization_step_mm)
    widths = step * np.abs([np.cos(image.angle_rad), np.sin(image.angle_rad)]) / L
    if axis[0] < 0:
        # out of the picture or too short, then the model's image must be so too
        px = camera.to_pixels(camera.project(np.stack([start, end])))
        inside = (px >= LIMITS.margin_px - 0.5).all() and (px <= np.array(camera.resolution) - 0.5 - 8).all()
        assert not inside or np.hypot(*(px[1] - px[0])) < 16 + 1e-6
        return
    # the rotation part of both sides cancels to about 1e-13 of the largest standard deviation of the covariance
    size = np.sqrt(error.camera_covariance.diagonal()).max()
    assert out[0, 8] == pytest.approx(image.sigma_displacement_mm / L, rel=1e-9, abs=1e-9 * size)
    assert out[0, 9:11] == pytest.approx(widths, rel=1e-9, abs=1e-12 * step.max() * f / L)
    assert out[0, 11:13] == pytest.approx([np.linalg.norm(start), np.linalg.norm(end)], rel=1e-11)
    # a box that is a point: its bounds are the values, and none is above
    assert out[0, 0] <= out[0, 8] * (1 + 1e-12)
    assert out[0, 0] == pytest.approx(out[0, 8], rel=1e-6)
    assert sorted(out[0, 1:3]) == pytest.approx(sorted(widths), rel=1e-6, abs=1e-12)


@given(
    st.integers(0, 2**32 - 1),
    pose_covariances(),
    st.sampled_from([CAMERA, WIDE, SHARP_NEAR_300, BENT, LOCATED, CALIBRATED]),
    st.sampled_from([4.0, 30.0, 150.0]),
    st.sampled_from([2e-4, 1e-3, 5e-3]),
)
@settings(max_examples=25, deadline=None)
def test_no_pose_in_the_region_exceeds_the_bound(seed, covariance, camera, length, tolerance):
    rng = np.random.default_rng(seed)
    error = PoseError(covariance, pivot_mm=(3.0, -8.0, -70.0))
    direction = rng.normal(size=3)
    half = direction / np.linalg.norm(direction) * length / 2
    normals = rng.normal(size=(2, 2, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    measured = characteristic("D", measurand(-half, half, normals[0], normals[1]))
    region = Shell(rng.uniform(100, 300), rng.uniform(300, 600), centre=rng.normal(size=3) * 20, above=-50.0)
    bound = bound_of(measured, tolerance * length, region, camera, error, budget=Budget(boxes=10_000))
    poses = random_poses(rng, region, (0, 0, 0), 0.05 * region.far, 1000)
    reached = probabilities(poses, measured, tolerance * length, camera, error, LIMITS)
    assert reached.max(initial=0.0) <= bound.upper


def climb(region, measured, allowed_mm, camera, error, seed):
    """The highest probability that a random search with shrinking steps finds."""
    rng = np.random.default_rng(seed)
    eyes = region.sample(rng, 3000)
    aims, rolls = rng.normal(size=eyes.shape) * 15, rng.uniform(0, np.pi, len(eyes))
    step, best = 60.0, 0.0
    for _ in range(28):
        p = probabilities(look_at(eyes, aims, rolls), measured, allowed_mm, camera, error, LIMITS)
        order = np.argsort(-p)[:30]
        best = max(best, p[order[0]])
        eyes, aims, rolls = (np.concatenate([v[order], np.repeat(v[order], 20, axis=0)]) for v in (eyes, aims, rolls))
        moved = slice(len(order), None)
        eyes[moved] += rng.normal(size=eyes[moved].shape) * step
        aims[moved] += rng.normal(size=eyes[moved].shape) * step / 3
        rolls[moved] += rng.normal(size=rolls[moved].shape) * step / 60
        inside = region.holds(eyes)
        eyes, aims, rolls = eyes[inside], aims[inside], rolls[inside]
        step *= 0.75
    return best


FULL = np.array([[1, 0.4, -0.3, 0.2, 0.5, 0], [0, 1, 0.6, -0.7, 0.1, 0.2], [0, 0, 1, 0.8, -0.9, 0.1],
                 [0, 0, 0, 0.6, 0.3, 0.5], [0, 0, 0, 0, 0.7, 0.2], [0, 0, 0, 0, 0, 0.4]])  # fmt: skip
CORRELATED = PoseError(
    (s := FULL.T * np.array([0.1, 0.1, 0.1, 3e-4, 3e-4, 3e-4])[:, None]) @ s.T, pivot_mm=(5.0, 0.0, -60.0)
)


@pytest.mark.parametrize(
    ("error", "camera", "length", "tolerance", "near"),
    # tightness 1e-3, what the bins of the distances add (a few per cent of the distance: much where the best eye is at
    # the region's border, nothing where it is inside), and the random search's own shortfall
    [
        (POSE_ERROR, CAMERA, 30.0, 6e-4, 6e-3),
        (POSE_ERROR, CAMERA, 120.0, 3e-4, 0.03),
        (CORRELATED, WIDE, 60.0, 1e-3, 0.012),
        (POSE_ERROR, SHARP_NEAR_300, 30.0, 8e-4, 6e-3),
    ],
)
def test_the_bound_is_near_the_highest_probability_of_a_search(error, camera, length, tolerance, near):
    measured = characteristic("D", measurand((-length / 2, 0, 0), (length / 2, 0, 0)))
    region = Shell(200.0, 500.0)
    bound = bound_of(measured, tolerance * length, region, camera, error, budget=Budget(tightness=1e-3))
    reached = climb(region, measured, tolerance * length, camera, error, seed=1)
    assert 0.1 < reached <= bound.upper < 0.999
    assert bound.upper - reached < near
    assert bound.found <= bound.upper


def test_a_search_cut_short_is_still_a_bound_and_a_longer_one_is_no_worse():
    measured = characteristic("D", measurand((-20, 0, 0), (20, 0, 0)))
    uppers = [
        bound_of(measured, 0.02, Shell(200, 500), CAMERA, POSE_ERROR, budget=Budget(boxes)).upper
        for boxes in (1, 1000, 10_000, 100_000)
    ]
    assert uppers == sorted(uppers, reverse=True)
    assert uppers[0] > uppers[-1]


def test_without_pose_error_and_pixels_everything_is_certain():
    measured = characteristic("D", measurand((-20, 0, 0), (20, 0, 0)))
    ideal = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.0)
    bound = bound_of(measured, 0.02, Shell(200, 500), ideal, PoseError(np.zeros((6, 6))))
    assert bound.upper == 1.0
    assert bound.found == 1.0


class Narrow(Shell):
    """Within 2 degrees of the z axis."""

    def __init__(self, near, far):
        super().__init__(near, far, above=0.0)

    def holds(self, points):
        return super().holds(points) & (np.hypot(points[:, 0], points[:, 1]) <= 0.035 * points[:, 2])

    def possible(self, low, high):
        nearest = np.hypot(*np.clip(0.0, low[:, :2], high[:, :2]).T)
        return super().possible(low, high) & (nearest <= 0.035 * high[:, 2])


def test_measurand_that_never_fits_the_image_is_measured_nowhere():
    # from above its middle it takes 61 deg of a field of view of 30 deg x 25 deg
    measured = characteristic("D", measurand((-300, 0, 0), (300, 0, 0)))
    assert bound_of(measured, 6.0, Narrow(450, 500), CAMERA, POSE_ERROR).upper == 0.0


def test_measurand_too_short_in_every_image_is_measured_nowhere():
    # 16 px are 0.69 mm at 200 mm
    measured = characteristic("D", measurand((-0.1, 0, 0), (0.1, 0, 0)))
    assert bound_of(measured, 1.0, Shell(200, 500), CAMERA, POSE_ERROR).upper == 0.0


def test_region_out_of_focus_is_measured_nowhere():
    measured = characteristic("D", measurand((-20, 0, 0), (20, 0, 0)))
    assert bound_of(measured, 1.0, Shell(500, 700), SHARP_NEAR_300, POSE_ERROR).upper == 0.0


def test_image_without_room_inside_the_margin_measures_nothing():
    measured = characteristic("D", measurand((-20, 0, 0), (20, 0, 0)))
    assert bound_of(measured, 1.0, Shell(200, 500), CAMERA, POSE_ERROR, ObservationLimits(margin_px=2000)).upper == 0.0


def test_no_eye_nearly_in_line_with_the_measurand_exceeds_the_bound():
    measured = characteristic("D", measurand((0, 0, -30), (0, 0, 30)))
    region, limits = Narrow(300.0, 400.0), ObservationLimits(minimum_length_px=0.0)
    bound = bound_of(measured, 0.06, region, CAMERA, POSE_ERROR, limits, budget=Budget(boxes=200_000))
    rng = np.random.default_rng(3)
    z = rng.uniform(300, 400, 10_000)
    turn, tilt = rng.uniform(0, 2 * np.pi, len(z)), 0.035 * np.sqrt(rng.uniform(0, 1, len(z)))
    eyes = np.column_stack([z * tilt * np.cos(turn), z * tilt * np.sin(turn), z])
    eyes = eyes[region.holds(eyes)]
    poses = look_at(eyes, rng.normal(size=eyes.shape) * 40, rng.uniform(0, np.pi, len(eyes)))
    reached = probabilities(poses, measured, 0.06, CAMERA, POSE_ERROR, limits)
    assert 0 < reached.max() <= bound.upper
