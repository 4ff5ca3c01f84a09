"""Sources of error: each says of itself what budget, knobs and draws need; a new one takes part in all of them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from viewgauge.error_sources import ERROR_SOURCES, LengthError, SourceKind
from viewgauge.evaluation import Evaluator, Requirement, Setup, image_segment, success_probability
from viewgauge.evaluation.averaging import averaged_success_probability
from viewgauge.evaluation.error_budget import SOURCES, averaged_error_budget, error_budget
from viewgauge.geometry import Lens, PoseError, invert, look_at, transform
from viewgauge.part import Characteristic, LengthBetweenPoints, Mesh
from viewgauge.planning.improve.knobs import Rig, knob_named, settled_knobs
from viewgauge.planning.improve.least_change import SHORT, largest_factor
from viewgauge.sensors import Camera, EdgeDetector
from viewgauge.simulation import (
    Sampling,
    estimate_averaged_probability,
    estimate_success_probabilities,
    simulate_length_errors,
)

PLAIN = Camera(8.0, (0.00345, 0.004), (2448, 2048), edge_resolution_px=0.5)
EVERYTHING = replace(
    PLAIN,
    lens=Lens("radial-tangential", (-0.12, 0.02, 1e-3, -5e-4, 0.0)),
    intrinsics_covariance=tuple(map(tuple, np.diag([0.4, 0.5, 0.6, 0.7, 8e-4, 2e-3, 1e-4, 1e-4, 2e-3]) ** 2)),
    edge_detector=EdgeDetector(0.3, 0.1, 12, 5.0),
)
POSE_ERROR = PoseError.from_standard_deviations([0.05, 0.04, 0.1], [2e-4, 2e-4, 1e-4], pivot_mm=(5, 0, -40))
SHARED = PoseError(
    POSE_ERROR.covariance, T_camera_frame=POSE_ERROR.T_camera_frame, common_covariance=0.3 * POSE_ERROR.covariance
)
STILL = PoseError(np.zeros((6, 6)))
SEGMENTS = np.array([[[-80.0, -60, 200], [-55.0, -40, 210]], [[-20.0, 0, 200], [25.0, 3, 190]]])
T = 1e-3


@dataclass(frozen=True)
class Expansion(LengthError):  # noqa: N818 - an error of measurement
    """The part is warmer than it should be, by an unknown temperature that all acquisitions share."""

    relative: float

    name = "thermal_expansion"
    words = "thermal expansion"
    common = True

    def standard_deviation(self):
        return self.relative

    def times(self, factor):
        return Expansion(self.relative * factor)

    def deviation_mm(self, points, camera):
        return self.relative * np.linalg.norm(np.diff(camera.project(points), axis=-2), axis=-1)[..., 0]

    def displaced_images(self, images, drawn, view):  # noqa: ARG002
        middle = images.mean(axis=1, keepdims=True)
        return middle + (images - middle) * (1 + self.relative * drawn[:, None, None])


@dataclass(frozen=True)
class Shimmer(LengthError):  # noqa: N818 - an error of measurement
    """Air that moves before the lens shifts one end, anew at each acquisition: half as much along v as along u."""

    sigma_mm: float

    name = "shimmer"
    words = "moving air"
    common = False

    def standard_deviation(self):
        return self.sigma_mm

    def times(self, factor):
        return Shimmer(self.sigma_mm * factor)

    def deviation_mm(self, points, camera):
        run = np.diff(camera.project(points), axis=-2)[..., 0, :]
        return self.sigma_mm * (run @ [1.0, 0.5]) / np.linalg.norm(run, axis=-1)

    def displaced_images(self, images, drawn, view):  # noqa: ARG002
        moved = images.copy()
        moved[:, 1] += self.sigma_mm * drawn[:, None] * [1.0, 0.5]
        return moved


TOYS = (Expansion(1e-3), Shimmer(4e-3))


def with_toys(camera):
    return replace(camera, further_errors=TOYS)


# --- the sources that every camera can have


@pytest.mark.parametrize("camera", [PLAIN, EVERYTHING], ids=["plain", "everything"])
@pytest.mark.parametrize("source", ERROR_SOURCES, ids=lambda source: source.name)
def test_the_budget_without_a_source_is_that_of_the_camera_and_pose_error_without(source, camera):
    """Pose components are taken away one by one in the budget, so the three of a source go by its group."""
    budget = error_budget(SEGMENTS[:, 0], SEGMENTS[:, 1], camera, POSE_ERROR, T)
    expected = success_probability(SEGMENTS[:, 0], SEGMENTS[:, 1], *source.without(camera, POSE_ERROR), T)
    if source.kind is SourceKind.POSE or source.kind is SourceKind.TRIANGULAR:
        found = budget.group_probability_without[source.groups[0]]
    else:
        found = budget.probability_without[:, SOURCES.index(source.components[0].name)]
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize("source", ERROR_SOURCES, ids=lambda source: source.name)
def test_a_source_that_is_taken_away_is_gone_and_one_that_is_scaled_is_as_much_larger(source):
    camera = PLAIN if source.kind is SourceKind.TRIANGULAR else EVERYTHING
    assert source.size(*source.without(camera, POSE_ERROR)) == 0
    doubled = source.scaled(camera, POSE_ERROR, 2.0)
    one, two = (image_segment(*SEGMENTS[0], *given).total_error().var() for given in ((camera, POSE_ERROR), doubled))
    none = image_segment(*SEGMENTS[0], *source.without(camera, POSE_ERROR)).total_error().var()
    assert two - none == pytest.approx(4 * (one - none), rel=1e-6)
    assert one > none


# --- sources from outside


@pytest.mark.parametrize("camera", [PLAIN, EVERYTHING], ids=["plain", "everything"])
@pytest.mark.parametrize("pose_error", [STILL, POSE_ERROR], ids=["still", "pose error"])
def test_the_law_with_them_is_that_of_the_draws(camera, pose_error):
    """The two share no formula. Intervals of 99.9 % and a half-width of 1e-3; 1e-3 for what the law leaves out."""
    camera = with_toys(camera)
    law = success_probability(SEGMENTS[:, 0], SEGMENTS[:, 1], camera, pose_error, T)
    exact = estimate_success_probabilities(
        SEGMENTS[:, 0], SEGMENTS[:, 1], camera, pose_error, T, Sampling(confidence=0.999)
    )
    assert ((exact.low - 1e-3 <= law) & (law <= exact.high + 1e-3)).all()
    without = success_probability(SEGMENTS[:, 0], SEGMENTS[:, 1], replace(camera, further_errors=()), pose_error, T)
    assert (without - law > 0.01).all(), "a case in which they matter"


@pytest.mark.parametrize("camera", [PLAIN, EVERYTHING], ids=["plain", "everything"])
def test_the_draws_without_them_are_what_they_were(camera):
    """They take their numbers after all others: a factor of nothing leaves the errors of a seed as they are."""
    nothing = replace(EVERYTHING, further_errors=(Expansion(0.0),))
    draws = [simulate_length_errors(*SEGMENTS[0], c, STILL, 1, np.random.default_rng(3)) for c in (EVERYTHING, nothing)]
    np.testing.assert_allclose(draws[0], draws[1], rtol=1e-9, atol=1e-12)
    with_one = simulate_length_errors(*SEGMENTS[0], with_toys(camera), STILL, 1, np.random.default_rng(3))
    assert not np.allclose(draws[0], with_one)


@pytest.mark.parametrize("camera", [PLAIN, EVERYTHING], ids=["plain", "everything"])
def test_they_have_their_lines_in_the_budget(camera):
    budget = error_budget(SEGMENTS[:, 0], SEGMENTS[:, 1], with_toys(camera), POSE_ERROR, T)
    names = [component.name for component in budget.components]
    assert names == [*SOURCES, "thermal_expansion", "shimmer"]
    np.testing.assert_allclose(budget.share.sum(axis=-1), 1, atol=1e-12)
    length = np.linalg.norm(SEGMENTS[:, 1] - SEGMENTS[:, 0], axis=-1)
    np.testing.assert_allclose(budget.contribution_mm[:, names.index("thermal_expansion")], 1e-3 * length)
    np.testing.assert_allclose(budget.sensitivity[:, names.index("thermal_expansion")], length)
    for name, toy in zip(("thermal_expansion", "shimmer"), TOYS, strict=True):
        left = replace(camera, further_errors=tuple(other for other in TOYS if other is not toy))
        expected = success_probability(SEGMENTS[:, 0], SEGMENTS[:, 1], left, POSE_ERROR, T)
        np.testing.assert_allclose(budget.probability_without[:, names.index(name)], expected, atol=1e-9)
        assert budget.share[:, names.index(name)].min() > 0.01
    places = budget.groups["camera"]
    assert {names[place] for place in places} >= {"thermal_expansion", "shimmer", "pixel_u", "calibration"}


def test_of_a_mean_what_is_common_stays_and_what_is_drawn_anew_averages_out():
    camera = replace(PLAIN.without_errors, further_errors=TOYS)
    still = PoseError(np.zeros((6, 6)), common_covariance=np.zeros((6, 6)))
    one, four = (averaged_error_budget(np.repeat(SEGMENTS[1:], k, axis=0), camera, still, 0.05) for k in (1, 4))
    ratio = four.contribution_mm[-2:] / one.contribution_mm[-2:]
    np.testing.assert_allclose(ratio, [1.0, 0.5], rtol=1e-9)
    kept = float(four.probability_without[-1])
    only = replace(camera, further_errors=TOYS[:1])
    assert kept == pytest.approx(averaged_success_probability(np.repeat(SEGMENTS[1:], 4, axis=0), only, still, 0.05))


def test_the_mean_with_them_is_that_of_the_draws():
    """400,000 draws: an interval of 2.6e-3 at 99.9 %; 1e-3 for what the law leaves out."""
    camera = with_toys(EVERYTHING)
    allowed = float(averaged_error_budget(SEGMENTS, camera, SHARED, 0.05).combined_uncertainty_mm)
    law = averaged_success_probability(SEGMENTS, camera, SHARED, allowed)
    exact = estimate_averaged_probability(SEGMENTS, camera, SHARED, allowed, draws=400_000, rng=5)
    assert exact.low - 1e-3 <= law <= exact.high + 1e-3


# --- the table and the knobs: a bar on a plate, seen from above

PLATE = Mesh(
    np.array([[-60.0, -60, 0], [60, -60, 0], [60, 60, 0], [-60, 60, 0], [0, 0, -5]]),
    np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]),
)
UP = np.array([[0.0, 0.0, 1.0]])
ENDS = np.array([[-20.0, -3, 0], [20.0, 3, 0]])
LENGTH = float(np.linalg.norm(ENDS[1] - ENDS[0]))
BAR = Characteristic("bar", "measurand", LENGTH, (-0.2, 0.2), (LengthBetweenPoints(ENDS[0], ENDS[1], UP, UP),))
VIEWS = look_at(np.array([[0.0, 0.0, 250.0], [80.0, 30.0, 240.0]]), np.zeros((2, 3)), np.array([0.2, 0.9]))


def evaluator(camera, pose_error, allowed_mm=0.05, required=0.9):
    return Evaluator((BAR,), PLATE, Setup(camera, pose_error, Requirement("error", allowed_mm, required)))


@pytest.mark.parametrize("camera", [PLAIN, EVERYTHING], ids=["plain", "everything"])
def test_the_table_has_them_in_its_probabilities(camera):
    found = evaluator(with_toys(camera), POSE_ERROR).table(VIEWS)
    assert found.visible.all()
    for k, pose in enumerate(VIEWS):
        start, end = transform(invert(pose), ENDS)
        expected = success_probability(start, end, with_toys(camera), POSE_ERROR, 0.05 / LENGTH)
        assert found.probability[k, 0] == pytest.approx(float(expected), abs=1e-9)
        image = image_segment(start, end, with_toys(camera), POSE_ERROR)
        assert found.expected_accuracy[k, 0] == pytest.approx(float(image.expected_accuracy()), abs=1e-9)
    less = evaluator(camera, POSE_ERROR).table(VIEWS)
    assert (found.probability < less.probability).all()


def test_each_has_a_knob_and_the_least_change_is_that_by_hand():
    """Expansion alone: error = L r z with z normal, so that r = allowed / (L z_95) is the largest for 90 %."""
    camera = replace(PLAIN.without_errors, further_errors=(Expansion(1e-3),))
    assert [knob.name for knob in settled_knobs(camera)][-1] == "thermal_expansion"
    rig, base = Rig(camera, STILL, (200.0, 300.0)), evaluator(camera, STILL)
    knob = knob_named("thermal_expansion")
    assert (knob.today(rig), knob.unit) == (1.0, "of today")
    assert knob.turned(rig, 0.0).camera.further_errors == ()

    def at(factor):
        changed = knob.turned(rig, factor)
        return base.with_errors(changed.camera, changed.pose_error)

    found = largest_factor(at, VIEWS[:1])
    assert found.factor == pytest.approx(0.05 / (LENGTH * 1.6448536269514722) / 1e-3, rel=SHORT)
