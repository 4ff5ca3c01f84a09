"""The steps from the viewpoints that were chosen among the candidates to the plan: refinement, averaging, proofs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...execution.chunks import EvaluationJob
from ...execution.progress import Progress
from ...part import NotMeasurable
from ...planning import (
    Averaged,
    CandidateGrid,
    ChosenViewpoints,
    NotMetFindings,
    Plan,
    PlanRecord,
    compose_plan,
)
from ...planning.averaging.shortlist import AcquisitionShortlist
from ...planning.bounds import Certificate, ViewpointsBound
from ...planning.inspection import ExplicitViewpoints, Inspection
from .averaged_plan import averaged
from .choice import Choice
from .prove import certificates, least_anywhere
from .refine import Arrangement, refined

__all__ = ["PlanSteps"]

_Result = TypeVar("_Result")


class PlanSteps:
    """The steps from the chosen arrangement to the plan. Ctrl-C ends one, and those after it are left out.

    Parameters
    ----------
    chosen
        The viewpoints of the arrangement, as indices into the job's source.
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
        self._anywhere: ViewpointsBound | None = None
        self._averaged: dict[int, Averaged] = {}
        self._certificates: dict[int, Certificate] = {}

    def refine(self, time_limit_s: float) -> None:
        """Refine sampled viewpoints over all poses of the region; explicit viewpoints stay as they are."""
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
            before = self._arrangement
            self._arrangement = self._ended("Refining the viewpoints", step, before)
            if self._anywhere is not None and len(self._arrangement.best) < len(before.best):
                self.bound()  # more is measured now

    def bound(self) -> None:
        """How few viewpoints would do anywhere in the region."""
        if isinstance(self._job.source, CandidateGrid):
            step = partial(least_anywhere, self._job, self._choice, self._arrangement)
            self._anywhere = self._ended("Bounding the number of viewpoints over all poses", step, self._anywhere)

    def average(self, not_met: Sequence[int], shortlist: AcquisitionShortlist) -> None:
        """Add viewpoints to average from, for the characteristics ``not_met``, which are those of the shortlist, in its
        order.
        """
        none: tuple[Arrangement, dict[int, Averaged], NDArray[np.int64]]
        none = self._arrangement, {}, np.zeros(0, dtype=np.int64)
        most, seed = self._inspection.averaged_viewpoints, self._inspection.seed
        step = partial(averaged, self._job, self._arrangement, not_met, shortlist, most, seed)
        self._arrangement, self._averaged, added = self._ended("Averaging several viewpoints", step, none)
        self._chosen += added.tolist()

    def certify(self) -> None:
        """What is proven of each characteristic that is not met."""
        not_met = [j for j in self._arrangement.best if j not in self._averaged]
        if isinstance(self._job.source, CandidateGrid) and not_met:
            step = partial(certificates, self._job, not_met)
            self._certificates = self._ended(f"Bounding {len(not_met)} characteristics over all poses", step, {})

    def plan(self, not_measurable: Sequence[NotMeasurable]) -> Plan:
        """The plan; with what cannot be measured, for the record."""
        source, arrangement = self._job.source, self._arrangement
        names = tuple(f"S{n}" for n in range(1, len(arrangement.T_part_camera) + 1))
        explicit = isinstance(source, ExplicitViewpoints)
        if isinstance(source, ExplicitViewpoints):
            names = tuple(source.ids[k] for k in self._chosen)
        return compose_plan(
            ChosenViewpoints(arrangement.table, arrangement.T_part_camera, names, names_stay=explicit),
            self._job.characteristics,
            not_measurable,
            self._inspection.requirement,
            NotMetFindings(arrangement.best, self._poses_of_best(), self._averaged, self._certificates),
            PlanRecord(
                lower_bound=arrangement.lower_bound,
                candidate_count=len(source),
                seed=self._inspection.seed,
                refinement=arrangement.refinement,
                anywhere=self._anywhere,
                interrupted=self._interrupted,
            ),
        )

    def _poses_of_best(self) -> dict[int, NDArray[np.float64]]:
        """Of what is not met the pose from which it is most probable, where it is seen at all."""
        found = {}
        for j, (rows, at) in self._arrangement.best.items():
            if rows.values.visible[at]:
                own = self._arrangement.found
                found[j] = own[j] if j in own else self._choice.poses([int(rows.viewpoint[at])])[0]
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
