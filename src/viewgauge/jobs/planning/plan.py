"""The main job: the fewest viewpoints that measure every characteristic as required."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

import numpy as np

from ...exceptions import InputError, NoCandidateError
from ...execution.chunks import (
    VIEWPOINTS_PER_CHUNK,
    EvaluationJob,
    ViewpointSource,
    candidate_grid,
    chunks_of,
    reachable,
    require_chunk_size,
)
from ...execution.executor import Executor, InProcess
from ...execution.fingerprint import job_fingerprint
from ...execution.progress import Progress, Silent
from ...formats.files.journal import ChunkJournal
from ...part import Characteristic
from ...planning import (
    Plan,
    assigned_viewpoint,
    planned_not_measurable,
    sort_characteristics,
    without_allowed_error,
)
from ...planning.cover.minimum_cover import DEFAULT_TIME_LIMIT_S
from ...planning.inspection import Inspection
from .candidate_search import CandidateSearch
from .choice import Choice
from .plan_steps import PlanSteps
from .refine import Arrangement

__all__ = ["plan"]

_WORTH_A_JOURNAL = 8
"""From so many chunks on, a job that is started again goes on where it was."""


@dataclass(frozen=True)
class PlanOptions:
    """How a plan is sought; the keyword arguments of :func:`plan` say what each is."""

    refine: bool = True
    prove: bool = True
    time_limit_s: float = DEFAULT_TIME_LIMIT_S
    gap: float = 0.0
    viewpoints_per_chunk: int = VIEWPOINTS_PER_CHUNK

    def __post_init__(self) -> None:
        require_chunk_size(self.viewpoints_per_chunk)
        if not self.time_limit_s >= 0:
            raise InputError("not a time", key="time limit", got=self.time_limit_s, expected="seconds, 0 or more")
        if not 0 <= self.gap < 1:
            raise InputError(
                "not a gap", key="gap", got=self.gap, expected="a share from 0 on and below 1, such as 0.1"
            )


def plan(
    inspection: Inspection,
    *,
    seed: int | None = None,
    progress: Progress | None = None,
    executor: Executor | None = None,
    viewpoints_per_chunk: int = VIEWPOINTS_PER_CHUNK,
    journal: str | PathLike[str] | None = None,
    refine: bool = True,
    prove: bool = True,
    time_limit_s: float = DEFAULT_TIME_LIMIT_S,
    gap: float = 0.0,
) -> Plan:
    """The fewest viewpoints that measure every characteristic as accurately and with the probability that is
    required.

    Candidates are evaluated in chunks, of which only what the cover needs is kept: their number is bounded by time,
    not by memory. The choice is by the joint model. Where that gives a warning for a pair that was chosen, its
    probability is found with the full camera model, and the choice is made again with it, until all that is stated is
    either without warning or confirmed (``PlannedCharacteristic.warning`` keeps the warning). Pairs that only the full
    camera model would accept are not sought.

    Then the viewpoints are refined over all poses that the region allows: fewer where that is possible, and more
    probable (:class:`~viewgauge.planning.Refiner`). Explicit viewpoints are the only ones there are; they are not
    refined.

    Characteristics that no viewpoint meets are averaged from several, if the inspection allows it.

    Ctrl-C after the candidates are evaluated ends a step: the plan is the best so far, with its gap.

    Parameters
    ----------
    seed
        In place of the inspection's. The same seed gives the same plan, in chunks of any size, wherever they run.
    executor
        Where chunks run (:func:`~viewgauge.execution.executor.open_executor`); by default in this process.
    viewpoints_per_chunk
        Bounds the memory of a process.
    journal
        A folder in which the chunks that are done are noted, so that the same job, if it is stopped, goes on where
        it was; it is removed at the end.
    refine
        False for the best of the candidates as they are.
    prove
        False to leave out what is proven over all poses of the region: the least number of viewpoints
        (``Plan.anywhere``), and the highest probability that a characteristic that is not met can reach
        (``PlannedCharacteristic.certificate``).
    time_limit_s
        Of the search for the fewest viewpoints, of that for the most probable, and of the refinement, each; the best so
        far counts. Only a search that is cut off may differ from run to run.
    gap
        The search for the fewest ends when the lower bound is within this share of their number.

    Raises
    ------
    InputError
        If the seed or the time limit is negative, the gap is not a share, or a chunk has no viewpoint.
    NoCandidateError
        If there is no candidate viewpoint to choose from.
    """
    options = PlanOptions(refine, prove, time_limit_s, gap, viewpoints_per_chunk)
    if seed is not None:
        if seed < 0:
            raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
        inspection = replace(inspection, seed=seed)
    return _planned(inspection, options, executor or InProcess(), progress or Silent(), journal)


def _planned(
    inspection: Inspection,
    options: PlanOptions,
    executor: Executor,
    progress: Progress,
    journal: str | PathLike[str] | None,
) -> Plan:
    characteristics, refused = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    not_measurable = (*inspection.part.not_measurable, *refused)
    if not characteristics:
        unplanned = sort_characteristics(inspection.part, inspection.requirement)
        open_ones, basic = unplanned.not_measurable, unplanned.without_tolerance
        return Plan(
            inspection.seed,
            (),
            tuple(planned_not_measurable(open_ones)),
            lower_bound=0,
            candidate_count=0,
            without_tolerance=tuple(planned_not_measurable(basic)),
        )
    threads = None if isinstance(executor, InProcess) else 1
    job = EvaluationJob.of(inspection, characteristics, _candidates(inspection, characteristics), threads=threads)
    size, time_limit_s = options.viewpoints_per_chunk, options.time_limit_s
    chunks = chunks_of(job.source, size)
    with _opened(journal if len(chunks) >= _WORTH_A_JOURNAL else None, inspection, job, size) as notes:
        search = CandidateSearch(job, chunks, executor, notes, progress)
        choice = Choice(inspection, job, characteristics, search.kept(), progress, time_limit_s, options.gap)
        cover, table = choice.made()
        not_met = np.flatnonzero(assigned_viewpoint(table, inspection.requirement.probability) < 0).tolist()
        best = search.best(not_met, choice.corrections)
        shortlist = search.acquisitions(not_met) if inspection.averaged_viewpoints > 1 and not_met else None
        arrangement = Arrangement(choice.poses(cover.chosen), table, best, cover.lower_bound)
        steps = PlanSteps(inspection, job, choice, cover.chosen, arrangement, progress)
        if options.prove:
            steps.bound()
        if options.refine:
            steps.refine(time_limit_s)
        if shortlist is not None:
            steps.average(not_met, shortlist)
        if options.prove:
            steps.certify()
        if notes:
            notes.discard()
    return steps.plan(not_measurable)


def _candidates(inspection: Inspection, characteristics: tuple[Characteristic, ...]) -> ViewpointSource:
    if inspection.viewpoints is None:
        return candidate_grid(inspection, characteristics)
    if not inspection.viewpoints.ids:
        raise NoCandidateError("no candidate viewpoint is left: the viewpoints file holds none")
    return reachable(inspection, characteristics)


@contextmanager
def _opened(
    folder: str | PathLike[str] | None, inspection: Inspection, job: EvaluationJob, viewpoints_per_chunk: int
) -> Iterator[ChunkJournal | None]:
    if folder is None:
        yield None
        return
    fingerprint = job_fingerprint(inspection, job, viewpoints_per_chunk)
    with ChunkJournal(folder, fingerprint, target=Path(folder).parent) as notes:
        yield notes
