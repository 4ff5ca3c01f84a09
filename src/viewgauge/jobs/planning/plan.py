"""The main job: the fewest settings that measure every dimension as required."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from ...exceptions import InputError, NoCandidateError
from ...execution.chunks import (
    SETTINGS_PER_CHUNK,
    EvaluationJob,
    SettingSource,
    candidate_grid,
    chunks_of,
    reachable,
    require_chunk_size,
)
from ...execution.executor import Executor, InProcess
from ...execution.fingerprint import job_fingerprint
from ...execution.progress import Progress, Silent
from ...formats.files.journal import ChunkJournal
from ...part import Dimension
from ...planning import Plan, assigned_setting, planned_not_measurable, without_allowed_error
from ...planning.cover.minimum_cover import DEFAULT_TIME_LIMIT_S
from ...planning.inspection import Inspection
from .candidate_search import CandidateSearch
from .choice import Choice
from .plan_steps import AfterChoice
from .refine import Arrangement

__all__ = ["plan"]

_WORTH_A_JOURNAL = 8
"""Chunks from which on a job is not begun anew when it is started again."""


def plan(
    inspection: Inspection,
    *,
    seed: int | None = None,
    progress: Progress | None = None,
    executor: Executor | None = None,
    settings_per_chunk: int = SETTINGS_PER_CHUNK,
    journal: str | PathLike[str] | None = None,
    refine: bool = True,
    prove: bool = True,
    time_limit_s: float = DEFAULT_TIME_LIMIT_S,
    gap: float = 0.0,
) -> Plan:
    """The fewest sensor settings that measure every dimension as accurately and as surely as required.

    Candidates are evaluated in chunks, of which only what the cover needs is kept: their number is bounded by time,
    not by memory. The choice is by the joint model. Where that gives a warning for a pair that was chosen, its
    probability is found with the exact camera, and the choice is made again with it, until all that is stated is
    either without warning or confirmed (``PlannedDimension.warning`` keeps the name). A pair that only the exact
    camera would accept is not looked for.

    Then the settings are refined over all poses that the region allows: fewer where that is possible, and surer
    (:class:`~viewgauge.planning.Refiner`). Explicit settings are the only ones there are, and are not refined.

    Dimensions that no setting meets are averaged from several, if the inspection allows it.

    Ctrl-C after the candidates are evaluated ends a step: the plan is the best so far, with its gap.

    Parameters
    ----------
    seed
        In place of the inspection's. The same seed gives the same plan, in chunks of any size, wherever they run.
    executor
        Where chunks run (:func:`~viewgauge.jobs.open_executor`); by default in this process.
    settings_per_chunk
        Bounds the memory of a process.
    journal
        A folder in which the chunks that are done are noted, so that the same job, if it is stopped, goes on where
        it was; it is taken away at the end.
    refine
        False for the best of the candidates as they are.
    prove
        False to leave out what is proven over all poses of the region: the least number of settings
        (``Plan.anywhere``), and how sure a dimension that is not met can be at most (``PlannedDimension.certificate``).
    time_limit_s
        Of the search for the fewest settings, of that for the surest, and of the refinement, each; the best so far
        counts. Only a search that is cut off may differ from run to run.
    gap
        The search for the fewest ends when the lower bound is within this share of their number.

    Raises
    ------
    InputError
        If the seed or the time limit is negative, the gap is not a share, or a chunk has no setting.
    NoCandidateError
        If there is no candidate setting to choose from.
    """
    progress, executor = progress or Silent(), executor or InProcess()
    if seed is not None:
        if seed < 0:
            raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
        inspection = replace(inspection, seed=seed)
    require_chunk_size(settings_per_chunk)
    _require_limits(time_limit_s, gap)
    dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    unusable = (*inspection.part.unusable, *refused)
    if not dimensions:
        return Plan(inspection.seed, (), tuple(planned_not_measurable(unusable)), lower_bound=0, candidate_count=0)
    threads = None if isinstance(executor, InProcess) else 1
    job = EvaluationJob.of(inspection, dimensions, _candidates(inspection, dimensions), threads=threads)
    chunks = chunks_of(job.source, settings_per_chunk)
    with _opened(journal if len(chunks) >= _WORTH_A_JOURNAL else None, inspection, job, settings_per_chunk) as notes:
        search = CandidateSearch(job, chunks, executor, notes, progress)
        choice = Choice(inspection, job, dimensions, search.kept(), progress, time_limit_s, gap)
        cover, table = choice.made()
        unmet = np.flatnonzero(assigned_setting(table, inspection.requirement.probability) < 0).tolist()
        best = search.best(unmet, choice.corrections)
        shortlist = search.looks(unmet) if inspection.looks > 1 and unmet else None
        arrangement = Arrangement(choice.poses(cover.chosen), table, best, cover.lower_bound)
        after = AfterChoice(inspection, job, choice, cover.chosen, arrangement, progress)
        if prove:
            after.bound()
        if refine:
            after.refine(time_limit_s)
        if shortlist is not None:
            after.average(unmet, shortlist)
        if prove:
            after.certify()
        if notes:
            notes.discard()
    return after.plan(unusable)


def _require_limits(time_limit_s: float, gap: float) -> None:
    if not time_limit_s >= 0:
        raise InputError("not a time", key="time limit", got=time_limit_s, expected="seconds, 0 or more")
    if not 0 <= gap < 1:
        raise InputError("not a gap", key="gap", got=gap, expected="a share from 0 on and below 1, such as 0.1")


def _candidates(inspection: Inspection, dimensions: tuple[Dimension, ...]) -> SettingSource:
    if inspection.settings is None:
        return candidate_grid(inspection, dimensions)
    if not inspection.settings.ids:
        raise NoCandidateError("no candidate setting is left: the settings file holds none")
    return reachable(inspection, dimensions)


@contextmanager
def _opened(
    folder: str | PathLike[str] | None, inspection: Inspection, job: EvaluationJob, settings_per_chunk: int
) -> Iterator[ChunkJournal | None]:
    if folder is None:
        yield None
        return
    fingerprint = job_fingerprint(inspection, job, settings_per_chunk)
    with ChunkJournal(folder, fingerprint, target=Path(folder).parent) as notes:
        yield notes
