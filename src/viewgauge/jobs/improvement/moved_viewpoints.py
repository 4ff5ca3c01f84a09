"""What is met from candidates that move: with other lenses, or from other distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Evaluator
from ...exceptions import NoCandidateError
from ...execution.chunks import candidate_grid
from ...planning.improve.improvement import Change
from ...planning.improve.knobs import Knob, Rig
from ...planning.improve.least_change import SHORT, meeting, met_interval
from ...planning.inspection import Inspection

__all__ = ["MovedViewpoints"]

_LADDER = 2.0 ** (np.arange(-8, 9) / 4)  # of focal lengths and distances: a quarter to four times today's


class MovedViewpoints:
    """What is met from candidates that move with a knob; the characteristics are those of the evaluator, by index."""

    def __init__(self, inspection: Inspection, evaluator: Evaluator, setup: Rig, knob: Knob) -> None:
        self._inspection, self._evaluator, self._setup, self._knob = inspection, evaluator, setup, knob
        every = range(len(evaluator.characteristics))
        self._ladder = _LADDER.tolist()
        self._met = np.array([self.met(factor, every) for factor in self._ladder])

    def met(self, factor: float, asked: Sequence[int]) -> NDArray[np.bool_]:
        """``(d,)``: of the characteristics that are asked about those that are met with a factor."""
        changed = self._knob.turned(self._setup, factor)
        options = replace(self._inspection.candidates, distance_mm=changed.distance_mm)
        if changed.distance_mm[0] == changed.distance_mm[1]:
            options = replace(options, distances=1)
        inspection = replace(self._inspection, camera=changed.camera, candidates=options)
        try:
            grid = candidate_grid(inspection, self._inspection.part.characteristics)
        except NoCandidateError:
            return np.zeros(len(asked), dtype=bool)
        evaluator = self._evaluator.of(asked).with_errors(changed.camera, changed.pose_error)
        return np.asarray(meeting(evaluator, grid.poses(0, len(grid))).any(axis=0))

    def change(self, asked: Sequence[int]) -> Change:
        """The interval nearest to today in which all that is asked about is met, verified at its ends."""
        met = np.asarray(self._met[:, list(asked)].all(axis=1))
        today = self._knob.today(self._setup)
        found = met_interval(self._ladder, met.tolist(), lambda factor: bool(self.met(factor, asked).all()))
        names = self._evaluator.characteristics
        if found is None:
            never = [j for j in asked if not self._met[:, j].any()]
            return Change(None, None, None, False, None, not met.any(), tuple(names[j].id for j in never))
        low, high = found.low, found.high
        # met today: the nearer end is how far it may change; not met: how far it must
        ends = [end for end in (low, high) if end is not None]
        nearest = min(ends, key=lambda end: abs(np.log(end))) if ends else None
        verified = all(bool(self.met(end, asked).all()) for end in ends)
        beyond = ([] if low is None else [low / (1 + SHORT)]) + ([] if high is None else [high * (1 + SHORT)])
        verified &= not any(bool(self.met(factor, asked).all()) for factor in beyond)
        interval = (None if low is None else low * today, None if high is None else high * today)
        value = None if nearest is None else nearest * today
        return Change(nearest, value, interval, nearest is None, None, verified, self._limiting(nearest, low, asked))

    def _limiting(self, end: float | None, low: float | None, asked: Sequence[int]) -> tuple[str, ...]:
        """The characteristics that are not met any more just beyond an end."""
        if end is None:
            return ()
        met = self.met(end / (1 + SHORT) if end == low else end * (1 + SHORT), asked)
        return tuple(self._evaluator.characteristics[j].id for k, j in enumerate(asked) if not met[k])
