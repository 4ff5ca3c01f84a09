"""Where the camera may stand: each condition by a second way to tell, and boxes that are never wrongly left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.exceptions import InputError, NoCandidateError
from viewgauge.part import Mesh
from viewgauge.planning import CandidateGrid, CandidateOptions
from viewgauge.planning.region.allowed_region import Hemisphere, Region
from viewgauge.sensors import Camera

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048))


def channel() -> Mesh:
    """A block of 100 x 60 x 40 mm with a channel 20 mm wide and 30 deep along its length."""
    profile = [(-30, 0), (30, 0), (30, 40), (10, 40), (10, 10), (-10, 10), (-10, 40), (-30, 40)]
    walls = []
    vertices = np.array([(x, y, z) for x in (-50.0, 50.0) for y, z in profile])
    n = len(profile)
    for k in range(n):
        a, b = k, (k + 1) % n
        walls += [(a, b, n + b), (a, n + b, n + a)]
    caps = [(0, 7, 6), (0, 6, 5), (0, 5, 4), (0, 4, 1), (1, 4, 3), (1, 3, 2)]
    faces = [*walls, *caps, *[tuple(n + v for v in reversed(t)) for t in caps]]
    made = trimesh.Trimesh(vertices, faces, process=False)
    made.fix_normals()
    assert made.is_watertight
    assert made.volume == pytest.approx(100 * (60 * 40 - 20 * 30))
    return Mesh(vertices, np.array(made.faces))


CHANNEL = channel()


def inside_channel_block(points):
    """The solid written out."""
    x, y, z = points.T
    block = (abs(x) < 50) & (abs(y) < 30) & (z > 0) & (z < 40)
    return block & ~((abs(y) < 10) & (z > 10))


def distance_to_channel_block(points):
    """Least distance over dense samples of every triangle: an upper bound that is at most 0.5 mm too great."""
    steps = np.linspace(0, 1, 221)
    a, b = np.meshgrid(steps, steps)
    weights = np.stack([a, b, 1 - a - b], axis=-1)[a + b <= 1]
    samples = np.concatenate([weights @ corners for corners in CHANNEL.vertices[CHANNEL.triangles]])
    return np.array([np.linalg.norm(samples - p, axis=1).min() for p in points])


def free(**changes) -> Region:
    return Region(np.zeros((1, 3)), (0.0, 1e4), CHANNEL, **changes)


def test_with_a_standoff_a_camera_may_stand_in_a_pocket_but_not_in_the_solid():
    rng = np.random.default_rng(5)
    points = rng.uniform([-70, -45, -20], [70, 45, 60], (400, 3))
    allowed = free(standoff_mm=0.0).allowed(points)
    assert (allowed == ~inside_channel_block(points)).all()
    pocket = np.array([[0.0, 0.0, 25.0]])
    assert free(standoff_mm=9.9).allowed(pocket)[0]
    assert not free(standoff_mm=10.1).allowed(pocket)[0], "10 mm from either wall"
    assert not free().allowed(pocket)[0], "without a standoff the bounding box is kept clear"


def test_the_standoff_is_the_distance_from_the_surface():
    rng = np.random.default_rng(6)
    points = rng.uniform([-70, -45, -20], [70, 45, 60], (60, 3))
    points = points[~inside_channel_block(points)]
    distance = distance_to_channel_block(points)
    for standoff in (3.0, 12.0):
        sure = (distance < standoff) | (distance - 0.5 > standoff)
        assert (free(standoff_mm=standoff).allowed(points)[sure] == (distance >= standoff)[sure]).all()


def test_touching_is_not_allowed():
    on_top = np.array([[0.0, 20.0, 40.0], [0.0, 20.0, 40.0 + 1e-6]])
    assert free(standoff_mm=0.0).allowed(on_top).tolist() == [False, True]


@st.composite
def regions(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    near = rng.uniform(0, 300)
    changes = {
        "cone_axis": tuple(rng.normal(size=3)),
        "cone_half_angle_rad": draw(st.sampled_from([0.1, 1.0, np.pi / 2, 3.0, np.pi])),
    }
    if draw(st.booleans()):
        changes["box"] = np.sort(rng.uniform(-300, 300, (2, 3)), axis=0)
    if draw(st.booleans()):
        centre = draw(st.sampled_from([None, (10.0, 0.0, -20.0)]))
        radius = draw(st.sampled_from([250.0, np.inf]))
        changes["hemisphere"] = Hemisphere(centre, tuple(rng.normal(size=3)), radius)
    if draw(st.booleans()):
        changes["forbidden"] = np.sort(rng.uniform(-300, 300, (2, 2, 3)), axis=1)
    changes["standoff_mm"] = draw(st.sampled_from([None, 0.0, 40.0]))
    return Region(
        rng.uniform(-40, 40, (draw(st.integers(1, 3)), 3)), (near, near + rng.uniform(0, 300)), CHANNEL, **changes
    )


@given(regions(), st.integers(0, 2**32 - 1))
def test_a_box_is_left_out_only_if_nothing_in_it_is_allowed(region, seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-400, 400, (300, 3)) * rng.choice([0.2, 1.0], (300, 1))
    size = rng.choice([1e-6, 5.0, 60.0, 300.0], (300, 1)) * rng.uniform(0, 1, (300, 3))
    corner = points - size * rng.uniform(0, 1, (300, 3))
    allowed = region.allowed(points)
    assert not (allowed & ~region.possible(corner, corner + size)).any()
    low, high = region.bounds
    assert ((points[allowed] >= low) & (points[allowed] <= high)).all()


@given(regions())
def test_the_conditions_written_out(region):
    rng = np.random.default_rng(1)
    points = rng.uniform(-400, 400, (200, 3))
    expected = np.zeros(len(points), dtype=bool)
    axis = np.array(region.cone_axis) / np.linalg.norm(region.cone_axis)
    for k, p in enumerate(points):
        for target in region.targets:
            d = np.linalg.norm(p - target)
            angle = np.arccos(np.clip(axis @ (p - target) / d, -1, 1))
            expected[k] |= region.distance_mm[0] <= d <= region.distance_mm[1] and angle <= region.cone_half_angle_rad
        if region.box is not None:
            expected[k] &= bool((p >= region.box[0]).all() and (p <= region.box[1]).all())
        if (h := region.hemisphere) is not None:
            centre = region.targets[0] if h.centre is None else np.array(h.centre)
            expected[k] &= bool((p - centre) @ np.array(h.axis) >= 0 and np.linalg.norm(p - centre) <= h.radius_mm)
        expected[k] &= not any((p > low).all() and (p < high).all() for low, high in region.forbidden)
    far = np.array([np.abs(p).max() > 95 for p in points])  # where the part cannot be too near
    assert (region.allowed(points)[far] == expected[far]).all()


MEASURANDS = np.array([[[-20.0, 0, 40], [20, 0, 40]], [[-50, -30, 0], [-50, -30, 40]]])
OPTIONS = CandidateOptions((150.0, 300.0), directions=80, rolls=2)


@pytest.mark.parametrize(
    "changes",
    [
        {"box": ((-300.0, -300.0, 0.0), (300.0, 300.0, 250.0))},
        {"hemisphere": Hemisphere(axis=(0.0, 1.0, 1.0), radius_mm=280.0)},
        {"forbidden": (((0.0, -400.0, -400.0), (400.0, 400.0, 400.0)),)},
        {"standoff_mm": 180.0},
    ],
)
def test_the_candidates_are_those_of_the_whole_grid_that_are_allowed(changes):
    everything = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, OPTIONS, seed=0)
    some = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, **changes), seed=0)
    poses = everything.poses(0, len(everything))
    expected = poses[some.region.allowed(poses[:, :3, 3])]
    assert 0 < len(expected) < len(poses)
    assert np.array_equal(some.poses(0, len(some)), expected)
    assert everything.region.allowed(poses[:, :3, 3]).all()


def test_where_nothing_is_left_the_message_says_what_stands_in_the_way():
    far_box = replace(OPTIONS, box=((900.0, 900.0, 900.0), (950.0, 950.0, 950.0)))
    with pytest.raises(NoCandidateError, match="box, the hemisphere and the forbidden boxes"):
        CandidateGrid(MEASURANDS, CHANNEL, CAMERA, far_box, seed=0)
    with pytest.raises(NoCandidateError, match="nearer than the standoff; allow larger distances"):
        CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, standoff_mm=2000.0), seed=0)


@pytest.mark.parametrize(
    "changes",
    [
        {"box": ((0.0, 0.0, 0.0), (1.0, -1.0, 1.0))},
        {"forbidden": (((0.0, 0.0, np.nan), (1.0, 1.0, 1.0)),)},
        {"standoff_mm": -1.0},
        {"standoff_mm": np.inf},
        {"hemisphere": Hemisphere(axis=(0.0, 0.0, 0.0))},
        {"hemisphere": Hemisphere(radius_mm=0.0)},
    ],
)
def test_places_that_cannot_be_are_refused(changes):
    with pytest.raises(InputError):
        replace(OPTIONS, **changes)
