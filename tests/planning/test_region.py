"""Where the camera may stand: each condition by a second way to tell, and boxes that are never wrongly left out."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
import trimesh
from bounded_regions import characteristic, measurand, probabilities
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.evaluation import Evaluator, Requirement, Setup
from viewgauge.exceptions import InputError, NoCandidateError
from viewgauge.formats.inspection import region_section
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.formats.inspection.region_section import RegionSection, register_quantity, register_region
from viewgauge.formats.inspection.values import Direction, Length
from viewgauge.geometry import PoseError, look_at
from viewgauge.part import Mesh, Part
from viewgauge.planning import CandidateGrid, CandidateOptions, Refiner, ViewpointPool
from viewgauge.planning.bounds import certify, viewpoints_lower_bound
from viewgauge.planning.region import (
    UNLIMITED,
    AllowedRegion,
    Box,
    ForbiddenBox,
    Hemisphere,
    Region,
    RegionMember,
    Standoff,
    Workpiece,
)
from viewgauge.sensors import Camera
from viewgauge.visibility import ObservationLimits

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


WORKPIECE = Workpiece(CHANNEL, np.zeros(3))


def region_of(targets, distance_mm, *members, **cone) -> AllowedRegion:
    return CandidateOptions(regions=members, **cone).region(
        targets, distance_mm, replace(WORKPIECE, middle_mm=targets[0])
    )


def free(*members) -> AllowedRegion:
    return region_of(np.zeros((1, 3)), (0.0, 1e4), *members)


def poses_at(points):
    """Poses with these eyes; which way they are turned does not matter to the members tested with them."""
    poses = np.tile(np.eye(4), (len(points), 1, 1))
    poses[:, :3, 3] = points
    return poses


def test_with_a_standoff_a_camera_may_be_in_a_pocket_but_not_in_the_solid():
    rng = np.random.default_rng(5)
    points = rng.uniform([-70, -45, -20], [70, 45, 60], (400, 3))
    allowed = free(Standoff(0.0)).allows(poses_at(points))
    assert (allowed == ~inside_channel_block(points)).all()
    pocket = poses_at([[0.0, 0.0, 25.0]])
    assert free(Standoff(9.9)).allows(pocket)[0]
    assert not free(Standoff(10.1)).allows(pocket)[0], "10 mm from either wall"
    assert not free().allows(pocket)[0], "without a standoff the bounding box is kept clear"


def test_the_standoff_is_the_distance_from_the_surface():
    rng = np.random.default_rng(6)
    points = rng.uniform([-70, -45, -20], [70, 45, 60], (60, 3))
    points = points[~inside_channel_block(points)]
    distance = distance_to_channel_block(points)
    for standoff in (3.0, 12.0):
        certain = (distance < standoff) | (distance - 0.5 > standoff)
        allowed = free(Standoff(standoff)).allows(poses_at(points))
        assert (allowed[certain] == (distance >= standoff)[certain]).all()


def test_poses_at_one_place_are_judged_alike_in_any_order():
    rng = np.random.default_rng(7)
    points = rng.uniform([-70, -45, -20], [70, 45, 60], (50, 3))
    region = free(Standoff(5.0))
    once = region.allows(poses_at(points))
    assert (region.allows(poses_at(np.repeat(points, 3, axis=0))) == np.repeat(once, 3)).all()
    assert (region.allows(poses_at(np.tile(points, (3, 1)))) == np.tile(once, 3)).all()
    assert region.allows(poses_at(points[:0])).shape == (0,)


def test_touching_is_not_allowed():
    on_top = np.array([[0.0, 20.0, 40.0], [0.0, 20.0, 40.0 + 1e-6]])
    assert free(Standoff(0.0)).allows(poses_at(on_top)).tolist() == [False, True]


@dataclass(frozen=True)
class Drawn:
    """A region and what it was made of."""

    region: AllowedRegion
    targets: np.ndarray
    distance_mm: tuple[float, float]
    cone: dict
    members: tuple


@st.composite
def regions(draw):
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    near = rng.uniform(0, 300)
    cone = {
        "cone_axis": tuple(rng.normal(size=3)),
        "cone_half_angle_rad": draw(st.sampled_from([0.1, 1.0, np.pi / 2, 3.0, np.pi])),
    }
    members = []
    if draw(st.booleans()):
        members.append(Box(*(tuple(corner) for corner in np.sort(rng.uniform(-300, 300, (2, 3)), axis=0))))
    if draw(st.booleans()):
        centre = draw(st.sampled_from([None, (10.0, 0.0, -20.0)]))
        radius = draw(st.sampled_from([250.0, np.inf]))
        members.append(Hemisphere(centre, tuple(rng.normal(size=3)), radius))
    if draw(st.booleans()):
        corners = np.sort(rng.uniform(-300, 300, (2, 2, 3)), axis=1)
        members += [ForbiddenBox(tuple(low), tuple(high)) for low, high in corners]
    if (standoff := draw(st.sampled_from([None, 0.0, 40.0]))) is not None:
        members.append(Standoff(standoff))
    targets = rng.uniform(-40, 40, (draw(st.integers(1, 3)), 3))
    distance_mm = (near, near + rng.uniform(0, 300))
    return Drawn(region_of(targets, distance_mm, *members, **cone), targets, distance_mm, cone, tuple(members))


@given(regions(), st.integers(0, 2**32 - 1))
def test_a_box_is_left_out_only_if_nothing_in_it_is_allowed(drawn, seed):
    region = drawn.region
    rng = np.random.default_rng(seed)
    points = rng.uniform(-400, 400, (300, 3)) * rng.choice([0.2, 1.0], (300, 1))
    size = rng.choice([0.0, 1e-6, 5.0, 60.0, 300.0], (300, 1)) * rng.uniform(0, 1, (300, 3))
    corner = points - size * rng.uniform(0, 1, (300, 3))
    allowed = region.allows(poses_at(points))
    assert not (allowed & ~region.possible(corner, corner + size)).any()
    low, high = region.bounds
    assert ((points[allowed] >= low) & (points[allowed] <= high)).all()


@given(regions())
def test_the_conditions_written_out(drawn):
    rng = np.random.default_rng(1)
    points = rng.uniform(-400, 400, (200, 3))
    expected = np.zeros(len(points), dtype=bool)
    axis = np.array(drawn.cone["cone_axis"]) / np.linalg.norm(drawn.cone["cone_axis"])
    for k, p in enumerate(points):
        for target in drawn.targets:
            d = np.linalg.norm(p - target)
            angle = np.arccos(np.clip(axis @ (p - target) / d, -1, 1))
            in_cone = angle <= drawn.cone["cone_half_angle_rad"]
            expected[k] |= drawn.distance_mm[0] <= d <= drawn.distance_mm[1] and in_cone
        for member in drawn.members:
            if isinstance(member, Box):
                expected[k] &= bool((p >= member.lowest).all() and (p <= member.highest).all())
            if isinstance(member, Hemisphere):
                centre = drawn.targets[0] if member.centre is None else np.array(member.centre)
                above = (p - centre) @ np.array(member.axis) >= 0
                expected[k] &= bool(above and np.linalg.norm(p - centre) <= member.radius_mm)
            if isinstance(member, ForbiddenBox):
                expected[k] &= not ((p > member.lowest).all() and (p < member.highest).all())
    far = np.array([np.abs(p).max() > 95 for p in points])  # where the part cannot be too near
    assert (drawn.region.allows(poses_at(points))[far] == expected[far]).all()


MEASURANDS = np.array([[[-20.0, 0, 40], [20, 0, 40]], [[-50, -30, 0], [-50, -30, 40]]])
OPTIONS = CandidateOptions((150.0, 300.0), directions=80, rolls=2)


@pytest.mark.parametrize(
    "member",
    [
        Box((-300.0, -300.0, 0.0), (300.0, 300.0, 250.0)),
        Hemisphere(axis=(0.0, 1.0, 1.0), radius_mm=280.0),
        ForbiddenBox((0.0, -400.0, -400.0), (400.0, 400.0, 400.0)),
        Standoff(180.0),
    ],
)
def test_the_candidates_are_those_of_the_whole_grid_that_are_allowed(member):
    everything = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, OPTIONS, seed=0)
    some = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, regions=(member,)), seed=0)
    poses = everything.poses(0, len(everything))
    expected = poses[some.region.allows(poses)]
    assert 0 < len(expected) < len(poses)
    assert np.array_equal(some.poses(0, len(some)), expected)
    assert everything.region.allows(poses).all()


def test_where_nothing_is_left_the_message_says_what_stands_in_the_way():
    far_box = Box((900.0, 900.0, 900.0), (950.0, 950.0, 950.0))
    with pytest.raises(NoCandidateError, match="150 to 300 mm every camera would be outside the box; allow more room"):
        CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, regions=(far_box,)), seed=0)
    with pytest.raises(NoCandidateError, match="nearer than the standoff; allow larger distances"):
        CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, regions=(Standoff(2000.0),)), seed=0)
    halves = (Hemisphere((0.0, 0.0, 0.0)), ForbiddenBox((-900.0, -900.0, -1.0), (900.0, 900.0, 900.0)))
    shares = r"\d\d% of the cameras would be outside the hemisphere, \d\d% in a forbidden box; allow more room"
    with pytest.raises(NoCandidateError, match=shares):
        CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, regions=halves), seed=0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Box((0.0, 0.0, 0.0), (1.0, -1.0, 1.0)),
        lambda: ForbiddenBox((0.0, 0.0, np.nan), (1.0, 1.0, 1.0)),
        lambda: Standoff(-1.0),
        lambda: Standoff(np.inf),
        lambda: Hemisphere(axis=(0.0, 0.0, 0.0)),
        lambda: Hemisphere(radius_mm=0.0),
        lambda: Hemisphere(centre=(0.0, np.nan, 0.0)),
        lambda: CandidateOptions(regions=("box",)),
    ],
)
def test_places_that_cannot_be_are_refused(make):
    with pytest.raises(InputError):
        make()


# --- members from outside the package ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Ball(RegionMember):
    """Within a distance of a point: a region of positions."""

    key: ClassVar[str] = "ball"
    outside: ClassVar[str] = "outside the ball"

    radius_mm: float
    centre: tuple[float, float, float] = (0.0, 0.0, 200.0)

    def region(self, workpiece: Workpiece) -> Region:  # noqa: ARG002
        return self

    @property
    def bounds(self):
        return np.array([self.centre, self.centre]) + self.radius_mm * np.array([[-1.0], [1.0]])

    def allows(self, T_part_camera):
        return np.linalg.norm(T_part_camera[:, :3, 3] - self.centre, axis=1) <= self.radius_mm

    def possible(self, low, high):
        return np.linalg.norm(np.clip(self.centre, low, high) - self.centre, axis=1) <= self.radius_mm


@dataclass(frozen=True)
class Upright(RegionMember):
    """The image's x axis stays near to an axis of the part: a region of poses, as a robot's reach is one."""

    key: ClassVar[str] = "upright"
    outside: ClassVar[str] = "tilted too far"

    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    cosine: float = 0.9

    def region(self, workpiece: Workpiece) -> Region:  # noqa: ARG002
        return self

    @property
    def bounds(self):
        return UNLIMITED

    def allows(self, T_part_camera):
        return abs(T_part_camera[:, :3, 0] @ np.array(self.axis)) >= self.cosine

    def possible(self, low, high):  # noqa: ARG002
        return np.ones(len(low), dtype=bool)  # from anywhere some pose is upright


def test_a_region_of_poses_keeps_some_rolls_of_a_place_and_not_others():
    everything = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, OPTIONS, seed=0)
    upright = CandidateGrid(MEASURANDS, CHANNEL, CAMERA, replace(OPTIONS, regions=(Upright(),)), seed=0)
    poses = everything.poses(0, len(everything))
    expected = poses[Upright().allows(poses)]
    places = {tuple(eye) for eye in expected[:, :3, 3].round(6)}
    assert 0 < len(expected) < len(poses)
    assert sum(tuple(eye) in places for eye in poses[:, :3, 3].round(6)) > len(expected), (
        "of some places one roll is left"
    )
    assert np.array_equal(upright.poses(0, len(upright)), expected)
    pieces = [upright.poses(first, first + 7) for first in range(0, len(upright), 7)]
    assert np.array_equal(np.concatenate(pieces), expected)


TOP = characteristic("top", measurand((-20.0, 0, 40), (20, 0, 40), [[0, 0, 1]]))
SIDE = characteristic("side", measurand((-20.0, 30, 20), (20, 30, 20), [[0, 1, 0]]))
SETUP = Setup(
    CAMERA, PoseError.from_standard_deviations(0.1, 2e-4), Requirement("accuracy", 0.995, 0.9), ObservationLimits()
)


@pytest.mark.parametrize("member", [Ball(120.0), Upright()])
def test_the_refinement_stays_in_a_region_from_outside(member):
    options = replace(OPTIONS, regions=(member,))
    grid = CandidateGrid(np.stack([g.points for g in [_Ends(TOP), _Ends(SIDE)]]), CHANNEL, CAMERA, options, seed=0)
    evaluator = Evaluator((TOP, SIDE), CHANNEL, SETUP)
    poses = grid.poses(0, len(grid))
    poses = poses[evaluator.probabilities(poses).argmax(axis=0)]
    pool = ViewpointPool(poses, evaluator.probabilities(poses))
    asked = []

    class Watched:
        bounds, possible = grid.region.bounds, grid.region.possible

        def allows(self, T_part_camera):
            asked.append(len(T_part_camera))
            return grid.region.allows(T_part_camera)

    middles = np.array([[0.0, 0, 40], [0, 30, 20]])
    refiner = Refiner(evaluator, Watched(), 0.9, pool, middles, seed=0, deadline=time.monotonic() + 20)
    chosen, bound = pool.most_probable_cover(0.9, 5.0)
    better, _, _ = refiner.improved(chosen, bound)
    assert sum(asked) > 1000
    assert len(better)
    assert member.allows(better.T_part_camera).all()
    assert better.weakest(0.9) >= chosen.weakest(0.9)


class _Ends:
    """The two points of a characteristic's only measurand."""

    def __init__(self, of):
        self.points = np.stack([of.measurands[0].start, of.measurands[0].end])


def test_bounds_are_those_of_a_region_from_outside():
    def bounds(*members):
        region = region_of(np.zeros((1, 3)), (150.0, 300.0), *members)
        certificates = [certify(TOP, SETUP, region), certify(SIDE, SETUP, region)]
        return region, certificates, viewpoints_lower_bound([TOP, SIDE], SETUP, region)

    # from the ball above the part no eye is in front of the side's face by more than the grazing angle
    ball = Ball(30.0, (0.0, 0.0, 230.0))
    region, (top, side), least = bounds(ball)
    assert (side.proven, side.upper_bound) == (True, 0.0)
    assert not top.proven
    assert least.count == 1
    _, (_, side_anywhere), _ = bounds()
    assert not side_anywhere.proven
    rng = np.random.default_rng(3)
    eyes = np.array(ball.centre) + rng.uniform(-30, 30, (400, 3))
    poses = look_at(eyes, np.broadcast_to([0, 0, 40.0], (400, 3)), rng.uniform(-np.pi, np.pi, 400))
    poses = poses[region.allows(poses)]
    measured = probabilities(poses, TOP, 0.005 * TOP.nominal_mm, CAMERA, SETUP.pose_error, SETUP.limits)
    assert len(poses) > 50
    assert measured.max() <= top.upper_bound
    # a region of poses only narrows what is measured: its bound is that of the positions from which it allows a pose
    assert bounds(Upright())[1][0].upper_bound == bounds()[1][0].upper_bound


class _UprightSection(RegionSection):
    axis: Direction = (1.0, 0.0, 0.0)

    def build(self) -> Upright:
        return Upright(self.axis)


def test_a_registered_region_has_a_key_in_the_inspection_file(tmp_path, monkeypatch):
    monkeypatch.setattr(region_section, "_KEYS", dict(region_section._KEYS))
    register_region(Upright.key, _UprightSection, "how far the camera may be tilted")
    register_quantity(Ball.key, Length, "the radius of a ball in which the camera must be", Ball)
    path = tmp_path / "inspection.yaml"
    path.write_text("""\
camera: {focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048]}
pose_uncertainty: {translation: 0.1 mm, rotation: 0.02 deg}
requirement: {accuracy: 0.99, probability: 0.95}
candidates:
  upright: {axis: [0, 1, 0]}
  ball: 12 cm
""")
    assert read_inspection_file(path).inspection(
        Part("part", Mesh(np.eye(3), np.array([[0, 1, 2]])), ())
    ).candidates.regions == (Upright((0.0, 1.0, 0.0)), Ball(120.0))
    with pytest.raises(InputError, match="how candidates are sampled"):
        register_region("cone", _UprightSection, "a key that exists")
