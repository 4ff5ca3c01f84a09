"""What a plan reaches with another camera, pose uncertainty, distance or requirement, while a knob is turned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import MeasurandLaws
from ...evaluation.error_budget import ErrorBudget, error_budget
from ...execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from ...geometry import invert, transform
from ...part import rim_axes
from ...planning import Plan, default_distance_range, sort_characteristics
from ...planning.candidates.direction_map import DirectionMap, map_directions
from ...planning.improve.answers import Answers
from ...planning.improve.knob_values import KnobValues, moved_along_axis
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...report import ViewpointView
from ..laws import laws_of_acquisition
from .viewpoint_view import ViewpointViews

__all__ = ["WhatIf"]


class WhatIf:
    """A part and the viewpoints of a plan, which answer for any values of the knobs.

    Everything is by the joint model, each characteristic from its most probable single viewpoint; what hides is made
    ready once.

    Parameters
    ----------
    plan
        The plan whose viewpoints are evaluated; None while there is none.
    """

    def __init__(self, inspection: Inspection, plan: Plan | None) -> None:
        self.inspection, self.plan = inspection, plan
        found = sort_characteristics(inspection.part, inspection.requirement)
        self.characteristics, self.refused = found.judged, found.not_measurable
        source = ExplicitViewpoints((), np.zeros((0, 4, 4)))
        self._evaluator = (
            evaluator_of(EvaluationJob.of(inspection, self.characteristics, source)) if self.characteristics else None
        )
        self._views = ViewpointViews(inspection.part.mesh)
        self._planned = {} if plan is None else {s.id: s.T_part_camera for s in plan.viewpoints}
        self._targets = {name: self._target(name) for name in self._planned}

    @property
    def today(self) -> KnobValues:
        """The knobs as the inspection has them."""
        return KnobValues.of(self.inspection.setup)

    def turned(self, knobs: KnobValues) -> Inspection:
        """The inspection with the knobs' values; raises InputError where a value is out of range."""
        setup = knobs.applied(self.inspection.setup)
        return replace(self.inspection, camera=setup.camera, pose_error=setup.pose_error, requirement=setup.requirement)

    def viewpoints(
        self, knobs: KnobValues, dragged: Mapping[str, NDArray[np.float64]] | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Where the viewpoints stand: as planned, or where they were dragged to, and then as far as the knob says."""
        placed = {name: (dragged or {}).get(name, T) for name, T in self._planned.items()}
        if not placed:
            return {}
        poses = np.array(list(placed.values()))
        targets = np.array([self._targets[name] for name in placed])
        return dict(zip(placed, moved_along_axis(poses, targets, knobs.distance), strict=True))

    def answers(self, knobs: KnobValues, dragged: Mapping[str, NDArray[np.float64]] | None = None) -> Answers:
        """How the viewpoints measure the part with the knobs' values; raises InputError as :meth:`turned`."""
        inspection = self.turned(knobs)
        viewpoints = self.viewpoints(knobs, dragged)
        poses = np.array(list(viewpoints.values())).reshape(-1, 4, 4)
        assert self._evaluator is not None, "there is a characteristic to measure"
        evaluator = self._evaluator.with_setup(inspection.setup)
        table = evaluator.table(poses)
        return Answers.from_table(
            inspection.setup,
            viewpoints,
            self.characteristics,
            evaluator.allowed_error_mm,
            table,
        )

    def placed(self, knobs: KnobValues, name: str, T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(4, 4)`` mm: what :meth:`viewpoints` must be given for a viewpoint to stand at a pose, as the knobs are."""
        moved = moved_along_axis(T_part_camera[None], self._targets[name][None], 1 / knobs.distance)
        return np.asarray(moved[0])

    def working_distance_mm(self, answers: Answers, name: str) -> float:
        """From a characteristic to its most probable viewpoint; of the middle of the part's usual distances where there
        is none.
        """
        answer = answers.of(name)
        if answer.viewpoint is not None:
            middle = (answer.measurand.start + answer.measurand.end) / 2
            return float(np.linalg.norm(answers.viewpoints[answer.viewpoint][:3, 3] - middle))
        ends = np.array([(g.start, g.end) for d in self.characteristics for g in d.measurands]).reshape(-1, 3)
        near, far = self.inspection.candidates.distance_mm or default_distance_range(ends, answers.setup.camera)
        return float(np.sqrt(near * far))

    def candidates(self, answers: Answers, most: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Some candidate poses ``(n, 4, 4)`` mm, evenly taken, and the share ``(n,)`` of characteristics that each
        meets.
        """
        if not self.characteristics:
            return np.zeros((0, 4, 4)), np.zeros(0)
        assert self._evaluator is not None  # there are characteristics
        source = self.inspection.viewpoints or candidate_grid(self.inspection, self.characteristics)
        poses = source.poses(0, len(source))
        poses = poses[np.unique(np.linspace(0, len(poses) - 1, min(most, len(poses))).astype(int))]
        evaluator = self._evaluator.with_setup(answers.setup)
        met = evaluator.accepted(poses).probability > 0
        return poses, met.mean(axis=1)

    def said_by_plan(self, name: str) -> tuple[str, ...]:
        """What limits a characteristic and what is proven of it, as it was planned."""
        planned = [] if self.plan is None else [d for d in self.plan.characteristics if d.id == name]
        return tuple(
            text for characteristic in planned for text in (characteristic.limit, characteristic.proof) if text
        )

    def laws(self, answers: Answers, name: str) -> MeasurandLaws | None:
        """The laws of a characteristic from its most probable viewpoint; None where no viewpoint sees it."""
        answer = answers.of(name)
        if answer.viewpoint is None:
            return None
        ends = np.stack([answer.measurand.start, answer.measurand.end])
        pose = answers.viewpoints[answer.viewpoint]
        return laws_of_acquisition(ends, answer.measurand, pose, answers.setup.camera, answers.setup.pose_error)

    def budget(self, answers: Answers, name: str) -> ErrorBudget | None:
        """The error budget of a characteristic from its most probable viewpoint; None where no viewpoint sees it."""
        answer = answers.of(name)
        if answer.viewpoint is None:
            return None
        pose = answers.viewpoints[answer.viewpoint]
        start, end = transform(invert(pose), np.stack([answer.measurand.start, answer.measurand.end]))
        tolerance = answer.allowed_error_mm / answer.measurand.length_mm
        axis = rim_axes([answer.measurand], pose[None])[0]
        return error_budget(start, end, answers.setup.camera, answers.setup.pose_error, tolerance, axis)

    def directions(self, answers: Answers, name: str, distance_mm: float) -> DirectionMap:
        """The probability of a characteristic from each direction on a sphere."""
        assert self._evaluator is not None, "there is a characteristic to measure"
        (index,) = [j for j, characteristic in enumerate(self.characteristics) if characteristic.id == name]
        evaluator = self._evaluator.of([index]).with_setup(answers.setup)
        return map_directions(evaluator, distance_mm)

    def view(self, answers: Answers, name: str) -> ViewpointView:
        """What the camera sees from a viewpoint."""
        row = list(answers.viewpoints).index(name)
        most_probable = {answer.characteristic.id: (answer.viewpoint,) for answer in answers.characteristics}
        camera = answers.setup.camera
        return self._views.view(
            name, answers.viewpoints[name], camera, self.characteristics, answers.table, row, most_probable
        )

    def _target(self, name: str) -> NDArray[np.float64]:
        """``(3,)`` mm: the middle of what the plan measures from a viewpoint, or of the part."""
        assert self.plan is not None  # it has the viewpoint
        mine = [d.measurand for d in self.plan.characteristics if d.viewpoint == name and d.measurand is not None]
        mine += [
            acquisition.measurand
            for d in self.plan.characteristics
            for acquisition in d.acquisitions
            if acquisition.viewpoint == name
        ]
        points = np.concatenate(mine) if mine else self.inspection.part.mesh.bounds
        return np.asarray(points.mean(axis=0))
