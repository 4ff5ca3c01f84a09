"""What to improve: by how much each error must be less, or may be more, and from how far the camera may look."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Evaluator
from ...exceptions import InputError
from ...execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from ...execution.progress import Progress, Silent
from ...part.measurand_table import GaugeTable
from ...planning import Plan, default_distance_range, without_allowed_error
from ...planning.improve.improvement import Change, DimensionChanges, Improvement, TradeOff
from ...planning.improve.knobs import KNOBS, MOVING, SETTLED, Knob, SetUp, scaled_head
from ...planning.improve.least_change import SHORT, largest_factor, meeting
from ...planning.inspection import ExplicitSettings, Inspection
from ..planning.plan import plan
from .moved_viewpoints import MovedSettings

__all__ = ["improve", "settled_change", "settled_improvement"]

_STEPS_BEYOND = 100  # of 0.1 %, at most
_PIXELS = 2.0 ** np.arange(-4, 3)  # of the trade-off


def improve(inspection: Inspection, *, progress: Progress | None = None) -> Improvement:
    """For each knob the least change that meets the requirement, for each dimension and for the part.

    A dimension is met when some setting measures it as required, by the joint model where that answers. Settings are
    the candidates and those of the refined plan, with the surest found for what is not met; for focal lengths and
    distances, which move the camera, candidates alone. Explicit settings stay where they are: then neither is varied.

    Raises
    ------
    InputError
        If there is no dimension to measure.
    NoCandidateError
        If there is no candidate setting.
    """
    progress = progress or Silent()
    dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    if not dimensions:
        raise InputError("no dimension can be measured; see viewgauge check", key="part")
    planned = plan(inspection, progress=progress, prove=False)
    inspection = replace(inspection, part=replace(inspection.part, dimensions=dimensions))
    source = inspection.settings or candidate_grid(inspection, dimensions)
    found = [d.T_part_camera for d in planned.dimensions if d.T_part_camera is not None]
    poses = np.concatenate([source.poses(0, len(source)), np.array(found).reshape(-1, 4, 4)])
    setup = SetUp(inspection.camera, inspection.head, _distance_range(inspection))
    evaluator = evaluator_of(EvaluationJob.of(inspection, dimensions, source))
    without = evaluator.with_errors(setup.camera.without_errors, scaled_head(setup.head, 0.0, 0.0))
    possible = np.asarray(meeting(without, poses).any(axis=0))
    today = evaluator.probabilities(poses).max(axis=0)
    met = np.asarray(meeting(evaluator, poses).any(axis=0))
    knobs = {k.name: k for k in (*SETTLED, *(() if inspection.settings else MOVING)) if k.today(setup) > 0}
    of_each: list[dict[str, Change]] = [{} for _ in dimensions]
    part: dict[str, Change] = {}
    trade_off: tuple[TradeOff, ...] = ()
    asked = np.flatnonzero(possible).tolist()
    for knob in knobs.values():
        with progress.stage(f"Turning {knob.name.replace('_', ' ')}", len(dimensions)) as advance:
            moved = MovedSettings(inspection, evaluator, setup, knob) if knob in MOVING else None
            for j, changes in enumerate(of_each):
                changes[knob.name] = (
                    moved.change([j]) if moved else settled_change(evaluator.of([j]), poses, setup, knob)
                )
                advance(1)
            if asked:
                of_asked = {dimensions[j].id: of_each[j][knob.name] for j in asked}
                change = moved.change(asked) if moved else _of_part(of_asked)
                if moved is None and change.factor is not None:
                    change = _verified(change, _turned(evaluator.of(asked), setup, knob), poses)
                part[knob.name] = change
    if asked and {"pixel", "head"} <= knobs.keys():
        with progress.stage("Trading pixels for the head", len(_PIXELS)) as advance:
            trade_off = tuple(_trades(evaluator.of(asked), poses, setup, advance))
    return Improvement(
        {name: knob.today(setup) for name, knob in knobs.items()},
        tuple(DimensionChanges(d.id, bool(met[j]), float(today[j]), of_each[j]) for j, d in enumerate(dimensions)),
        part,
        trade_off,
        tuple(d.id for j, d in enumerate(dimensions) if not possible[j]),
        (*inspection.part.unusable, *refused),
        len(poses),
    )


def settled_improvement(inspection: Inspection, plan: Plan) -> Improvement | None:
    """By how much each error must be less, or may be more, with the settings of a plan as they stand.

    Dimensions are judged by their surest setting, or, if none is sure enough, by the best pose that was tried. Those
    that are averaged from several looks, or seen from nowhere, are left out; None where nothing remains. No candidate
    is looked at: :func:`improve` may find that less has to change.
    """
    single = {d.id for d in plan.dimensions if d.T_part_camera is not None and not d.looks}
    dimensions = tuple(dimension for dimension in inspection.part.dimensions if dimension.id in single)
    if not dimensions:
        return None
    found = {d.id: d.T_part_camera for d in plan.dimensions if d.status != "met" and d.id in single}
    poses = np.array([s.T_part_camera for s in plan.settings] + list(found.values())).reshape(-1, 4, 4)
    evaluator = evaluator_of(
        EvaluationJob.of(inspection, dimensions, ExplicitSettings(tuple(map(str, range(len(poses)))), poses))
    )
    setup = SetUp(inspection.camera, inspection.head, (0.0, 0.0))
    without = evaluator.with_errors(setup.camera.without_errors, scaled_head(setup.head, 0.0, 0.0))
    possible = np.asarray(meeting(without, poses).any(axis=0))
    today = evaluator.probabilities(poses).max(axis=0)
    met = np.asarray(meeting(evaluator, poses).any(axis=0))
    of_each: list[dict[str, Change]] = [{} for _ in dimensions]
    part: dict[str, Change] = {}
    knobs = {knob.name: knob for knob in SETTLED if knob.today(setup) > 0}
    asked = np.flatnonzero(possible).tolist()
    for knob in knobs.values():
        for j, changes in enumerate(of_each):
            changes[knob.name] = settled_change(evaluator.of([j]), poses, setup, knob)
        if asked:
            part[knob.name] = _of_part({dimensions[j].id: of_each[j][knob.name] for j in asked})
    return Improvement(
        {name: knob.today(setup) for name, knob in knobs.items()},
        tuple(DimensionChanges(d.id, bool(met[j]), float(today[j]), of_each[j]) for j, d in enumerate(dimensions)),
        part,
        (),
        tuple(d.id for j, d in enumerate(dimensions) if not possible[j]),
        inspection.part.unusable,
        len(poses),
    )


def _distance_range(inspection: Inspection) -> tuple[float, float]:
    points = GaugeTable.of(inspection.part.dimensions).points.reshape(-1, 3)
    return inspection.candidates.distance_mm or default_distance_range(points, inspection.camera)


def _turned(evaluator: Evaluator, setup: SetUp, knob: Knob) -> Callable[[float], Evaluator]:
    def turned(factor: float) -> Evaluator:
        changed = knob.turned(setup, factor)
        return evaluator.with_errors(changed.camera, changed.head)

    return turned


def settled_change(evaluator: Evaluator, poses: NDArray[np.float64], setup: SetUp, knob: Knob) -> Change:
    """The largest factor of an error with which the evaluator's dimensions are met, verified with all settings."""
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
    """The change of an error with whether it holds, all settings evaluated afresh."""
    assert change.factor is not None  # the caller's condition
    holds = _all_met(turned(change.factor), poses)
    short = not change.unlimited and _all_met(turned(change.factor * (1 + SHORT)), poses)
    return replace(change, verified=holds and not short)


def _all_met(evaluator: Evaluator, poses: NDArray[np.float64]) -> bool:
    return bool(meeting(evaluator, poses).any(axis=0).all())


def _of_part(changes: Mapping[str, Change]) -> Change:
    """Of an error: the part is met as long as every dimension, here by id, is."""
    verified = all(change.verified for change in changes.values())
    factors = {name: change.factor for name, change in changes.items() if change.factor is not None}
    if len(factors) < len(changes):
        hopeless = tuple(name for name in changes if name not in factors)
        return Change(None, None, None, False, None, verified, hopeless)
    least = min(factors, key=lambda name: factors[name])
    return replace(changes[least], verified=verified, limited_by=(least,))


def _trades(
    evaluator: Evaluator, poses: NDArray[np.float64], setup: SetUp, advance: Callable[[int], None]
) -> list[TradeOff]:
    pixel, head = KNOBS["pixel"], KNOBS["head"]
    trades = []
    for step in _PIXELS.tolist():
        changed = pixel.turned(setup, step)
        change = settled_change(evaluator, poses, changed, head)
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
