"""What a plan would be worth with other cameras, heads, distances and requirements: answers while a knob is turned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import GaugeLaws
from ...evaluation.error_budget import ErrorBudget, error_budget
from ...execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from ...geometry import invert, transform
from ...part import Unusable
from ...part.characteristic import rim_axes
from ...planning import Plan, default_distance_range, without_allowed_error
from ...planning.candidates.direction_map import DirectionMap, map_directions
from ...planning.improve.answers import Answers
from ...planning.improve.knob_values import KnobValues, moved_along_axis
from ...planning.inspection import ExplicitSettings, Inspection
from ...report import SettingView
from ..laws import laws_of_look
from .viewpoint_view import SettingViews

__all__ = ["WhatIf"]


class WhatIf:
    """A part and the settings of a plan, which answer for any values of the knobs.

    Everything is by the joint model, each dimension from its surest single setting; what hides is made ready once.

    Parameters
    ----------
    plan
        Whose settings are judged; None for none yet.
    """

    def __init__(self, inspection: Inspection, plan: Plan | None) -> None:
        self.inspection, self.plan = inspection, plan
        self.dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
        self.refused: tuple[Unusable, ...] = (*inspection.part.unusable, *refused)
        source = ExplicitSettings((), np.zeros((0, 4, 4)))
        self._evaluator = (
            evaluator_of(EvaluationJob.of(inspection, self.dimensions, source)) if self.dimensions else None
        )
        self._views = SettingViews(inspection.part.mesh)
        self._planned = {} if plan is None else {s.id: s.T_part_camera for s in plan.settings}
        self._targets = {name: self._target(name) for name in self._planned}

    @property
    def today(self) -> KnobValues:
        """The knobs as the inspection has them."""
        return KnobValues.of(self.inspection.camera, self.inspection.head, self.inspection.requirement)

    def turned(self, knobs: KnobValues) -> Inspection:
        """The inspection with the knobs' values; raises InputError where a value is out of range."""
        camera, head, requirement = knobs.applied(
            self.inspection.camera, self.inspection.head, self.inspection.requirement
        )
        return replace(self.inspection, camera=camera, head=head, requirement=requirement)

    def settings(
        self, knobs: KnobValues, dragged: Mapping[str, NDArray[np.float64]] | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Where the settings stand: as planned, or where they were dragged to, and then as far as the knob says."""
        placed = {name: (dragged or {}).get(name, T) for name, T in self._planned.items()}
        if not placed:
            return {}
        poses = np.array(list(placed.values()))
        targets = np.array([self._targets[name] for name in placed])
        return dict(zip(placed, moved_along_axis(poses, targets, knobs.distance), strict=True))

    def answers(self, knobs: KnobValues, dragged: Mapping[str, NDArray[np.float64]] | None = None) -> Answers:
        """How the settings measure the part with the knobs' values; raises InputError as :meth:`turned`."""
        inspection = self.turned(knobs)
        settings = self.settings(knobs, dragged)
        poses = np.array(list(settings.values())).reshape(-1, 4, 4)
        assert self._evaluator is not None, "there is a dimension to measure"
        evaluator = self._evaluator.with_errors(inspection.camera, inspection.head, inspection.requirement)
        table = evaluator.table(poses)
        return Answers.from_table(
            inspection.camera,
            inspection.head,
            inspection.requirement,
            settings,
            self.dimensions,
            evaluator.allowed_error_mm,
            table,
        )

    def placed(self, knobs: KnobValues, name: str, T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(4, 4)`` mm: what :meth:`settings` must be given for a setting to stand at a pose, as the knobs are."""
        moved = moved_along_axis(T_part_camera[None], self._targets[name][None], 1 / knobs.distance)
        return np.asarray(moved[0])

    def working_distance_mm(self, answers: Answers, name: str) -> float:
        """From a dimension to its surest setting; of the middle of the part's usual distances where there is none."""
        answer = answers.of(name)
        if answer.setting is not None:
            middle = (answer.gauge.start + answer.gauge.end) / 2
            return float(np.linalg.norm(answers.settings[answer.setting][:3, 3] - middle))
        ends = np.array([(g.start, g.end) for d in self.dimensions for g in d.gauges]).reshape(-1, 3)
        near, far = self.inspection.candidates.distance_mm or default_distance_range(ends, answers.camera)
        return float(np.sqrt(near * far))

    def candidates(self, answers: Answers, most: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Some candidate poses ``(n, 4, 4)`` mm, evenly taken, and the share ``(n,)`` of dimensions that each meets."""
        if not self.dimensions:
            return np.zeros((0, 4, 4)), np.zeros(0)
        assert self._evaluator is not None  # there are dimensions
        source = self.inspection.settings or candidate_grid(self.inspection, self.dimensions)
        poses = source.poses(0, len(source))
        poses = poses[np.unique(np.linspace(0, len(poses) - 1, min(most, len(poses))).astype(int))]
        evaluator = self._evaluator.with_errors(answers.camera, answers.head, answers.requirement)
        met = evaluator.accepted(poses).probability > 0
        return poses, met.mean(axis=1)

    def said_by_plan(self, name: str) -> tuple[str, ...]:
        """What limits a dimension and what is proven of it, as it was planned."""
        planned = [] if self.plan is None else [d for d in self.plan.dimensions if d.id == name]
        return tuple(text for dimension in planned for text in (dimension.limit, dimension.proof) if text)

    def laws(self, answers: Answers, name: str) -> GaugeLaws | None:
        """The laws of a dimension from its surest setting; None where no setting sees it."""
        answer = answers.of(name)
        if answer.setting is None:
            return None
        ends = np.stack([answer.gauge.start, answer.gauge.end])
        pose = answers.settings[answer.setting]
        return laws_of_look(ends, answer.gauge, pose, answers.camera, answers.head)

    def budget(self, answers: Answers, name: str) -> ErrorBudget | None:
        """The error budget of a dimension from its surest setting; None where no setting sees it."""
        answer = answers.of(name)
        if answer.setting is None:
            return None
        pose = answers.settings[answer.setting]
        start, end = transform(invert(pose), np.stack([answer.gauge.start, answer.gauge.end]))
        tolerance = answer.allowed_error_mm / answer.gauge.length_mm
        axis = rim_axes([answer.gauge], pose[None])[0]
        return error_budget(start, end, answers.camera, answers.head, tolerance, axis)

    def directions(self, answers: Answers, name: str, distance_mm: float) -> DirectionMap:
        """From where on a sphere a dimension is measured how surely."""
        assert self._evaluator is not None, "there is a dimension to measure"
        (index,) = [j for j, dimension in enumerate(self.dimensions) if dimension.id == name]
        evaluator = self._evaluator.of([index]).with_errors(answers.camera, answers.head, answers.requirement)
        return map_directions(evaluator, distance_mm)

    def view(self, answers: Answers, name: str) -> SettingView:
        """What the camera sees from a setting."""
        row = list(answers.settings).index(name)
        surest = {answer.dimension.id: (answer.setting,) for answer in answers.dimensions}
        camera = answers.camera
        return self._views.view(name, answers.settings[name], camera, self.dimensions, answers.table, row, surest)

    def _target(self, name: str) -> NDArray[np.float64]:
        """``(3,)`` mm: the middle of what the plan measures from a setting, or of the part."""
        assert self.plan is not None  # it has the setting
        mine = [d.gauge for d in self.plan.dimensions if d.setting == name and d.gauge is not None]
        mine += [look.gauge for d in self.plan.dimensions for look in d.looks if look.setting == name]
        points = np.concatenate(mine) if mine else self.inspection.part.mesh.bounds
        return np.asarray(points.mean(axis=0))
