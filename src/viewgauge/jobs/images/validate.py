"""Is the law of the error true? Displaced acquisitions are rendered and measured, and their errors held against it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...exceptions import InputError, NoCandidateError
from ...execution.chunks import EvaluationJob, candidate_grid
from ...execution.executor import Executor, InProcess
from ...execution.progress import Progress, Silent
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...simulation.image_sensor import ImageSensor
from ..given_viewpoints import ViewpointsLike, viewpoints_of
from .measure import Edges, require_edges, seen_measurands
from .validated_viewpoint import ValidatedViewpoint, ValidationJob, validated_viewpoint
from .validation import Validation

__all__ = ["validate"]


def validate(
    inspection: Inspection,
    viewpoints: ViewpointsLike = None,
    *,
    sample: int = 20,
    repeats: int = 100,
    sensor: ImageSensor | None = None,
    edges: Sequence[Edges] = ("sub-pixel",),
    rays_per_pixel: int = 34,
    seed: int | None = None,
    progress: Progress | None = None,
    executor: Executor | None = None,
) -> dict[Edges, Validation]:
    """Hold the law of the error against displaced acquisitions, rendered and measured.

    Each acquisition has its own draw of the pose error, of the calibration's error and of the noise. Only what is
    looked at is rendered.

    Parameters
    ----------
    viewpoints
        As of :func:`~viewgauge.evaluate`; where neither they nor the inspection name any, ``sample`` of the candidates
        that see something are drawn.
    repeats
        Of each viewpoint.
    edges
        How edges are found in the same images: "sub-pixel", "whole-pixel".
    executor
        Where viewpoints are worked on (:func:`~viewgauge.execution.executor.open_executor`); by default in this
        process.

    Returns
    -------
    By the way of finding edges.

    Raises
    ------
    InputError
        If a number is out of range.
    NoCandidateError
        If no candidate sees a characteristic.
    """
    for name, value in (("repeats", repeats), ("sample", sample)):
        if value < 1:
            raise InputError("at least one", key=name, got=value)
    for how in edges:
        require_edges(how)
    seed = inspection.seed if seed is None else seed
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    if viewpoints is None and inspection.viewpoints is None:
        chosen = _drawn_viewpoints(inspection, sample, seed)
    else:
        chosen = viewpoints_of(inspection, viewpoints)
    evaluation = EvaluationJob.of(inspection, characteristics, chosen)
    job = ValidationJob(
        inspection, chosen, evaluation, repeats, sensor or ImageSensor(), tuple(edges), rays_per_pixel, seed
    )
    outcomes: dict[int, ValidatedViewpoint] = {}
    progress, executor = progress or Silent(), executor or InProcess()
    with progress.stage(f"Simulating and measuring {len(chosen) * repeats} acquisitions", len(chosen)) as advance:
        for index, outcome in executor.run(validated_viewpoint, job, list(range(len(chosen)))):
            outcomes[index] = outcome
            advance(1)
    return {how: _gathered(how, [outcomes[k] for k in range(len(chosen))], repeats) for how in edges}


def _gathered(how: Edges, outcomes: Sequence[ValidatedViewpoint], acquisitions: int) -> Validation:
    drawn = np.array([value for outcome in outcomes for value in outcome.drawn[how]])
    return Validation(
        how,
        len(outcomes),
        acquisitions,
        tuple(pair for outcome in outcomes for pair in outcome.pairs[how]),
        tuple(refusal for outcome in outcomes for refusal in outcome.refused),
        drawn[np.isfinite(drawn)],
        int(np.isnan(drawn).sum()),
    )


def _drawn_viewpoints(inspection: Inspection, count: int, seed: int) -> ExplicitViewpoints:
    """Candidates that see something, drawn at random."""
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    if not characteristics:
        raise NoCandidateError("nothing can be measured, so no viewpoint is sampled: see viewgauge check")
    grid = candidate_grid(inspection, characteristics)
    evaluation = EvaluationJob.of(inspection, characteristics, grid)
    rng, found = np.random.default_rng([seed, 7]), []
    for index in rng.permutation(len(grid)).tolist():
        pose = grid.poses(index, index + 1)
        if seen_measurands(evaluation, pose[0]):
            found.append((f"C{index + 1}", pose[0]))
        if len(found) == count:
            break
    if not found:
        raise NoCandidateError("no candidate sees a characteristic: see viewgauge check")
    return ExplicitViewpoints(tuple(name for name, _ in found), np.array([pose for _, pose in found]))
