"""Candidate viewpoints: even, where they were asked for, aimed at what is measured."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from viewgauge.exceptions import InputError, NoCandidateError
from viewgauge.geometry import require_poses
from viewgauge.part import Mesh
from viewgauge.planning import CandidateGrid, CandidateOptions, default_distance_range, spread_directions
from viewgauge.sensors import Camera

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048))


def box_mesh(size=(100.0, 60.0, 40.0)) -> Mesh:
    import trimesh

    made = trimesh.creation.box(bounds=[(0, 0, 0), size])
    return Mesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))


MEASURANDS = np.array(
    [[[0, 0, 40], [100, 0, 40]], [[0, 60, 40], [100, 60, 40]], [[90, 0, 0], [90, 0, 40]], [[92, 60, 0], [92, 60, 40]]],
    dtype=float,
)


def sample(measurands=MEASURANDS, seed=0, camera=CAMERA, mesh=None, **options):
    grid = CandidateGrid(measurands, mesh or box_mesh(), camera, CandidateOptions(**options), seed)
    return grid.poses(0, len(grid))


@pytest.mark.parametrize("count", [20, 200, 1000])
def test_directions_are_even_on_the_sphere(count):
    v = spread_directions(count)
    np.testing.assert_allclose(np.linalg.norm(v, axis=1), 1, atol=1e-12)
    assert np.linalg.norm(v.mean(axis=0)) < 1 / count**0.5 / 5, "they balance; random ones are off by 1/sqrt(n)"
    # the second moments of an even spread are those of the sphere: a third of the identity
    np.testing.assert_allclose(v.T @ v / count, np.eye(3) / 3, atol=1.5 / count)
    nearest = cKDTree(v).query(v, k=2)[0][:, 1]
    packed = np.sqrt(8 * np.pi / (np.sqrt(3) * count))  # spacing of the hexagonal lattice of the same density
    assert nearest.min() > 0.7 * packed
    assert nearest.max() < 1.05 * packed


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 0, -2), (1, 0, 0), (3, -4, 12)])
@pytest.mark.parametrize("half_angle", [5.0, 60.0, 120.0, 180.0])
def test_directions_fill_the_cone_and_no_more(axis, half_angle):
    v = spread_directions(500, axis, np.deg2rad(half_angle))
    unit = np.array(axis) / np.linalg.norm(axis)
    cosine = v @ unit
    assert cosine.min() >= np.cos(np.deg2rad(half_angle)) - 1e-12
    # area on a sphere goes with height (Archimedes): heights are even between the cone's rim and its top
    heights = np.sort((1 - cosine) / (1 - np.cos(np.deg2rad(half_angle))))
    np.testing.assert_allclose(heights, (np.arange(500) + 0.5) / 500, atol=1e-9)
    sideways = v - cosine[:, None] * unit
    assert np.linalg.norm(sideways.mean(axis=0)) < 0.02


def test_one_direction_is_a_direction():
    np.testing.assert_allclose(np.linalg.norm(spread_directions(1)), 1)


def test_every_combination_at_the_distances_and_rolls_asked_for():
    poses = require_poses(sample(distance_mm=(300.0, 600.0), distances=3, directions=50, rolls=4, targets=0))
    assert poses.shape == (3 * 50 * 4, 4, 4)
    middle = np.array([50.0, 30.0, 20.0])
    eyes, forward = poses[:, :3, 3], poses[:, :3, 2]
    distance = np.linalg.norm(eyes - middle, axis=1)
    np.testing.assert_allclose(np.unique(distance.round(6)), [300, 300 * 2**0.5, 600], atol=1e-5)
    np.testing.assert_allclose(eyes + distance[:, None] * forward, np.tile(middle, (600, 1)), atol=1e-9)
    # four rolls of each eye: image axes an eighth turn apart, over half a turn
    for eye in np.unique(eyes.round(9), axis=0)[:20]:
        group = poses[np.linalg.norm(eyes - eye, axis=1) < 1e-6]
        assert len(group) == 4
        x, y = group[0, :3, 0], group[0, :3, 1]
        turn = np.rad2deg(np.arctan2(group[:, :3, 0] @ y, group[:, :3, 0] @ x))
        np.testing.assert_allclose(np.sort(turn), [0, 45, 90, 135], atol=1e-6)


def test_one_distance_is_between_the_two():
    poses = sample(distance_mm=(300.0, 600.0), distances=1, directions=10, rolls=1, targets=0)
    distance = np.linalg.norm(poses[:, :3, 3] - [50, 30, 20], axis=1)
    assert ((distance > 300) & (distance < 600)).all()


def test_cone_of_cameras():
    poses = sample(distance_mm=(300.0, 300.0), targets=0, cone_axis=(0, -1, 0), cone_half_angle_rad=np.deg2rad(30))
    direction = (poses[:, :3, 3] - [50, 30, 20]) / 300
    assert (direction @ [0, -1, 0] >= np.cos(np.deg2rad(30)) - 1e-9).all()


def test_cameras_aim_at_the_middle_and_at_clusters():
    left = np.array([[[x, 0, 0], [x, 10, 0]] for x in (0.0, 1, 2)])
    right = left + np.array([90, 40, 30])
    poses = sample(np.concatenate([left, right]), distance_mm=(300.0, 300.0), distances=1, rolls=1, targets=2)
    targets = np.unique((poses[:, :3, 3] + 300 * poses[:, :3, 2]).round(6), axis=0)
    np.testing.assert_allclose(targets, [[1, 5, 0], [46, 25, 15], [91, 45, 30]], atol=1e-6)


def test_fewer_measurands_than_clusters_and_measurands_all_at_one_place():
    one = np.array([[[0.0, 0, 40], [100, 0, 40]]])
    for measurands in (one, np.repeat(one, 5, axis=0)):
        poses = sample(measurands, distance_mm=(300.0, 300.0), distances=1, directions=10, rolls=1, targets=4)
        assert np.isfinite(poses).all()
        assert len(poses) == 20


def test_no_camera_inside_the_bounding_box():
    poses = sample(distance_mm=(10.0, 100.0), distances=10, targets=3)
    inside = ((poses[:, :3, 3] >= 0) & (poses[:, :3, 3] <= [100, 60, 40])).all(axis=1)
    assert not inside.any()
    assert 0 < len(poses) < 10 * 200 * 2 * 4


def test_none_left_says_at_which_distances_and_what_to_do():
    with pytest.raises(NoCandidateError, match=r"5 to 10 mm every camera would be inside .* larger distances"):
        sample(distance_mm=(5.0, 10.0), targets=0)


def test_the_same_seed_gives_the_same_viewpoints_and_another_does_not():
    rng = np.random.default_rng(2)
    start = rng.uniform(0, 100, (40, 3))
    measurands = np.stack([start, start + rng.normal(0, 5, (40, 3))], axis=1)
    first = sample(measurands, seed=7)
    np.testing.assert_array_equal(sample(measurands, seed=7), first)
    others = [sample(measurands, seed=seed) for seed in (8, 9, 10)]
    assert any(not np.array_equal(other, first) for other in others)


def test_default_distances_hold_the_part_in_view_and_it_fills_the_image():
    near, far = default_distance_range(MEASURANDS.reshape(-1, 3), CAMERA)
    half_height = 2048 * 0.00345 / 2 / 16  # of the image, at unit distance
    radius = np.linalg.norm([50, 30, 20])
    assert near < far
    assert radius / far < half_height, "all of it is in view from the farthest"
    assert radius / near > half_height, "and more than fills the image from the nearest"


def test_default_distances_scale_with_the_part_and_follow_the_focus():
    near, far = default_distance_range(MEASURANDS.reshape(-1, 3), CAMERA)
    np.testing.assert_allclose(default_distance_range(10 * MEASURANDS.reshape(-1, 3), CAMERA), (10 * near, 10 * far))
    focused = Camera(16.0, (0.00345, 0.00345), (2448, 2048), f_number=8.0, focus_distance_mm=400.0)
    near, far = default_distance_range(MEASURANDS.reshape(-1, 3), focused)
    assert near < 400 < far


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"distance_mm": (0.0, 10.0)}, "distance"),
        ({"distance_mm": (20.0, 10.0)}, "distance"),
        ({"distance_mm": (1.0, np.inf)}, "distance"),
        ({"distances": 0}, "distances"),
        ({"directions": 0}, "directions"),
        ({"rolls": 0}, "rolls"),
        ({"targets": -1}, "targets"),
        ({"cone_axis": (0, 0, 0)}, "axis"),
        ({"cone_axis": (0, np.nan, 1)}, "axis"),
        ({"cone_half_angle_rad": 0.0}, "half angle"),
        ({"cone_half_angle_rad": 4.0}, "half angle"),
        ({"cone_half_angle_rad": np.nan}, "half angle"),
    ],
)
def test_bad_options(options, key):
    with pytest.raises(InputError, match=key):
        CandidateOptions(**options)


def brute_force(measurands, mesh, options, seed):
    """Every combination, one after the other, without those whose camera is inside the box."""
    from viewgauge.geometry import look_at
    from viewgauge.planning.candidates.candidate_grid import _targets

    low, high = mesh.bounds
    distances = np.geomspace(*options.distance_mm, options.distances)
    directions = spread_directions(options.directions, options.cone_axis, options.cone_half_angle_rad)
    poses = []
    for target in _targets(measurands, options.targets, seed):
        for distance in distances:
            for direction in directions:
                eye = target + distance * direction
                if all(low[k] <= eye[k] <= high[k] for k in range(3)):
                    continue
                poses += [look_at(eye, target, turn * np.pi / options.rolls) for turn in range(options.rolls)]
    return np.array(poses)


@pytest.mark.parametrize("rolls", [1, 3])
@pytest.mark.parametrize("nearest", [5.0, 30.0, 45.0, 200.0])
def test_a_grid_in_any_pieces_is_the_whole_without_what_is_inside_the_part(nearest, rolls):
    options = CandidateOptions(distance_mm=(nearest, 210.0), distances=4, directions=30, rolls=rolls, targets=2)
    grid = CandidateGrid(MEASURANDS, box_mesh(), CAMERA, options, 0)
    expected = brute_force(MEASURANDS, box_mesh(), options, 0)
    full = 3 * 4 * 30 * rolls
    assert len(grid) == len(expected)
    assert (len(grid) < full) == (nearest < 200)
    whole = grid.poses(0, len(grid))
    np.testing.assert_allclose(whole, expected, rtol=0, atol=1e-9)
    for size in (1, 7, 64, len(grid) - 1, len(grid) + 5):
        pieces = [grid.poses(first, first + size) for first in range(0, len(grid), size)]
        np.testing.assert_array_equal(np.concatenate(pieces), whole)
    assert grid.poses(len(grid), len(grid) + 3).shape == (0, 4, 4)
