"""The error budget against Sobol indices and draws of the full camera model, which share no formula with it."""

from __future__ import annotations

import numpy as np
import openturns as ot
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strategies import points_in_front, pose_covariances, rigid_poses
from viewgauge.evaluation import averaged_success_probability, image_segment, success_probability
from viewgauge.evaluation.error_budget import SOURCES, averaged_error_budget, error_budget
from viewgauge.geometry import PoseError, look_at
from viewgauge.sensors import Camera
from viewgauge.simulation.full_camera import exact_length_errors, nominal_length

CAMERA = Camera(16.0, (0.00345, 0.005), (2448, 2048), edge_resolution_px=0.5)

SETUPS = {
    "along u": ([-30.0, 5, 400], [30.0, 5, 400], (0.1, 0.1, 0.1, 3e-4, 3e-4, 3e-4), None),
    "oblique, deep": ([-30.0, -40, 380], [25.0, 30, 440], (0.05, 0.2, 0.1, 2e-4, 1e-4, 5e-4), None),
    "turned head": ([60.0, -50, 500], [90.0, 20, 450], (0.2, 0.05, 0.1, 1e-4, 4e-4, 2e-4), (40.0, -20, -80)),
}


def pose_error_of(deviations, place):
    T = None if place is None else look_at(place, [0.0, 0, 300], 0.7)
    return PoseError(np.diag(np.square(deviations)), T_camera_frame=T)


def drawn(error, n, rng):
    """Pose errors and pixel errors of n draws: differences of two uniforms, in steps."""
    twist = rng.standard_normal((n, 6)) @ np.linalg.cholesky(error.covariance + 1e-30 * np.eye(6)).T
    return twist, rng.random((n, 2)) - rng.random((n, 2))


@pytest.mark.parametrize("setup", SETUPS.values(), ids=SETUPS.keys())
def test_the_shares_are_the_sobol_indices_of_the_full_camera(setup):
    """First-order indices (Saltelli) of 8 x 2^14 evaluations; the interval is OpenTURNS' own at 1 - 1e-4.

    24 intervals: a false alarm in 1 of 400 runs, were the seed not fixed. 2e-3 more for what the full camera model has
    beyond first order.
    """
    start, end, deviations, place = setup
    error, points = pose_error_of(deviations, place), np.array([start, end])
    budget = error_budget(start, end, CAMERA, error, 0.001)

    def length(sample):
        values = np.array(sample)
        return exact_length_errors(points, CAMERA, error, values[:, :6], values[:, 6:])[:, None]

    inputs = [ot.Normal(0.0, d) for d in deviations] + [ot.Triangular(-1.0, 0.0, 1.0)] * 2
    ot.RandomGenerator.SetSeed(20)
    size = 2**14
    design = ot.SobolIndicesExperiment(ot.JointDistribution(inputs), size).generate()
    outputs = length(design)
    found = ot.SaltelliSensitivityAlgorithm(design, ot.Sample(outputs - outputs.mean()), size)
    found.setUseAsymptoticDistribution(True)
    found.setConfidenceLevel(1 - 1e-4)
    interval = found.getFirstOrderIndicesInterval()
    low, high = (np.array(bound) for bound in (interval.getLowerBound(), interval.getUpperBound()))
    assert (high - low < 0.2).all(), "an interval that says something"
    assert not budget.own_share[8:].any(), "a plain camera has no other sources"
    assert (low - 2e-3 <= budget.own_share[:8]).all()
    assert (budget.own_share[:8] <= high + 2e-3).all()
    assert budget.own_share.sum() == pytest.approx(1, abs=1e-12)
    assert np.abs(budget.correlation_share).max() < 1e-12


def correlated() -> PoseError:
    """Translation and rotation go together, as on real robots: correlations of 0.9 and -0.8."""
    deviations = np.array([0.5, 0.5, 0.2, 2e-3, 2e-3, 3e-4])
    correlation = np.eye(6)
    for i, j, r in ((0, 4, 0.9), (1, 3, -0.8), (2, 5, 0.3)):
        correlation[i, j] = correlation[j, i] = r
    return PoseError(correlation * np.outer(deviations, deviations), pivot_mm=(5, 0, -40))


def test_the_shares_of_correlated_errors_are_those_of_a_regression_on_draws():
    """Least squares of the full camera model's errors on the drawn sources; then covariances of the terms with the sum.

    10^6 draws: a coefficient is off by under 1e-3 of the sum's deviation, a share (at most 2 in size here) by 4e-3.
    """
    error = correlated()
    start, end = [-30.0, -40, 380], [25.0, 30, 440]
    budget = error_budget(start, end, CAMERA, error, 0.001)
    twist, pixels = drawn(error, 1_000_000, np.random.default_rng(8))
    sources = np.concatenate([twist, pixels], axis=1)
    measured = exact_length_errors(np.array([start, end]), CAMERA, error, twist, pixels)
    coefficients = np.linalg.lstsq(sources / sources.std(axis=0), measured, rcond=None)[0]
    terms = sources / sources.std(axis=0) * coefficients
    shares = np.array([np.cov(term, terms.sum(axis=1))[0, 1] for term in terms.T]) / terms.sum(axis=1).var()
    assert np.allclose(budget.share[:8], shares, atol=4e-3)
    assert np.allclose(budget.own_share[:8], terms.var(axis=0) / terms.sum(axis=1).var(), atol=4e-3)
    assert np.abs(budget.correlation_share).max() > 0.05
    scale = np.linalg.norm(np.subtract(end, start)) / nominal_length(np.array([start, end]), CAMERA)
    assert budget.combined_uncertainty_mm == pytest.approx(measured.std() * scale, rel=4e-3)


def test_without_a_source_the_probability_is_that_of_draws_without_it():
    """250,000 draws, each with one source set to 0. The estimate's deviation is under 1e-3: 4.5e-3 is 4.5 of them and
    2e-4 for the first order; a false alarm in 10^4."""
    error = correlated()
    start, end = [-30.0, -40, 380], [25.0, 30, 440]
    points, T = np.array([start, end]), 1e-3
    budget = error_budget(start, end, CAMERA, error, T)
    twist, pixels = drawn(error, 250_000, np.random.default_rng(9))
    allowed = T * nominal_length(points, CAMERA)

    def share_within(kept):
        errors = exact_length_errors(points, CAMERA, error, twist * kept[:6], pixels * kept[6:])
        return np.mean(np.abs(errors) <= allowed)

    assert budget.probability == pytest.approx(share_within(np.ones(8)), abs=4.5e-3)
    for k in range(len(SOURCES)):
        assert budget.probability_without[k] == pytest.approx(share_within(np.arange(8) != k), abs=4.5e-3), SOURCES[k]
    for name, kept in (
        ("pose", [0] * 6 + [1, 1]),
        ("pixels", [1] * 6 + [0, 0]),
        ("rotation", [1, 1, 1, 0, 0, 0, 1, 1]),
    ):
        without = budget.group_probability_without[name]
        assert without == pytest.approx(share_within(np.array(kept)), abs=4.5e-3), name
    assert np.ptp(budget.probability_without) > 0.02, "a case in which the sources matter"


@given(points_in_front(), points_in_front(), pose_covariances(), rigid_poses(), st.sampled_from([0.0, 0.1, 1.0]))
def test_it_adds_up_and_agrees_with_the_joint_model(start, end, covariance, T, resolution):
    camera = Camera(16.0, (0.00345, 0.005), (2448, 2048), edge_resolution_px=resolution)
    error = PoseError(covariance, T_camera_frame=T)
    budget = error_budget(start, end, camera, error, 0.001)
    image = image_segment(start, end, camera, error)
    if not image.length_mm > 1e-100:  # end-on, or as good as
        assert np.isnan(budget.probability)
        assert np.isnan(budget.share).all()
        return
    total = budget.share.sum()
    assert total == pytest.approx(1, abs=1e-6) or (total == 0 and budget.combined_uncertainty_mm == 0)
    assert ((budget.probability_without >= 0) & (budget.probability_without <= 1)).all()
    if image.length_mm < 1e-4:  # a thirtieth of a pixel: the direction's last digit decides
        return
    assert budget.probability == pytest.approx(float(success_probability(start, end, camera, error, 0.001)), abs=1e-9)
    law = image.total_error()
    scale = np.linalg.norm(np.subtract(end, start)) / float(image.length_mm)
    # the variance is a sum of terms that may cancel to 1e-16 of the largest
    assert budget.combined_uncertainty_mm == pytest.approx(float(np.sqrt(law.var())) * scale, rel=1e-5, abs=1e-9)


def test_behind_the_camera_there_is_no_budget_and_segments_may_be_many():
    start = np.array([[-30.0, 0, 400], [-30.0, 0, -400], [0.0, 0, 300]])
    end = np.array([[30.0, 0, 400], [30.0, 0, 400], [0.0, 0, 400]])  # the last is seen end-on
    budget = error_budget(start, end, CAMERA, PoseError.from_standard_deviations(0.1, 1e-4), 0.001)
    assert np.isfinite(budget.share[0]).all()
    assert np.isnan(budget.share[1:]).all()
    assert np.isnan(budget.combined_uncertainty_mm[1:]).all()
    alone = error_budget(start[0], end[0], CAMERA, PoseError.from_standard_deviations(0.1, 1e-4), 0.001)
    assert np.allclose(budget.share[0], alone.share)
    assert set(budget.group_share) == {"translation", "rotation", "pose", "pixels", "camera"}
    assert budget.group_share["pose"][0] + budget.group_share["pixels"][0] == pytest.approx(1)


# --- the mean of several viewpoints
# --------------------------------------------------------------------------------------

ACQUISITIONS = np.array(
    [
        [[-30.0, -40, 380], [25.0, 30, 440]],
        [[30.0, -20, 420], [-40.0, 25, 400]],
        [[-10.0, 45, 450], [35.0, -30, 380]],
    ]
)


def shared() -> PoseError:
    """A third of the variance is common, and not of the same kind as what is drawn anew."""
    own, common = correlated().covariance, np.diag([0.3, 0.2, 0.1, 1e-3, 5e-4, 2e-4]) ** 2
    return PoseError(own + common, pivot_mm=(5, 0, -40), common_covariance=common)


def variance_of_mean(error, sources):
    """Of the mean's error, mm², by 200,000 draws of the full camera model in which all other sources are zero."""
    rng, n = np.random.default_rng(5), 200_000
    kept = np.isin(np.arange(8), sources)
    factor = np.linalg.cholesky(error.repeatability_covariance + 1e-30 * np.eye(6))
    common = rng.standard_normal((n, 6)) * np.sqrt(error.common_covariance.diagonal())
    mean = np.zeros(n)
    for points in ACQUISITIONS:
        twist = (common + rng.standard_normal((n, 6)) @ factor.T) * kept[:6]
        pixels = (rng.random((n, 2)) - rng.random((n, 2))) * kept[6:]
        on_part = np.linalg.norm(points[1] - points[0]) / nominal_length(points, CAMERA)
        mean += exact_length_errors(points, CAMERA, error, twist, pixels) * on_part / len(ACQUISITIONS)
    return mean.var()


def test_each_source_of_a_mean_alone_varies_it_by_its_share():
    """A variance of 200,000 draws is off by 0.3 % (one sigma); 2 %, seeds fixed."""
    error = shared()
    budget = averaged_error_budget(ACQUISITIONS, CAMERA, error, 0.05)
    combined = float(budget.combined_uncertainty_mm) ** 2
    for source in range(8):
        expected = float(budget.own_share[source]) * combined
        assert variance_of_mean(error, [source]) == pytest.approx(expected, rel=0.02, abs=1e-6 * combined)
    assert variance_of_mean(error, range(8)) == pytest.approx(combined, rel=0.02)


def test_a_mean_s_budget_adds_up_and_its_probabilities_are_the_law_s():
    error = shared()
    budget = averaged_error_budget(ACQUISITIONS, CAMERA, error, 0.05)
    assert budget.share.sum() == pytest.approx(1, abs=1e-12)
    assert float(budget.probability) == pytest.approx(averaged_success_probability(ACQUISITIONS, CAMERA, error, 0.05))
    still = PoseError(np.zeros((6, 6)), pivot_mm=(5, 0, -40), common_covariance=np.zeros((6, 6)))
    without_pose_error = averaged_success_probability(ACQUISITIONS, CAMERA, still, 0.05)
    assert float(budget.group_probability_without["pose"]) == pytest.approx(without_pose_error)
    assert (budget.contribution_mm**2).sum() / float(budget.combined_uncertainty_mm) ** 2 == pytest.approx(
        budget.own_share.sum()
    )
