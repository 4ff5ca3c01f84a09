"""Refine what was chosen among the candidates, over all poses that the region allows."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import BestRows, TableBlock
from ...execution.chunks import EvaluationJob, evaluator_of
from ...planning import CandidateGrid, Refinement, Refiner, ViewpointPool, assigned_viewpoint
from .choice import Choice

__all__ = ["Arrangement", "refined"]

_Best = dict[int, tuple[BestRows, int]]


@dataclass(frozen=True)
class Arrangement:
    """Chosen viewpoints, and what is known of each characteristic.

    Parameters
    ----------
    T_part_camera, table
        ``(K, 4, 4)`` mm, and the table ``(K, d)`` of these viewpoints.
    best
        For each characteristic that is not met the best rows of all viewpoints tried, and its place in them.
    lower_bound
        Of the number of viewpoints, among all viewpoints known.
    found
        For characteristics whose best row is no candidate's the pose ``(4, 4)`` mm that it belongs to.
    """

    T_part_camera: NDArray[np.float64]
    table: TableBlock
    best: _Best
    lower_bound: int
    refinement: Refinement | None = None
    found: dict[int, NDArray[np.float64]] = field(default_factory=dict)


def refined(
    job: EvaluationJob, choice: Choice, arrangement: Arrangement, *, seed: int, time_limit_s: float, least: int = 1
) -> Arrangement:
    """The arrangement that was chosen among the candidates of a grid, refined (:class:`~viewgauge.planning.Refiner`).

    Parameters
    ----------
    least
        Number of viewpoints that is known to be needed anywhere in the region.
    """
    assert isinstance(job.source, CandidateGrid)  # the caller's condition
    evaluator, required = evaluator_of(job), job.setup.requirement.probability
    table, poses = arrangement.table, arrangement.T_part_camera
    chosen = ViewpointPool(poses, np.where(table.visible, table.probability, 0.0))
    refiner = Refiner(
        evaluator,
        job.source.region,
        required,
        _known(job, choice, arrangement.best).joined(chosen),
        np.array([np.mean([(g.start + g.end) / 2 for g in d.measurands], axis=0) for d in job.characteristics]),
        seed=seed,
        deadline=time.monotonic() + time_limit_s,
        least=least,
    )
    better, bound, refinement = refiner.improved(chosen, arrangement.lower_bound)
    if better is not chosen:
        poses = better.T_part_camera
        table = replace(evaluator.table(poses), probability=better.probability)
    met = assigned_viewpoint(table, required) >= 0
    best = _best_of(job, arrangement.best, refiner.nearest, met)
    found = {j: refiner.nearest[j] for j, (rows, at) in best.items() if rows.viewpoint[at] >= len(job.source)}
    return Arrangement(poses, table, best, bound, refinement, found)


def _known(job: EvaluationJob, choice: Choice, best: _Best) -> ViewpointPool:
    """What a cover may need of the candidates, and the best of what none measures; nothing counts on doubtful pairs."""
    evaluator, kept = evaluator_of(job), choice.kept
    index = kept.index
    poses = choice.poses(index.tolist())
    probability = evaluator.probabilities(poses)
    probability[(kept.level > 0) & ~kept.certain] = 0.0
    corrections = choice.corrections
    here = np.flatnonzero(np.isin(corrections.viewpoint, index))
    row = np.searchsorted(index, corrections.viewpoint[here])
    probability[row, corrections.characteristic[here]] = corrections.probability[here]
    not_met = sorted({int(rows.viewpoint[place]) for rows, place in best.values()})
    others = choice.poses(not_met)
    return ViewpointPool(poses, probability).joined(ViewpointPool(others, evaluator.probabilities(others)))


def _best_of(job: EvaluationJob, best: _Best, nearest: dict[int, NDArray[np.float64]], met: NDArray[np.bool_]) -> _Best:
    """Of characteristics that are still not met the best, with what was found when they were searched for apart."""
    not_met = [j for j in best if not met[j]]
    found = [j for j in not_met if j in nearest]
    result = {j: best[j] for j in not_met}
    if found:
        evaluator = evaluator_of(job).of(found)
        table = evaluator.table(np.array([nearest[j] for j in found]))
        rows = BestRows.of(table, len(job.source) + np.arange(len(found)))
        for place, j in enumerate(found):
            candidates, at = best[j]
            before, after = candidates.taken([at]), rows.taken([place])
            result[j] = (before.merged(replace(after, counts=np.zeros_like(after.counts))), 0)
    return result
