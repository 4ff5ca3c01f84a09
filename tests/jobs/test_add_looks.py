"""Several looks on the slotted block: what no setting meets alone, the mean of a few does."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.evaluation import averaged_success_probability
from viewgauge.execution.chunks import EvaluationJob, candidate_grid, chunks_of, evaluator_of
from viewgauge.geometry import invert, transform
from viewgauge.jobs.planning.averaging_search import add_looks, looks_chunk
from viewgauge.simulation import Estimate, estimate_averaged_probability

BLOCK = Path(__file__).resolve().parents[2] / "examples" / "slotted_block" / "inspection.yaml"
DIMENSIONS = ("E2", "E3", "E4", "E6")
PLANNED = (17, 60)


def job_with(common_share, edge_px=1.0):
    inspection = vg.load(BLOCK)
    head = inspection.head
    inspection = replace(
        inspection,
        camera=replace(inspection.camera, edge_resolution_px=edge_px),
        candidates=replace(inspection.candidates, directions=40),
    )
    dimensions = [d for d in inspection.part.dimensions if d.id in DIMENSIONS]
    job = EvaluationJob.of(inspection, dimensions, candidate_grid(inspection, dimensions))
    common = head.covariance * common_share
    return replace(job, head=vg.PoseError(head.covariance, T_camera_head=head.T_camera_head, common_covariance=common))


def shortlist(job, size=16_384):
    lists = [looks_chunk(job, chunk) for chunk in chunks_of(job.source, size)]
    whole = lists[0]
    for more in lists[1:]:
        whole = whole.merged(more)
    return whole


@pytest.fixture(scope="module")
def none_common():
    job = job_with(0.0)
    return job, shortlist(job)


def points_of(job, added, entry):
    """(k, 2, 3) mm: what each look sees, in its camera frame."""
    settings = [*PLANNED, *added.settings]
    poses = np.array([job.source.poses(settings[k], settings[k] + 1)[0] for k in entry.looks])
    return transform(invert(poses)[:, None], entry.gauges)


def test_a_mean_meets_what_no_setting_does(none_common):
    job, short = none_common
    best = evaluator_of(job).table(job.source.poses(0, len(job.source))).probability.max(axis=0)
    added = add_looks(job, short, PLANNED, 3, 0)
    assert added.dimensions, "some dimension is met"
    for entry in added.dimensions:
        assert best[entry.dimension] < 0.95 <= entry.probability
        assert entry.probability_single == pytest.approx(best[entry.dimension], abs=1e-9)
        assert 2 <= len(entry.looks) <= 3
        points = points_of(job, added, entry)
        allowed = evaluator_of(job).allowed_error_mm[entry.dimension]
        assert averaged_success_probability(points, job.camera, job.head, allowed) == pytest.approx(
            entry.probability, abs=1e-12
        )
        # another seed than the confirmation's; 99.9 % interval, false alarm at most 0.4 % in all; 3e-4: first order
        estimate = estimate_averaged_probability(points, job.camera, job.head, allowed, draws=100_000, rng=77)
        assert estimate.low - 3e-4 <= entry.probability <= estimate.high + 3e-4
    assert list(added.settings) == sorted(set(added.settings) - set(PLANNED))
    used = {k for entry in added.dimensions for k in entry.looks}
    assert used >= {len(PLANNED) + n for n in range(len(added.settings))}, "no setting is added that serves nothing"


def test_the_result_does_not_depend_on_the_chunks(none_common):
    job, whole = none_common
    parts = shortlist(job, 700)
    for name, array in whole.arrays().items():
        np.testing.assert_array_equal(array, parts.arrays()[name])


def test_more_looks_meet_more_and_a_common_error_less(none_common):
    job, short = none_common

    def met(job, short, most):
        return {entry.dimension for entry in add_looks(job, short, PLANNED, most, 0).dimensions}

    assert met(job, short, 2) < met(job, short, 6)
    # from 0.1 px the head limits; if its error is all common, means gain less
    sharp = job_with(0.0, 0.05)
    stuck = job_with(1.0, 0.05)
    sharp, stuck = (replace(j, requirement=vg.Requirement("accuracy", 0.9997, 0.95)) for j in (sharp, stuck))
    assert met(sharp, shortlist(sharp), 3) > met(stuck, shortlist(stuck), 3)


def test_a_mean_that_the_exact_camera_refutes_gets_one_look_more(none_common, monkeypatch):
    job, short = none_common
    two = {e.dimension for e in add_looks(job, short, PLANNED, 3, 0).dimensions if len(e.looks) == 2}
    assert two
    real = estimate_averaged_probability

    def doubting(points, *arguments, **options):
        return Estimate(0.9, 0.89, 0.91, 1) if len(points) == 2 else real(points, *arguments, **options)

    monkeypatch.setattr("viewgauge.simulation.estimate_averaged_probability", doubting)
    for entry in add_looks(job, short, PLANNED, 3, 0).dimensions:
        assert len(entry.looks) == 3
    assert add_looks(job, short, PLANNED, 2, 0).dimensions == ()


def test_without_a_stated_common_part_nothing_is_averaged(none_common):
    job, _ = none_common
    unknown = replace(job, head=vg.PoseError(job.head.covariance, T_camera_head=job.head.T_camera_head))
    with pytest.raises(vg.InputError, match="drawn anew"):
        looks_chunk(unknown, (0, 50))
