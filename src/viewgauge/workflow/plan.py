"""The main job: the fewest settings that measure every dimension as required."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib.metadata import version
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..evaluation import BestRows, TableBlock
from ..exceptions import InputError, NoCandidateError
from ..io.journal import ChunkJournal, read_entry
from ..part import Dimension
from ..part.gauge_table import GaugeTable
from ..planning import (
    CandidateGrid,
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
    Corrections,
    EvaluationJob,
    SettingSource,
    accepted_chunk,
    best_chunk,
    chunks_of,
    evaluator_of,
    simulate_pairs,
)
from .execution import Executor, InProcess
from .inspection import Inspection
from .progress import Progress, Silent

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
    if settings_per_chunk < 1:
        raise InputError(
            "a chunk has no setting", key="chunk", got=settings_per_chunk, expected="a whole number from 1 on"
        )
    dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    unusable = (*inspection.part.unusable, *refused)
    if not dimensions:
        return Plan(inspection.seed, (), tuple(not_measurable(unusable)), lower_bound=0, candidate_count=0)
    search = _Search(inspection, dimensions, executor, settings_per_chunk, progress)
    kept = search.kept(journal)
    choice = _Choice(inspection, search.job, dimensions, kept, progress)
    cover, table = choice.made()
    met = assigned_setting(table, inspection.requirement.probability) >= 0
    explicit = inspection.settings
    return compose_plan(
        table,
        choice.poses(cover.chosen),
        [explicit.ids[k] if explicit else f"S{n}" for n, k in enumerate(cover.chosen, start=1)],
        search.best([j for j in range(len(dimensions)) if not met[j]], choice.corrections),
        dimensions,
        unusable,
        inspection.requirement,
        lower_bound=cover.lower_bound,
        candidate_count=len(search.job.source),
        seed=inspection.seed,
    )


class _Search:
    """Passes over all candidates."""

    def __init__(
        self,
        inspection: Inspection,
        dimensions: tuple[Dimension, ...],
        executor: Executor,
        settings_per_chunk: int,
        progress: Progress,
    ) -> None:
        self._inspection, self._dimensions = inspection, dimensions
        self._executor, self._settings_per_chunk, self._progress = executor, settings_per_chunk, progress
        threads = None if isinstance(executor, InProcess) else 1
        self.job = EvaluationJob.of(inspection, dimensions, _candidates(inspection, dimensions), threads=threads)
        """What all chunks share."""

    def kept(self, journal: str | PathLike[str] | None) -> Undominated:
        """The candidates that a cover may need."""
        chunks, kept = chunks_of(self.job.source, self._settings_per_chunk), Undominated(len(self._dimensions))
        with (
            _opened(journal if len(chunks) >= _WORTH_A_JOURNAL else None, self._fingerprint()) as notes,
            self._progress.stage(f"Evaluating {len(self.job.source)} candidates", len(self.job.source)) as advance,
        ):
            done = notes.done() if notes else {}
            for k, path in done.items():
                kept.add(**read_entry(path))
                advance(chunks[k][1] - chunks[k][0])
            left = [k for k in range(len(chunks)) if k not in done]
            for at, found in self._executor.run(accepted_chunk, self.job, [chunks[k] for k in left]):
                if notes:
                    notes.record(left[at], index=found.index, level=found.level, certain=found.certain)
                kept.merge(found)
                advance(chunks[left[at]][1] - chunks[left[at]][0])
            if notes:
                notes.discard()
        return kept

    def best(self, unmet: Sequence[int], corrections: Corrections) -> dict[int, tuple[BestRows, int]]:
        """Of dimensions that are not met the best of all candidates: a second pass, for them alone."""
        if not unmet:
            return {}
        place = {j: k for k, j in enumerate(unmet)}
        these = np.isin(corrections.dimension, list(unmet))
        job = replace(
            self.job,
            dimensions=tuple(self._dimensions[j] for j in unmet),
            corrections=Corrections(
                corrections.setting[these],
                np.array([place[j] for j in corrections.dimension[these].tolist()], dtype=np.int64),
                corrections.probability[these],
                corrections.expected_accuracy[these],
            ),
        )
        chunks = chunks_of(job.source, self._settings_per_chunk)
        rows: BestRows | None = None
        with self._progress.stage(f"Finding what limits {len(unmet)} dimensions", len(job.source)) as advance:
            for at, found in self._executor.run(best_chunk, job, chunks):
                rows = found if rows is None else rows.merged(found)
                advance(chunks[at][1] - chunks[at][0])
        assert rows is not None  # there is at least one chunk
        return {j: (rows, place[j]) for j in unmet}

    def _fingerprint(self) -> str:
        """All that the chunks' results depend on."""
        i = self._inspection
        settings = b"" if i.settings is None else i.settings.T_part_camera.tobytes()
        head = (i.head.covariance.tobytes(), np.asarray(i.head.T_camera_head).tobytes())
        said = [version("viewgauge"), self._settings_per_chunk, i.seed, sorted(i.inputs.items()), i.camera]
        said += [i.requirement, i.candidates, i.limits, [d.id for d in self._dimensions]]
        digest = hashlib.sha256(repr(said).encode())
        for part in (settings, *head):
            digest.update(part)
        return digest.hexdigest()


def _candidates(inspection: Inspection, dimensions: tuple[Dimension, ...]) -> SettingSource:
    if inspection.settings is None:
        points = GaugeTable.of(dimensions).points
        return CandidateGrid(points, inspection.part.mesh, inspection.camera, inspection.candidates, inspection.seed)
    if not inspection.settings.ids:
        raise NoCandidateError("no candidate setting is left: the settings file holds none")
    return inspection.settings


@contextmanager
def _opened(folder: str | PathLike[str] | None, fingerprint: str) -> Iterator[ChunkJournal | None]:
    if folder is None:
        yield None
        return
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
        while True:  # each time round at least one doubtful pair fewer
            with self._progress.stage("Choosing the fewest settings"):
                cover = choose_settings(self._kept)
            index = np.array(cover.chosen, dtype=np.int64)
            table = self.corrections.applied(evaluator_of(self._job).table(self.poses(cover.chosen)), index)
            pairs = self._doubtful(table, index)
            if not len(pairs):
                return cover, table
            with self._progress.stage("Confirming what the small-error model does not answer for"):
                self._confirm(table, index, pairs)

    def poses(self, chosen: Sequence[int]) -> NDArray[np.float64]:
        """``T_part_camera`` ``(K, 4, 4)`` mm of settings by index."""
        return np.array([self._job.source.poses(k, k + 1)[0] for k in chosen]).reshape(-1, 4, 4)

    def _doubtful(self, table: TableBlock, index: NDArray[np.int64]) -> NDArray[np.int64]:
        """Chosen pairs ``(n, 2)`` (row of the table, dimension) with a warning that nobody has looked into."""
        row = assigned_setting(table, self._inspection.requirement.probability)
        known = set(zip(self.corrections.setting.tolist(), self.corrections.dimension.tolist(), strict=True))
        pairs = [
            (k, j)
            for j, k in enumerate(row.tolist())
            if k >= 0 and table.validity[k, j] and (int(index[k]), j) not in known
        ]
        return np.array(pairs, dtype=np.int64).reshape(-1, 2)

    def _confirm(self, table: TableBlock, index: NDArray[np.int64], pairs: NDArray[np.int64]) -> None:
        """Ask the exact camera, and lower the levels of what it finds less sure."""
        row, dimension = pairs.T
        poses = self.poses([int(k) for k in index])
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
        found = probability_levels(estimates.probability, self._inspection.requirement.probability)
        # lowered, never raised: what was found needless stays needless (proof in planning/dominance.py)
        level[at] = np.minimum(level[at], found)
        self._kept = Undominated(len(self._dimensions))
        self._kept.add(kept.index, level, kept.certain)
