"""What to improve: by how much each error must be less, or may be more, and from how far the camera may look."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...error_sources import scaled_pose_error
from ...evaluation import Evaluator
from ...exceptions import InputError
from ...execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from ...execution.progress import Progress, Silent
from ...part.measurand_table import MeasurandTable
from ...planning import Plan, default_distance_range, sort_characteristics, toleranced
from ...planning.improve.improvement import Change, CharacteristicChanges, Improvement, TradeOff
from ...planning.improve.knobs import KNOBS, MOVING, Knob, Rig, settled_knobs
from ...planning.improve.least_change import SHORT, largest_factor, meeting
from ...planning.inspection import ExplicitViewpoints, Inspection
from ..planning.plan import plan
from .moved_viewpoints import MovedViewpoints

__all__ = ["improve", "settled_change", "settled_improvement"]

_STEPS_BEYOND = 100  # of 0.1 %, at most
_PIXELS = 2.0 ** np.arange(-4, 3)  # of the trade-off


def improve(inspection: Inspection, *, progress: Progress | None = None) -> Improvement:
    """For each knob the least change that meets the requirement, for each characteristic and for the part.

    A characteristic is met when some viewpoint measures it as required, by the joint model where that answers.
    Viewpoints are the candidates and those of the refined plan, with the most probable found for what is not met; for
    focal lengths and distances, which move the camera, candidates alone. Explicit viewpoints stay where they are: then
    neither is varied.

    Raises
    ------
    InputError
        If there is no characteristic to measure.
    NoCandidateError
        If there is no candidate viewpoint.
    """
    progress = progress or Silent()
    split = sort_characteristics(inspection.part, inspection.requirement)
    characteristics = split.judged
    if not characteristics:
        raise InputError("no characteristic can be measured; see viewgauge check", key="part")
    planned = plan(inspection, progress=progress, prove=False)
    inspection = replace(inspection, part=replace(inspection.part, characteristics=characteristics))
    source = inspection.viewpoints or candidate_grid(inspection, characteristics)
    found = [d.T_part_camera for d in planned.characteristics if d.T_part_camera is not None]
    poses = np.concatenate([source.poses(0, len(source)), np.array(found).reshape(-1, 4, 4)])
    setup = Rig(inspection.camera, inspection.pose_error, _distance_range(inspection))
    evaluator = evaluator_of(EvaluationJob.of(inspection, characteristics, source))
    without = evaluator.with_errors(setup.camera.without_errors, scaled_pose_error(setup.pose_error, 0.0, 0.0))
    possible = np.asarray(meeting(without, poses).any(axis=0))
    today = evaluator.probabilities(poses).max(axis=0)
    met = np.asarray(meeting(evaluator, poses).any(axis=0))
    knobs = {
        k.name: k
        for k in (*settled_knobs(setup.camera), *(() if inspection.viewpoints else MOVING))
        if k.today(setup) > 0
    }
    of_each: list[dict[str, Change]] = [{} for _ in characteristics]
    part: dict[str, Change] = {}
    trade_off: tuple[TradeOff, ...] = ()
    asked = np.flatnonzero(possible).tolist()
    for knob in knobs.values():
        with progress.stage(f"Turning {knob.name.replace('_', ' ')}", len(characteristics)) as advance:
            moved = MovedViewpoints(inspection, evaluator, setup, knob) if knob in MOVING else None
            for j, changes in enumerate(of_each):
                changes[knob.name] = (
                    moved.change([j]) if moved else settled_change(evaluator.of([j]), poses, setup, knob)
                )
                advance(1)
            if asked:
                of_asked = {characteristics[j].id: of_each[j][knob.name] for j in asked}
                change = moved.change(asked) if moved else _of_part(of_asked)
                if moved is None and change.factor is not None:
                    change = _verified(change, _turned(evaluator.of(asked), setup, knob), poses)
                part[knob.name] = change
    if asked and {"pixel", "pose_error"} <= knobs.keys():
        with progress.stage("Trading pixels for the pose error", len(_PIXELS)) as advance:
            trade_off = tuple(_trades(evaluator.of(asked), poses, setup, advance))
    return Improvement(
        {name: knob.today(setup) for name, knob in knobs.items()},
        tuple(
            CharacteristicChanges(d.id, bool(met[j]), float(today[j]), of_each[j])
            for j, d in enumerate(characteristics)
        ),
        part,
        trade_off,
        tuple(d.id for j, d in enumerate(characteristics) if not possible[j]),
        split.not_measurable,
        len(poses),
    )


def settled_improvement(inspection: Inspection, plan: Plan) -> Improvement | None:
    """By how much each error must be less, or may be more, with the viewpoints of a plan as they stand.

    Characteristics are judged by their most probable viewpoint, or, if none meets the requirement, by the best pose
    that was tried. Those that are averaged from several viewpoints, or seen from nowhere, are left out; None where
    nothing remains. No candidate is evaluated: :func:`improve` may find that less has to change.
    """
    single = {d.id for d in plan.characteristics if d.T_part_camera is not None and not d.acquisitions}
    characteristics = tuple(
        characteristic for characteristic in inspection.part.characteristics if characteristic.id in single
    )
    if not characteristics:
        return None
    found = {d.id: d.T_part_camera for d in plan.characteristics if d.status != "met" and d.id in single}
    poses = np.array([s.T_part_camera for s in plan.viewpoints] + list(found.values())).reshape(-1, 4, 4)
    evaluator = evaluator_of(
        EvaluationJob.of(inspection, characteristics, ExplicitViewpoints(tuple(map(str, range(len(poses)))), poses))
    )
    setup = Rig(inspection.camera, inspection.pose_error, (0.0, 0.0))
    without = evaluator.with_errors(setup.camera.without_errors, scaled_pose_error(setup.pose_error, 0.0, 0.0))
    possible = np.asarray(meeting(without, poses).any(axis=0))
    today = evaluator.probabilities(poses).max(axis=0)
    met = np.asarray(meeting(evaluator, poses).any(axis=0))
    of_each: list[dict[str, Change]] = [{} for _ in characteristics]
    part: dict[str, Change] = {}
    knobs = {knob.name: knob for knob in settled_knobs(setup.camera) if knob.today(setup) > 0}
    asked = np.flatnonzero(possible).tolist()
    for knob in knobs.values():
        for j, changes in enumerate(of_each):
            changes[knob.name] = settled_change(evaluator.of([j]), poses, setup, knob)
        if asked:
            part[knob.name] = _of_part({characteristics[j].id: of_each[j][knob.name] for j in asked})
    return Improvement(
        {name: knob.today(setup) for name, knob in knobs.items()},
        tuple(
            CharacteristicChanges(d.id, bool(met[j]), float(today[j]), of_each[j])
            for j, d in enumerate(characteristics)
        ),
        part,
        (),
        tuple(d.id for j, d in enumerate(characteristics) if not possible[j]),
        toleranced(inspection.part.not_measurable),
        len(poses),
    )


def _distance_range(inspection: Inspection) -> tuple[float, float]:
    points = MeasurandTable.of(inspection.part.characteristics).points.reshape(-1, 3)
    return inspection.candidates.distance_mm or default_distance_range(points, inspection.camera)


def _turned(evaluator: Evaluator, setup: Rig, knob: Knob) -> Callable[[float], Evaluator]:
    def turned(factor: float) -> Evaluator:
        changed = knob.turned(setup, factor)
        return evaluator.with_errors(changed.camera, changed.pose_error)

    return turned


def settled_change(evaluator: Evaluator, poses: NDArray[np.float64], setup: Rig, knob: Knob) -> Change:
    """The largest factor of an error with which the evaluator's characteristics are met, verified with all
    viewpoints.
    """
    turned = _turned(evaluator, setup, knob)
    threshold = largest_factor(turned, poses)
    if threshold.factor is None:
        best = float(turned(0.0).probabilities(poses).max())
        return Change(None, None, None, False, best, not meeting(turned(0.0), poses).any(axis=0).all())
    factor, unlimited = threshold.factor, threshold.unlimited
    met_beyond = not unlimited and _all_met(turned(factor * (1 + SHORT)), poses)
    steps = 0
    # where the small-error model ceases to answer, less of an error is not always better
    while met_beyond and steps < _STEPS_BEYOND:
        factor, steps = factor * (1 + SHORT), steps + 1
        met_beyond = _all_met(turned(factor * (1 + SHORT)), poses)
    value = factor * knob.today(setup)
    return _verified(Change(factor, value, (0.0, value), unlimited, None, True), turned, poses)


def _verified(change: Change, turned: Callable[[float], Evaluator], poses: NDArray[np.float64]) -> Change:
    """The change of an error with whether it holds, all viewpoints evaluated afresh."""
    assert change.factor is not None  # the caller's condition
    holds = _all_met(turned(change.factor), poses)
    short = not change.unlimited and _all_met(turned(change.factor * (1 + SHORT)), poses)
    return replace(change, verified=holds and not short)


def _all_met(evaluator: Evaluator, poses: NDArray[np.float64]) -> bool:
    return bool(meeting(evaluator, poses).any(axis=0).all())


def _of_part(changes: Mapping[str, Change]) -> Change:
    """Of an error: the part is met as long as every characteristic, here by id, is."""
    verified = all(change.verified for change in changes.values())
    factors = {name: change.factor for name, change in changes.items() if change.factor is not None}
    if len(factors) < len(changes):
        hopeless = tuple(name for name in changes if name not in factors)
        return Change(None, None, None, False, None, verified, hopeless)
    least = min(factors, key=lambda name: factors[name])
    return replace(changes[least], verified=verified, limited_by=(least,))


def _trades(
    evaluator: Evaluator, poses: NDArray[np.float64], setup: Rig, advance: Callable[[int], None]
) -> list[TradeOff]:
    pixel, pose_error = KNOBS["pixel"], KNOBS["pose_error"]
    trades = []
    for step in _PIXELS.tolist():
        changed = pixel.turned(setup, step)
        change = settled_change(evaluator, poses, changed, pose_error)
        factor = change.factor
        trades.append(
            TradeOff(
                pixel.today(changed),
                factor,
                None if factor is None else factor * KNOBS["translation"].today(setup),
                None if factor is None else factor * KNOBS["rotation"].today(setup),
                change.verified,
            )
        )
        advance(1)
    return trades
