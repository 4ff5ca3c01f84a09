"""What comes after the choice among the candidates: better settings, several looks, proofs, and the plan of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...execution.chunks import EvaluationJob
from ...execution.progress import Progress
from ...part import Unusable
from ...planning import Averaged, CandidateGrid, Plan, compose_plan
from ...planning.averaging.shortlist import LookShortlist
from ...planning.bounds import Certificate, SettingsBound
from ...planning.inspection import ExplicitSettings, Inspection
from .averaged_plan import averaged
from .choice import Choice
from .prove import certificates, least_anywhere
from .refine import Arrangement, refined

__all__ = ["AfterChoice"]

_Result = TypeVar("_Result")


class AfterChoice:
    """The steps from the arrangement that was chosen to the plan. Ctrl-C ends one, and those after it are left out.

    Parameters
    ----------
    chosen
        Of the job's source, by index: the settings of the arrangement.
    """

    def __init__(
        self,
        inspection: Inspection,
        job: EvaluationJob,
        choice: Choice,
        chosen: Sequence[int],
        arrangement: Arrangement,
        progress: Progress,
    ) -> None:
        self._inspection, self._job, self._choice, self._progress = inspection, job, choice, progress
        self._chosen, self._arrangement = list(chosen), arrangement
        self._interrupted = choice.interrupted
        self._anywhere: SettingsBound | None = None
        self._averaged: dict[int, Averaged] = {}
        self._certificates: dict[int, Certificate] = {}

    def refine(self, time_limit_s: float) -> None:
        """Fewer settings, and surer ones, over all poses of the region; explicit settings stay as they are."""
        if isinstance(self._job.source, CandidateGrid):
            least = 1 if self._anywhere is None else self._anywhere.count
            step = partial(
                refined,
                self._job,
                self._choice,
                self._arrangement,
                seed=self._inspection.seed,
                time_limit_s=time_limit_s,
                least=least,
            )
            before, self._arrangement = self._arrangement, self._ended("Refining the settings", step, self._arrangement)
            if self._anywhere is not None and len(self._arrangement.best) < len(before.best):
                self.bound()  # more is measured now

    def bound(self) -> None:
        """How few settings would do anywhere in the region."""
        if isinstance(self._job.source, CandidateGrid):
            step = partial(least_anywhere, self._job, self._choice, self._arrangement)
            self._anywhere = self._ended("Bounding the number of settings over all poses", step, self._anywhere)

    def average(self, unmet: Sequence[int], shortlist: LookShortlist) -> None:
        """Settings to average from, for what no candidate meets; ``unmet`` are those of the shortlist, in its order."""
        none: tuple[Arrangement, dict[int, Averaged], NDArray[np.int64]]
        none = self._arrangement, {}, np.zeros(0, dtype=np.int64)
        most, seed = self._inspection.looks, self._inspection.seed
        step = partial(averaged, self._job, self._arrangement, unmet, shortlist, most, seed)
        self._arrangement, self._averaged, added = self._ended("Averaging several looks", step, none)
        self._chosen += added.tolist()

    def certify(self) -> None:
        """What is proven of each dimension that is not met."""
        unmet = [j for j in self._arrangement.best if j not in self._averaged]
        if isinstance(self._job.source, CandidateGrid) and unmet:
            step = partial(certificates, self._job, unmet)
            self._certificates = self._ended(f"Bounding {len(unmet)} dimensions over all poses", step, {})

    def plan(self, unusable: Sequence[Unusable]) -> Plan:
        """The plan; with what cannot be measured, for the record."""
        source, arrangement = self._job.source, self._arrangement
        explicit = isinstance(source, ExplicitSettings)
        names = [f"S{n}" for n in range(1, len(arrangement.T_part_camera) + 1)]
        return compose_plan(
            arrangement.table,
            arrangement.T_part_camera,
            [source.ids[k] for k in self._chosen] if isinstance(source, ExplicitSettings) else names,
            arrangement.best,
            self._job.dimensions,
            unusable,
            self._inspection.requirement,
            lower_bound=arrangement.lower_bound,
            candidate_count=len(source),
            seed=self._inspection.seed,
            fixed_names=explicit,
            poses_of_best=self._poses_of_best(),
            averaged=self._averaged,
            certificates=self._certificates,
            refinement=arrangement.refinement,
            anywhere=self._anywhere,
            interrupted=self._interrupted,
        )

    def _poses_of_best(self) -> dict[int, NDArray[np.float64]]:
        """Of what is not met the pose from which it is surest, where it is seen at all."""
        found = {}
        for j, (rows, at) in self._arrangement.best.items():
            if rows.values.visible[at]:
                own = self._arrangement.found
                found[j] = own[j] if j in own else self._choice.poses([int(rows.setting[at])])[0]
        return found

    def _ended(self, what: str, step: Callable[[], _Result], otherwise: _Result) -> _Result:
        """What a step gives; ``otherwise`` where Ctrl-C ends it, or has ended one before."""
        if self._interrupted:
            return otherwise
        try:
            with self._progress.stage(what):
                return step()
        except KeyboardInterrupt:
            self._interrupted = True
            return otherwise
