"""The main job: the fewest settings that measure every dimension as required."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..evaluation import BestRows, TableBlock
from ..exceptions import InputError, NoCandidateError
from ..io.journal import ChunkJournal, read_entry
from ..part import Dimension
from ..planning import (
    Cover,
    Plan,
    Undominated,
    assigned_setting,
    choose_settings,
    compose_plan,
    not_measurable,
    probability_levels,
    without_allowed_error,
)
from .chunks import (
    DEFAULT_PRECISION,
    SETTINGS_PER_CHUNK,
    Chunk,
    Corrections,
    EvaluationJob,
    SettingSource,
    accepted_chunk,
    best_chunk,
    candidate_grid,
    chunks_of,
    evaluator_of,
    require_chunk_size,
    simulate_pairs,
)
from .execution import Executor, InProcess
from .fingerprint import job_fingerprint
from .inspection import Inspection
from .progress import Progress, Silent

__all__ = ["plan"]

_Result = TypeVar("_Result")
_Arrays = Mapping[str, NDArray[np.generic]]

_MOST_AHEAD = 63
"""Settings of a dimension that the exact camera is asked about beside the chosen one, at most, each time round."""

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
) -> Plan:
    """The fewest sensor settings that measure every dimension as accurately and as surely as required.

    Candidates are evaluated in chunks, of which only what the cover needs is kept: their number is bounded by time,
    not by memory. The choice is by the joint model. Where that gives a warning for a pair that was chosen, its
    probability is found with the exact camera, and the choice is made again with it, until all that is stated is
    either without warning or confirmed (``PlannedDimension.warning`` keeps the name). A pair that only the exact
    camera would accept is not looked for.

    Parameters
    ----------
    seed
        In place of the inspection's. The same seed gives the same plan, in chunks of any size, wherever they run.
    executor
        Where chunks run (:func:`~viewgauge.workflow.open_executor`); by default in this process.
    settings_per_chunk
        Bounds the memory of a process.
    journal
        A folder in which the chunks that are done are noted, so that the same job, if it is stopped, goes on where
        it was; it is taken away at the end.

    Raises
    ------
    InputError
        If the seed is negative, or a chunk has no setting.
    NoCandidateError
        If there is no candidate setting to choose from.
    """
    progress, executor = progress or Silent(), executor or InProcess()
    if seed is not None:
        if seed < 0:
            raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
        inspection = replace(inspection, seed=seed)
    require_chunk_size(settings_per_chunk)
    dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    unusable = (*inspection.part.unusable, *refused)
    if not dimensions:
        return Plan(inspection.seed, (), tuple(not_measurable(unusable)), lower_bound=0, candidate_count=0)
    threads = None if isinstance(executor, InProcess) else 1
    job = EvaluationJob.of(inspection, dimensions, _candidates(inspection, dimensions), threads=threads)
    chunks = chunks_of(job.source, settings_per_chunk)
    with _opened(journal if len(chunks) >= _WORTH_A_JOURNAL else None, inspection, job, settings_per_chunk) as notes:
        search = _Search(job, chunks, executor, notes, progress)
        choice = _Choice(inspection, job, dimensions, search.kept(), progress)
        cover, table = choice.made()
        met = assigned_setting(table, inspection.requirement.probability) >= 0
        best = search.best([j for j in range(len(dimensions)) if not met[j]], choice.corrections)
        if notes:
            notes.discard()
    explicit = inspection.settings
    return compose_plan(
        table,
        choice.poses(cover.chosen),
        [explicit.ids[k] if explicit else f"S{n}" for n, k in enumerate(cover.chosen, start=1)],
        best,
        dimensions,
        unusable,
        inspection.requirement,
        lower_bound=cover.lower_bound,
        candidate_count=len(job.source),
        seed=inspection.seed,
    )


class _Search:
    """Passes over all candidates; with a journal each goes on where an earlier process was stopped."""

    def __init__(
        self,
        job: EvaluationJob,
        chunks: Sequence[Chunk],
        executor: Executor,
        notes: ChunkJournal | None,
        progress: Progress,
    ) -> None:
        self._job, self._chunks, self._executor = job, chunks, executor
        self._notes, self._progress = notes, progress
        self._passes = 0

    def kept(self) -> Undominated:
        """The candidates that a cover may need."""
        kept = Undominated(len(self._job.dimensions))

        def arrays(found: Undominated) -> _Arrays:
            return {"index": found.index, "level": found.level, "certain": found.certain}

        what = f"Evaluating {len(self._job.source)} candidates"
        for entry in self._pass(what, accepted_chunk, self._job, arrays):
            kept.add(**entry)
        return kept

    def best(self, unmet: Sequence[int], corrections: Corrections) -> dict[int, tuple[BestRows, int]]:
        """Of dimensions that are not met the best of all candidates: a second pass, for them alone."""
        if not unmet:
            return {}
        place = {j: k for k, j in enumerate(unmet)}
        these = np.isin(corrections.dimension, list(unmet))
        job = replace(
            self._job,
            dimensions=tuple(self._job.dimensions[j] for j in unmet),
            corrections=Corrections(
                corrections.setting[these],
                np.array([place[j] for j in corrections.dimension[these].tolist()], dtype=np.int64),
                corrections.probability[these],
                corrections.expected_accuracy[these],
            ),
        )
        rows: BestRows | None = None
        what = f"Finding what limits {len(unmet)} dimensions"
        for entry in self._pass(what, best_chunk, job, BestRows.arrays):
            found = BestRows.from_arrays(entry)
            rows = found if rows is None else rows.merged(found)
        assert rows is not None  # there is at least one chunk
        return {j: (rows, place[j]) for j in unmet}

    def _pass(
        self,
        what: str,
        function: Callable[[EvaluationJob, Chunk], _Result],
        job: EvaluationJob,
        arrays: Callable[[_Result], _Arrays],
    ) -> Iterator[dict[str, Any]]:
        """What is found in each chunk, as arrays, in any order."""
        first, chunks = self._passes * len(self._chunks), self._chunks  # in the journal the passes follow each other
        self._passes += 1
        with self._progress.stage(what, len(job.source)) as advance:
            noted = self._notes.done() if self._notes else {}
            done = {k: noted[first + k] for k in range(len(chunks)) if first + k in noted}
            for k, path in done.items():
                yield read_entry(path)
                advance(chunks[k][1] - chunks[k][0])
            left = [k for k in range(len(chunks)) if k not in done]
            for at, found in self._executor.run(function, job, [chunks[k] for k in left]):
                entry = dict(arrays(found))
                if self._notes:
                    self._notes.record(first + left[at], **entry)
                yield entry
                advance(chunks[left[at]][1] - chunks[left[at]][0])


def _candidates(inspection: Inspection, dimensions: tuple[Dimension, ...]) -> SettingSource:
    if inspection.settings is None:
        return candidate_grid(inspection, dimensions)
    if not inspection.settings.ids:
        raise NoCandidateError("no candidate setting is left: the settings file holds none")
    return inspection.settings


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


class _Choice:
    """The cover, chosen again until no chosen pair rests on a doubtful probability."""

    def __init__(
        self,
        inspection: Inspection,
        job: EvaluationJob,
        dimensions: tuple[Dimension, ...],
        kept: Undominated,
        progress: Progress,
    ) -> None:
        self._inspection, self._job, self._dimensions = inspection, job, dimensions
        self._kept, self._progress = kept, progress
        self.corrections = Corrections()
        """What the exact camera said of pairs."""

    def made(self) -> tuple[Cover, TableBlock]:
        """The cover, of indices of settings, and the table of its settings with what the exact camera said."""
        ahead = 0
        while True:  # each time round at least one doubtful pair fewer
            with self._progress.stage("Choosing the fewest settings"):
                cover = choose_settings(self._kept)
            index = np.array(cover.chosen, dtype=np.int64)
            table = self._table(index)
            dimension, row = self._chosen_doubtful(table, index)
            if not len(dimension):
                return cover, table
            with self._progress.stage("Confirming what the small-error model does not answer for"):
                # where one is refuted the next choice would be as doubtful: ever more of the surest are looked into
                self._confirm(np.append(index[row], self._next_in_line(dimension, ahead)))
            ahead = min(2 * ahead + 1, _MOST_AHEAD)

    def poses(self, chosen: Sequence[int]) -> NDArray[np.float64]:
        """``T_part_camera`` ``(K, 4, 4)`` mm of settings by index."""
        return np.array([self._job.source.poses(k, k + 1)[0] for k in chosen]).reshape(-1, 4, 4)

    def _table(self, index: NDArray[np.int64]) -> TableBlock:
        """The table of some settings, ascending, with what the exact camera said."""
        return self.corrections.applied(evaluator_of(self._job).table(self.poses(index.tolist())), index)

    def _doubtful(self, table: TableBlock, index: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(n, d)``: accepted pairs of settings with a warning that nobody has looked into."""
        doubtful = (table.validity > 0) & (table.probability >= self._inspection.requirement.probability)
        known = np.isin(self.corrections.setting, index)
        row = np.searchsorted(index, self.corrections.setting[known])
        doubtful[row, self.corrections.dimension[known]] = False
        return np.asarray(doubtful & table.visible)

    def _chosen_doubtful(
        self, table: TableBlock, index: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Dimensions whose chosen pair is doubtful, and the row of its setting."""
        row = assigned_setting(table, self._inspection.requirement.probability)
        dimension = np.flatnonzero(row >= 0)
        dimension = dimension[self._doubtful(table, index)[row[dimension], dimension]]
        return dimension, row[dimension]

    def _next_in_line(self, dimensions: NDArray[np.int64], count: int) -> NDArray[np.int64]:
        """Of each dimension the surest settings that are not beyond doubt and not looked into, by index."""
        index, level = self._kept.index, self._kept.level
        found = [np.zeros(0, np.int64)]
        for j in dimensions:
            known = np.isin(index, self.corrections.setting[self.corrections.dimension == j])
            open_ = np.flatnonzero((level[:, j] > 0) & ~self._kept.certain[:, j] & ~known)
            found.append(index[open_[np.argsort(-level[open_, j].astype(int), kind="stable")[:count]]])
        return np.concatenate(found)

    def _confirm(self, settings: NDArray[np.int64]) -> None:
        """Ask the exact camera about doubtful pairs of settings, and lower the levels of what it finds less sure."""
        index = np.unique(settings)
        table = self._table(index)
        pairs = np.argwhere(self._doubtful(table, index))
        row, dimension = pairs.T
        poses = self.poses(index.tolist())
        estimates = simulate_pairs(table, pairs, poses, self._job, DEFAULT_PRECISION, self._inspection.seed)
        before = self.corrections
        self.corrections = Corrections(
            np.append(before.setting, index[row]),
            np.append(before.dimension, dimension),
            np.append(before.probability, estimates.probability),
            np.append(before.expected_accuracy, estimates.expected_accuracy),
        )
        kept, level = self._kept, self._kept.level.copy()
        at = np.searchsorted(kept.index, index[row]), dimension
        found = probability_levels(
            estimates.probability, self._inspection.requirement.probability, len(self._job.source)
        )
        # lowered, never raised: what was found needless stays needless (proof in planning/dominance.py)
        level[at] = np.minimum(level[at], found)
        self._kept = Undominated(len(self._dimensions))
        self._kept.add(kept.index, level, kept.certain)
