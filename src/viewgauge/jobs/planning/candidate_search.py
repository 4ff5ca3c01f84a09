"""Passes over all candidates, chunk by chunk: what a cover may need of them, and what is best for a dimension."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...evaluation import BestRows
from ...execution.chunks import Chunk, Corrections, EvaluationJob, accepted_chunk, best_chunk
from ...execution.executor import Executor
from ...execution.progress import Progress
from ...formats.files.journal import ChunkJournal, read_entry
from ...planning import Undominated
from ...planning.averaging.shortlist import LookShortlist
from .averaging_search import looks_chunk

__all__ = ["CandidateSearch"]

_Result = TypeVar("_Result")
_Arrays = Mapping[str, NDArray[np.generic]]


class CandidateSearch:
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

    def looks(self, unmet: Sequence[int]) -> LookShortlist:
        """Of dimensions that are not met, in this order, the settings from which a mean may be worth having."""
        job = replace(self._job, dimensions=tuple(self._job.dimensions[j] for j in unmet))
        whole: LookShortlist | None = None
        what = f"Looking for settings to average {len(unmet)} dimensions from"
        for entry in self._pass(what, looks_chunk, job, LookShortlist.arrays):
            found = LookShortlist(**entry)
            whole = found if whole is None else whole.merged(found)
        assert whole is not None  # there is at least one chunk
        return whole

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
