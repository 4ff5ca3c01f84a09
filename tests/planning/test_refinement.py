"""Refined arrangements against brute force over a fine grid of poses, and what refining promises."""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from planning_strategies import acceptances

from viewgauge.evaluation import Evaluator, Requirement, Setup
from viewgauge.geometry import PoseError, look_at
from viewgauge.part import Characteristic, LengthBetweenPoints, Mesh
from viewgauge.planning import Refiner, ViewpointPool
from viewgauge.planning.cover.prices import characteristic_prices
from viewgauge.planning.refine import refinement as refinement_module
from viewgauge.sensors import Camera

CAMERA = Camera(12.0, (0.005, 0.005), (1200, 900), edge_resolution_px=0.25)
POSE_ERROR = PoseError.from_standard_deviations(0.1, 5e-4, pivot_mm=(0, 0, -30))
BOX = np.array([[-60.0, -60.0, 150.0], [60.0, 60.0, 260.0]])
REQUIRED = 0.9

# a flat plate: what hides nothing that lies on its upper side
PLATE = Mesh(
    np.array([[-60.0, -60, 0], [60, -60, 0], [60, 60, 0], [-60, 60, 0], [0, 0, -5]]),
    np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]),
)
UP = np.array([[0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class InBox:
    """A region that is a box."""

    corners: np.ndarray

    def allows(self, T_part_camera):
        points = T_part_camera[:, :3, 3]
        return ((points >= self.corners[0]) & (points <= self.corners[1])).all(axis=1)


def measurand(name, start, end):
    ends = np.array([start, end], dtype=float)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    return Characteristic(name, "measurand", length, (-0.2, 0.2), (LengthBetweenPoints(ends[0], ends[1], UP, UP),))


NEAR = (measurand("A", [-20, -10, 0], [20, -10, 0]), measurand("B", [0, -15, 0], [0, 18, 0]))
APART = (*NEAR, measurand("C", [-50, 50, 0], [-50, 20, 0]))


def evaluator(characteristics, error_mm):
    return Evaluator(characteristics, PLATE, Setup(CAMERA, POSE_ERROR, Requirement("error", error_mm, REQUIRED)))


def grid_of_poses(step_mm, tilts, rolls):
    """Poses all over the box, looking straight down and a little aside, turned."""
    axes = [np.arange(low, high + 1e-9, step_mm) for low, high in BOX.T]
    eyes = np.array(list(itertools.product(*axes)))
    made = []
    for (dx, dy), roll in itertools.product(itertools.product(tilts, tilts), rolls):
        aim = eyes + np.array([dx, dy, 0.0]) * eyes[:, 2:]
        aim[:, 2] = 0.0
        made.append(look_at(eyes, aim, roll))
    return np.concatenate(made)


def refined(characteristics, error_mm, starts, judge=None, **changes):
    judge = judge or evaluator(characteristics, error_mm)
    probability = judge.probabilities(starts)
    pool = ViewpointPool(starts, probability)
    middle = np.array([(d.measurands[0].start + d.measurands[0].end) / 2 for d in characteristics])
    options = {"seed": 0, "deadline": time.monotonic() + 60, **changes}
    refiner = Refiner(judge, InBox(BOX), REQUIRED, pool, middle, **options)
    chosen, bound = pool.most_probable_cover(REQUIRED, 10.0)
    return chosen, *refiner.improved(chosen, bound), judge


FEW = look_at([[40.0, 40, 240], [-40, 40, 240], [0, -40, 250]], [[0.0, 0, 0], [-30, 20, 0], [0, 0, 0]], [0.1, 0.2, 0.3])


def test_the_refined_viewpoint_is_as_sure_as_the_best_of_a_fine_grid():
    """100,000 poses by brute force: refining found at least the best
    probability of the weaker of two characteristics."""
    poses = grid_of_poses(10.0, np.linspace(-0.2, 0.2, 5), np.arange(0, np.pi, np.pi / 12))
    assert len(poses) > 100_000
    judge = evaluator(NEAR, 0.035)
    brute = judge.probabilities(poses).min(axis=1).max()
    before, chosen, _, reported, _ = refined(NEAR, 0.035, FEW)
    assert len(chosen) == 1
    assert 0.9 < brute < 0.9999, "a case in which there is something to find"
    assert before.weakest(REQUIRED) < brute - 0.005
    assert chosen.weakest(REQUIRED) >= brute
    assert np.allclose(judge.probabilities(chosen.T_part_camera), chosen.probability, atol=1e-12)
    assert reported.finished


def test_no_grid_needs_fewer_viewpoints():
    """Three characteristics, brute force over all pairs of the grid's acceptance patterns."""
    poses = grid_of_poses(20.0, np.linspace(-0.2, 0.2, 5), np.arange(0, np.pi, np.pi / 6))
    judge = evaluator(APART, 0.035)
    patterns = np.unique(judge.probabilities(poses) >= REQUIRED, axis=0)
    fewest = next(
        k
        for k in range(1, 4)
        if any(np.any(rows, axis=0).all() for rows in itertools.combinations(patterns, k))
    )  # fmt: skip
    _, chosen, bound, _, _ = refined(APART, 0.035, FEW)
    assert set(chosen.reached(REQUIRED)) == {0, 1, 2}
    assert len(chosen) <= fewest
    assert bound <= len(chosen)


def test_the_refined_is_never_worse_and_stays_in_the_region():
    starts = grid_of_poses(55.0, [0.0], [0.0, 0.8])
    before, chosen, _, reported, judge = refined(APART, 0.045, starts)
    assert InBox(BOX).allows(chosen.T_part_camera).all()
    assert len(chosen) <= len(before)
    assert set(before.reached(REQUIRED)) <= set(chosen.reached(REQUIRED))
    assert np.allclose(judge.probabilities(chosen.T_part_camera), chosen.probability, atol=1e-12)
    steps = reported.steps
    assert [s.name for s in steps] == ["sampled", "reach", "raise", "fewer"]
    for earlier, later in itertools.pairwise(steps):
        assert (later.met, -later.count) >= (earlier.met, -earlier.count)
        if (later.met, later.count) == (earlier.met, earlier.count):
            assert later.weakest >= earlier.weakest


def test_a_characteristic_that_no_candidate_meets_is_searched_for():
    starts = look_at([[55.0, 55.0, 255.0]], [[30.0, 30.0, 0.0]], [0.0])
    before, chosen, _, reported, _ = refined(NEAR[:1], 0.035, starts)
    assert len(before) == 0
    assert reported.reached == (0,)
    assert chosen.best()[0] >= REQUIRED


@dataclass(frozen=True)
class Doubtful:
    """An evaluator whose model warns of all that stands near a place."""

    judge: Evaluator
    place: np.ndarray
    radius_mm: float = 15.0

    def near(self, poses):
        return np.linalg.norm(poses[:, :3, 3] - self.place, axis=1) < self.radius_mm

    def of(self, characteristics):
        return replace(self, judge=self.judge.of(characteristics))

    def probabilities(self, poses):
        return self.judge.probabilities(poses)

    def table(self, poses):
        table = self.judge.table(poses)
        return replace(table, validity=np.where(self.near(poses)[:, None], 3, table.validity).astype(np.int8))


def test_what_the_model_warns_of_is_not_taken_however_sure_it_acquisitions():
    """The best viewpoint without warnings; then the model does not answer for what stands within 15 mm of it."""
    _, free, _, _, judge = refined(NEAR, 0.035, FEW)
    assert len(free) == 1
    doubtful = Doubtful(judge, free.T_part_camera[0, :3, 3])
    assert not doubtful.near(FEW).any()
    _, chosen, _, _, _ = refined(NEAR, 0.035, FEW, judge=doubtful)
    assert set(chosen.reached(REQUIRED)) == {0, 1}
    assert not doubtful.near(chosen.T_part_camera).any()
    assert chosen.weakest(REQUIRED) < free.weakest(REQUIRED)


def test_the_same_seed_gives_the_same_viewpoints():
    a, b = (refined(APART, 0.045, FEW, seed=4)[1].T_part_camera for _ in range(2))
    assert (a == b).all()


def test_without_time_the_arrangement_stays_and_is_said_to_be_unfinished():
    before, chosen, _, reported, _ = refined(NEAR, 0.045, FEW, deadline=time.monotonic())
    assert chosen is before
    assert not reported.finished


@pytest.mark.parametrize("calls", [0, 1, 5])
def test_stopped_by_the_user_the_best_so_far_is_kept(monkeypatch, calls):
    """Ctrl-C in the midst of a search: no exception, and nothing is worse."""
    left = [calls]
    search = refinement_module.PoseSearch.best

    def stopped(*args):
        if left[0] == 0:
            raise KeyboardInterrupt
        left[0] -= 1
        return search(*args)

    monkeypatch.setattr(refinement_module.PoseSearch, "best", stopped)
    before, chosen, _, reported, _ = refined(NEAR, 0.045, FEW)
    assert not reported.finished
    assert len(chosen) <= len(before)
    assert chosen.weakest(REQUIRED) >= before.weakest(REQUIRED)


@given(acceptances())
def test_prices_are_those_of_the_linear_relaxation(holds):
    """Duality: no viewpoint holds more than 1, and the sum bounds every cover from below (brute force)."""
    prices, total = characteristic_prices(holds)
    assert ((holds @ prices) <= 1 + 1e-9).all()
    assert total == pytest.approx(prices.sum(), abs=1e-9)
    fewest = next(
        k
        for k in range(len(holds) + 1)
        if any(holds[list(rows)].any(axis=0).all() for rows in itertools.combinations(range(len(holds)), k))
    )
    assert total <= fewest + 1e-9
    if fewest:
        assert total >= 1 - 1e-9
