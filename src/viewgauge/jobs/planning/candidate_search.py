"""Passes over all candidates, chunk by chunk: what a cover may need of them, and what is best for a characteristic."""

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
from ...planning.averaging.shortlist import AcquisitionShortlist
from .averaging_search import acquisitions_chunk

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
        kept = Undominated(len(self._job.characteristics))

        def arrays(found: Undominated) -> _Arrays:
            return {"index": found.index, "level": found.level, "certain": found.certain}

        what = f"Evaluating {len(self._job.source)} candidates"
        for entry in self._pass(what, accepted_chunk, self._job, arrays):
            kept.add(**entry)
        return kept

    def best(self, not_met: Sequence[int], corrections: Corrections) -> dict[int, tuple[BestRows, int]]:
        """Of characteristics that are not met the best of all candidates: a second pass, for them alone."""
        if not not_met:
            return {}
        place = {j: k for k, j in enumerate(not_met)}
        these = np.isin(corrections.characteristic, list(not_met))
        job = replace(
            self._job,
            characteristics=tuple(self._job.characteristics[j] for j in not_met),
            corrections=Corrections(
                corrections.viewpoint[these],
                np.array([place[j] for j in corrections.characteristic[these].tolist()], dtype=np.int64),
                corrections.probability[these],
                corrections.expected_accuracy[these],
            ),
        )
        rows: BestRows | None = None
        what = f"Finding what limits {len(not_met)} characteristics"
        for entry in self._pass(what, best_chunk, job, BestRows.arrays):
            found = BestRows.from_arrays(entry)
            rows = found if rows is None else rows.merged(found)
        assert rows is not None  # there is at least one chunk
        return {j: (rows, place[j]) for j in not_met}

    def acquisitions(self, not_met: Sequence[int]) -> AcquisitionShortlist:
        """Of characteristics that are not met, in this order, the viewpoints from which a mean may be worth having."""
        job = replace(self._job, characteristics=tuple(self._job.characteristics[j] for j in not_met))
        whole: AcquisitionShortlist | None = None
        what = f"Searching for viewpoints to average {len(not_met)} characteristics from"
        for entry in self._pass(what, acquisitions_chunk, job, AcquisitionShortlist.arrays):
            found = AcquisitionShortlist(**entry)
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
