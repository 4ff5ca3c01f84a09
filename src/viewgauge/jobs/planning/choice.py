"""The choice of the fewest candidates, none of which rests on a doubtful probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import TableBlock
from ...execution.chunks import DEFAULT_PRECISION, Corrections, EvaluationJob, evaluator_of, simulate_pairs
from ...execution.progress import Progress
from ...part import Characteristic
from ...planning import Cover, Undominated, assigned_viewpoint, choose_viewpoints, probability_levels
from ...planning.cover.travel import least_travel
from ...planning.inspection import Inspection

__all__ = ["Choice"]

_MOST_AHEAD = 63
"""Viewpoints of a characteristic that the full camera model confirms beside the chosen one, at most, each time round.
"""


class Choice:
    """The cover, chosen again until no chosen pair rests on a doubtful probability."""

    def __init__(
        self,
        inspection: Inspection,
        job: EvaluationJob,
        characteristics: tuple[Characteristic, ...],
        kept: Undominated,
        progress: Progress,
        time_limit_s: float,
        gap: float,
    ) -> None:
        self._inspection, self._job, self._characteristics = inspection, job, characteristics
        self._progress, self._time_limit_s, self._gap = progress, time_limit_s, gap
        self.kept = kept
        """The candidates to choose from, with the levels as they are known."""
        self.interrupted = False
        """The search was interrupted: what was found so far was chosen."""
        self.corrections = Corrections()
        """The probabilities of pairs that the full camera model corrected."""

    def made(self) -> tuple[Cover, TableBlock]:
        """The cover, of indices of viewpoints, and the table of its viewpoints with the corrections."""
        ahead = 0
        while True:  # each time round at least one doubtful pair fewer
            with self._progress.stage("Choosing the fewest viewpoints"):
                cover = self._cover()
            index = np.array(cover.chosen, dtype=np.int64)
            table = self._table(index)
            characteristic, row = self._chosen_doubtful(table, index)
            if not len(characteristic):
                return self._travelled(cover)
            with self._progress.stage("Confirming what the small-error model does not answer for"):
                # where one is refuted the next choice would be as doubtful: ever more of the best are confirmed
                self._confirm(np.append(index[row], self._next_in_line(characteristic, ahead)))
            ahead = min(2 * ahead + 1, _MOST_AHEAD)

    def _cover(self) -> Cover:
        try:
            return choose_viewpoints(self.kept, 0.0 if self.interrupted else self._time_limit_s, self._gap)
        except KeyboardInterrupt:
            self.interrupted = True
            return choose_viewpoints(self.kept, 0.0, self._gap)

    def _travelled(self, cover: Cover) -> tuple[Cover, TableBlock]:
        """Of covers as small and as probable one with a shorter tour, by pairs that are beyond doubt."""
        kept = self.kept
        reached = kept.level.any(axis=0)
        level = np.where(kept.certain, kept.level, 0)
        chosen = np.searchsorted(kept.index, cover.chosen)
        level[chosen] = kept.level[chosen]
        poses = self.poses(kept.index.tolist())
        rows = least_travel(level[:, reached], poses[:, :3, 3], tuple(chosen.tolist()))
        found = tuple(kept.index[list(rows)].tolist())
        return replace(cover, chosen=found), self._table(np.array(found, dtype=np.int64))

    def poses(self, chosen: Sequence[int]) -> NDArray[np.float64]:
        """``T_part_camera`` ``(K, 4, 4)`` mm of viewpoints by index."""
        return np.array([self._job.source.poses(k, k + 1)[0] for k in chosen]).reshape(-1, 4, 4)

    def _table(self, index: NDArray[np.int64]) -> TableBlock:
        """The table of some viewpoints, ascending, with the corrections of the full camera model."""
        return self.corrections.applied(evaluator_of(self._job).table(self.poses(index.tolist())), index)

    def _doubtful(self, table: TableBlock, index: NDArray[np.int64]) -> NDArray[np.bool_]:
        """``(n, d)``: accepted pairs of viewpoints with a warning that are not confirmed yet."""
        doubtful = (table.validity > 0) & (table.probability >= self._inspection.requirement.probability)
        known = np.isin(self.corrections.viewpoint, index)
        row = np.searchsorted(index, self.corrections.viewpoint[known])
        doubtful[row, self.corrections.characteristic[known]] = False
        return np.asarray(doubtful & table.visible)

    def _chosen_doubtful(
        self, table: TableBlock, index: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Characteristics whose chosen pair is doubtful, and the row of its viewpoint."""
        row = assigned_viewpoint(table, self._inspection.requirement.probability)
        characteristic = np.flatnonzero(row >= 0)
        characteristic = characteristic[self._doubtful(table, index)[row[characteristic], characteristic]]
        return characteristic, row[characteristic]

    def _next_in_line(self, characteristics: NDArray[np.int64], count: int) -> NDArray[np.int64]:
        """Indices of each characteristic's most probable viewpoints that are neither beyond doubt nor confirmed."""
        index, level = self.kept.index, self.kept.level
        found = [np.zeros(0, np.int64)]
        for j in characteristics:
            known = np.isin(index, self.corrections.viewpoint[self.corrections.characteristic == j])
            open_ = np.flatnonzero((level[:, j] > 0) & ~self.kept.certain[:, j] & ~known)
            found.append(index[open_[np.argsort(-level[open_, j].astype(int), kind="stable")[:count]]])
        return np.concatenate(found)

    def _confirm(self, viewpoints: NDArray[np.int64]) -> None:
        """Ask the full camera model about doubtful pairs of viewpoints, and lower the levels of what it finds less
        probable.
        """
        index = np.unique(viewpoints)
        table = self._table(index)
        pairs = np.argwhere(self._doubtful(table, index))
        row, characteristic = pairs.T
        poses = self.poses(index.tolist())
        estimates = simulate_pairs(table, pairs, poses, self._job, DEFAULT_PRECISION, self._inspection.seed)
        before = self.corrections
        self.corrections = Corrections(
            np.append(before.viewpoint, index[row]),
            np.append(before.characteristic, characteristic),
            np.append(before.probability, estimates.probability),
            np.append(before.expected_accuracy, estimates.expected_accuracy),
        )
        kept, level = self.kept, self.kept.level.copy()
        at = np.searchsorted(kept.index, index[row]), characteristic
        found = probability_levels(
            estimates.probability, self._inspection.requirement.probability, len(self._job.source)
        )
        # lowered, never raised: what was found needless stays needless (proof in planning/cover/dominance.py)
        level[at] = np.minimum(level[at], found)
        self.kept = Undominated(len(self._characteristics))
        self.kept.add(kept.index, level, kept.certain)
