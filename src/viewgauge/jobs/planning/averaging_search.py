"""Dimensions that no single setting meets, measured from several settings and averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...evaluation import Looks
from ...execution.chunks import Chunk, EvaluationJob, evaluator_of
from ...geometry import invert, transform
from ...part.characteristic import rim_axes
from ...planning.averaging.acquisition_search import LookCandidates
from ...planning.averaging.averaged_viewpoints import LookedDimension, plan_looks
from ...planning.averaging.shortlist import LookShortlist, look_scores

__all__ = ["AddedLooks", "DimensionByLooks", "add_looks", "looks_chunk"]

_DRAWS = 400_000  # of the exact camera for each averaged dimension: its 99.9 % interval is ±1e-3 at 0.95


@dataclass(frozen=True)
class DimensionByLooks:
    """A dimension of a job that the mean of k looks meets.

    Parameters
    ----------
    dimension
        Its index in the job.
    looks
        k indices into the planned settings followed by the added ones.
    gauges
        ``(k, 2, 3)`` mm, part frame: what is measured in each look.
    probability
        Of the mean; by the exact camera where that finds it less sure than the law does.
    probability_single
        Of the best single look.
    deviation_mm
        Standard deviation of the mean's error.
    """

    dimension: int
    looks: tuple[int, ...]
    gauges: NDArray[np.float64]
    probability: float
    probability_single: float
    deviation_mm: float


@dataclass(frozen=True)
class AddedLooks:
    """What averaging adds to a plan.

    Parameters
    ----------
    settings
        ``(m,)`` indices of the settings that come to those of the plan, ascending.
    dimensions
        The dimensions that are met now.
    """

    settings: NDArray[np.int64]
    dimensions: tuple[DimensionByLooks, ...]


def looks_chunk(job: EvaluationJob, chunk: Chunk) -> LookShortlist:
    """Of a chunk's settings those from which a mean may be worth having, for each of the job's dimensions."""
    return _shortlisted(job, np.arange(*chunk), job.source.poses(*chunk))


def _shortlisted(job: EvaluationJob, index: NDArray[np.int64], poses: NDArray[np.float64]) -> LookShortlist:
    table = evaluator_of(job).table(poses)
    row, dimension = np.nonzero(table.visible)
    looks = _looks(job, poses[row], dimension, table.gauge[row, dimension])
    return LookShortlist.of(index[row], dimension, look_scores(looks))


def add_looks(job: EvaluationJob, shortlist: LookShortlist, planned: Sequence[int], most: int, seed: int) -> AddedLooks:
    """Meet what the mean of 2 to ``most`` looks meets, from planned settings and as few others as are found to do.

    The exact camera is asked about every mean that is chosen: averaging takes away what is drawn anew at each look, but
    not what the small-error model leaves out. Where the law is above its 99.9 % interval, the exact camera's estimate
    takes its place; if that is not sure enough, one look more is tried.

    Parameters
    ----------
    job
        With the dimensions that no single setting meets, and a head whose common part is stated.
    shortlist
        Of all settings of the job's source, by :func:`looks_chunk`.
    planned
        Indices of the plan's settings, in its order.
    """
    candidates = _candidates(job, shortlist, planned)
    fewest: dict[int, int] = {}
    exact: dict[tuple[int, tuple[int, ...]], float] = {}
    while True:  # each time round at least one dimension is tried with more looks
        found = plan_looks(candidates, planned, most, job.requirement.probability, fewest)
        for looked in found:
            if (looked.dimension, looked.settings) not in exact:
                exact[looked.dimension, looked.settings] = _confirmed(job, looked, seed)
        sure = {f.dimension: exact[f.dimension, f.settings] for f in found}
        refuted = [f for f in found if sure[f.dimension] < job.requirement.probability]
        if not refuted:
            return _added(job, found, sure, planned)
        fewest |= {f.dimension: len(f.settings) + 1 for f in refuted}


def _candidates(job: EvaluationJob, shortlist: LookShortlist, planned: ArrayLike) -> list[LookCandidates]:
    """For each dimension the planned and all shortlisted settings that see it, each by its best gauge.

    Those on another dimension's list are among them: a setting may serve both.
    """
    planned = np.asarray(planned, dtype=np.int64)
    index = np.unique(np.concatenate([shortlist.setting, planned]))
    poses, evaluator = _poses(job, index.tolist()), evaluator_of(job)
    table = evaluator.table(poses)
    candidates = []
    for dimension, allowed in enumerate(evaluator.allowed_error_mm.tolist()):
        row = np.flatnonzero(table.visible[:, dimension])
        gauge = table.gauge[row, dimension].astype(np.int64)
        points = _seen(job, poses[row], np.full(len(row), dimension), gauge)
        image = job.camera.to_pixels(job.camera.project(points))
        looks = _looks(job, poses[row], np.full(len(row), dimension), gauge)
        own = np.append(shortlist.setting[shortlist.dimension == dimension], planned)
        good, step = np.isin(index[row], own), 0.0 if job.camera.locator else job.camera.edge_resolution_px
        candidates.append(LookCandidates(index[row], gauge, looks, image, step, allowed, good))
    return candidates


def _seen(
    job: EvaluationJob, poses: NDArray[np.float64], dimension: NDArray[np.int64], gauge: NDArray[np.integer]
) -> NDArray[np.float64]:
    """``(n, 2, 3)`` mm: ends of gauges in the camera frames of n poses."""
    return transform(invert(poses)[:, None], _gauges(job, dimension, gauge))


def _looks(
    job: EvaluationJob, poses: NDArray[np.float64], dimension: NDArray[np.int64], gauge: NDArray[np.integer]
) -> Looks:
    chosen = [job.dimensions[j].gauges[g] for j, g in zip(dimension, gauge, strict=True)]
    return Looks.of(_seen(job, poses, dimension, gauge), job.camera, job.head, rim_axes(chosen, poses))


def _gauges(job: EvaluationJob, dimension: NDArray[np.int64], gauge: NDArray[np.integer]) -> NDArray[np.float64]:
    """``(n, 2, 3)`` mm, part frame."""
    chosen = [job.dimensions[j].gauges[g] for j, g in zip(dimension, gauge, strict=True)]
    return np.array([(one.start, one.end) for one in chosen]).reshape(-1, 2, 3)


def _poses(job: EvaluationJob, settings: Sequence[int]) -> NDArray[np.float64]:
    return np.array([job.source.poses(k, k + 1)[0] for k in settings]).reshape(-1, 4, 4)


def _confirmed(job: EvaluationJob, looked: LookedDimension, seed: int) -> float:
    """The probability of a mean, after the exact camera was asked."""
    from ...simulation import estimate_averaged_probability

    dimension = np.full(len(looked.settings), looked.dimension)
    poses = _poses(job, looked.settings)
    points = _seen(job, poses, dimension, np.array(looked.gauges))
    axes = rim_axes([job.dimensions[looked.dimension].gauges[g] for g in looked.gauges], poses)
    allowed = float(evaluator_of(job).allowed_error_mm[looked.dimension])
    estimate = estimate_averaged_probability(
        points, job.camera, job.head, allowed, draws=_DRAWS, rng=seed, rim_axis=axes
    )
    return looked.probability if looked.probability <= estimate.high else estimate.probability


def _added(
    job: EvaluationJob, found: Sequence[LookedDimension], sure: dict[int, float], planned: Sequence[int]
) -> AddedLooks:
    new = sorted({k for looked in found for k in looked.settings}.difference(planned))
    place = {k: n for n, k in enumerate([*planned, *new])}
    return AddedLooks(
        np.array(new, dtype=np.int64),
        tuple(
            DimensionByLooks(
                looked.dimension,
                tuple(place[k] for k in looked.settings),
                _gauges(job, np.full(len(looked.gauges), looked.dimension), np.array(looked.gauges)),
                sure[looked.dimension],
                looked.probability_single,
                looked.deviation_mm,
            )
            for looked in found
        ),
    )
