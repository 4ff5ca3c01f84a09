"""Moves of a pose, and the search for the best one near given ones."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from strategies import rigid_poses
from viewgauge.geometry import invert, look_at, require_poses, transform
from viewgauge.planning.refine.pose_search import PoseSearch, moved_poses

MOVES = st.tuples(*[st.one_of(st.just(0.0), st.floats(-0.8, 0.8))] * 6).map(np.array)


@given(T=rigid_poses(), distance=st.floats(1.0, 1000.0), move=MOVES)
def test_a_move_turns_about_the_point_aimed_at(T, distance, move):
    """Without a shift the point stays on the axis; the range changes by its factor; the result is a pose."""
    move[4:] = 0.0
    moved = require_poses(moved_poses(T, np.array(distance), move), "moved")
    aim = transform(T, [0.0, 0.0, distance])
    # 1e-9 of the range: the moves are a dozen roundings of coordinates of up to a metre
    assert np.allclose(transform(invert(moved), aim), [0, 0, distance * np.exp(move[2])], atol=1e-9 * (distance + 400))


@given(T=rigid_poses(), distance=st.floats(1.0, 1000.0), shift=st.tuples(*[st.floats(-1, 1)] * 2))
def test_a_shift_moves_the_camera_across_its_axis(T, distance, shift):
    moved = moved_poses(T, np.array(distance), np.array([0, 0, 0, 0, *shift]))
    assert np.allclose(moved[:3, :3], T[:3, :3], atol=1e-12)
    expected = np.array([shift[0], shift[1], 0.0]) * distance
    assert np.allclose(transform(invert(T), moved[:3, 3]), expected, atol=1e-9 * (distance + 400))


@given(T=rigid_poses())
def test_no_move_is_no_move(T):
    assert np.allclose(moved_poses(T, np.array(300.0), np.zeros(6)), T, atol=1e-10)


WANTED = look_at([150.0, -80.0, 320.0], [10.0, 5.0, 0.0], 0.4)


def nearness(poses):
    """Highest, 0, at one pose, with a ridge: position in mm and the axes of the camera, each with its own weight."""
    away = np.abs(poses[:, :3, 3] - WANTED[:3, 3]) @ [1e-2, 3e-2, 1e-2]
    return -away - np.abs(poses[:, :3, :3] - WANTED[:3, :3]).sum(axis=(1, 2))


def test_the_search_finds_the_best_pose_although_nothing_there_is_smooth():
    """Every coordinate has a kink at the optimum; what is left is under a thousandth of where it began."""
    starts = look_at([[100.0, -60.0, 300.0], [200.0, 0.0, 300.0]], [[0.0, 0.0, 0.0]] * 2, [0.0, 0.8])
    best, value = PoseSearch(192, 60, 1.0).best(starts, np.array([320.0, 360.0]), nearness, np.random.default_rng(3))
    assert (nearness(starts) < -1).all()
    assert (value > -1e-3).all()
    assert np.allclose(nearness(best), value)


@given(seed=st.integers(0, 1000), size=st.integers(8, 40))
def test_what_is_found_is_allowed_and_never_worse_than_the_start(seed, size):
    """The optimum is forbidden: half the space is, close to the start."""
    start = look_at([[100.0, -60.0, 300.0]], [[0.0, 0.0, 0.0]], [0.0])

    def value(poses):
        return np.where(poses[:, 0, 3] <= 101.0, nearness(poses), -np.inf)

    rng = np.random.default_rng(seed)
    best, found = PoseSearch(size, 6, 1.0).best(start, np.array([320.0]), value, rng)
    assert best[0, 0, 3] <= 101.0
    assert found[0] >= nearness(start)[0]


def test_where_nothing_else_is_allowed_the_start_stays():
    start = look_at([[100.0, -60.0, 300.0]], [[0.0, 0.0, 0.0]], [0.0])

    def value(poses):
        return np.where((poses == start).all(axis=(1, 2)), 1.0, -np.inf)

    best, found = PoseSearch(16, 5).best(start, np.array([320.0]), value, np.random.default_rng(0))
    assert (best == start).all()
    assert found == [1.0]


def test_the_same_seed_finds_the_same():
    start = look_at([[100.0, -60.0, 300.0]], [[0.0, 0.0, 0.0]], [0.0])
    a, b = (PoseSearch(32, 5).best(start, np.array([320.0]), nearness, np.random.default_rng(7))[0] for _ in range(2))
    assert (a == b).all()
