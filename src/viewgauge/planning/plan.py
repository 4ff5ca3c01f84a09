"""From what the candidates measure to the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from ..evaluation import WARNINGS, BestRows, Requirement, TableBlock
from ..part import Dimension, Unusable
from .cause import limiting_cause
from .cover import DEFAULT_TIME_LIMIT_S, Cover, surest_minimum_cover
from .dominance import Undominated
from .refinement import Refinement
from .result import Plan, PlannedDimension, PlannedSetting
from .travel import shortest_tour

__all__ = ["assigned_setting", "choose_settings", "compose_plan", "not_measurable", "without_allowed_error"]


def without_allowed_error(
    dimensions: Sequence[Dimension], requirement: Requirement
) -> tuple[tuple[Dimension, ...], tuple[Unusable, ...]]:
    """Split dimensions into those that the requirement can judge and those that it cannot, with the reason."""
    judged, refused = [], []
    for dimension in dimensions:
        reason = requirement.cannot_judge(dimension.tolerance_mm)
        if reason is None:
            judged.append(dimension)
        else:
            refused.append(Unusable(dimension.id, dimension.kind, reason, dimension.nominal_mm, dimension.tolerance_mm))
    return tuple(judged), tuple(refused)


def choose_settings(kept: Undominated, time_limit_s: float = DEFAULT_TIME_LIMIT_S, gap: float = 0.0) -> Cover:
    """The fewest settings that measure every dimension that some kept candidate measures; of those the surest.

    Returns
    -------
    The cover, of the settings' indices.
    """
    reachable = kept.level.any(axis=0)
    cover = surest_minimum_cover(kept.level[:, reachable], time_limit_s, gap)
    return Cover(tuple(int(k) for k in kept.index[list(cover.chosen)]), cover.lower_bound)


def assigned_setting(table: TableBlock, required: float) -> NDArray[np.int64]:
    """For each dimension the surest (then most accurate, then first) of K settings, -1 where none is sure enough.

    Parameters
    ----------
    table
        ``(K, d)``: of the chosen settings.
    """
    best = BestRows.of(table, np.arange(len(table.reason)))
    met = best.values.visible & (best.values.probability >= required) & (best.setting >= 0)
    return np.where(met, best.setting, -1)


def compose_plan(
    table: TableBlock,
    T_part_camera: NDArray[np.float64],
    names: Sequence[str],
    best: Mapping[int, tuple[BestRows, int]],
    dimensions: Sequence[Dimension],
    unusable: Sequence[Unusable],
    requirement: Requirement,
    *,
    lower_bound: int,
    candidate_count: int,
    seed: int,
    refinement: Refinement | None = None,
    fixed_names: bool = False,
) -> Plan:
    """The plan of K chosen settings.

    Parameters
    ----------
    table
        ``(K, d)``: of the chosen settings and all dimensions.
    T_part_camera, names
        ``(K, 4, 4)`` mm, and K names; they are put in the order of the shortest tour through the settings.
    fixed_names
        A name goes with its setting; else they are given in the order of the tour.
    best
        For each dimension that is not met the best rows of all candidates, and its place in them.
    unusable
        What cannot be measured, for the record.
    """
    order = list(shortest_tour(T_part_camera[:, :3, 3])[0])
    table = TableBlock(*(getattr(table, f.name)[order] for f in fields(table)))
    T_part_camera, names = T_part_camera[order], [names[k] for k in order] if fixed_names else names
    setting = assigned_setting(table, requirement.probability)
    observes: list[list[str]] = [[] for _ in names]
    planned = []
    for j, dimension in enumerate(dimensions):
        if setting[j] >= 0:
            observes[setting[j]].append(dimension.id)
            chosen = TableBlock(*(getattr(table, f.name)[setting[j]] for f in fields(table)))
            planned.append(_planned(chosen, j, dimension, requirement, names[setting[j]], ""))
        else:
            rows, place = best[j]
            planned.append(_planned(rows.values, place, dimension, requirement, None, limiting_cause(rows, place)))
    return Plan(
        seed=seed,
        settings=tuple(
            PlannedSetting(name, T, tuple(seen)) for name, T, seen in zip(names, T_part_camera, observes, strict=True)
        ),
        dimensions=(*planned, *not_measurable(unusable)),
        lower_bound=lower_bound,
        candidate_count=candidate_count,
        refinement=refinement,
    )


def _planned(
    row: TableBlock, j: int, dimension: Dimension, requirement: Requirement, setting: str | None, limit: str
) -> PlannedDimension:
    """The entry of a dimension from entry j of a row of the table."""
    seen = bool(row.visible[j])
    gauge = dimension.gauges[int(row.gauge[j])] if seen else None
    allowed = requirement.allowed_error_mm(dimension.nominal_mm, dimension.tolerance_mm)
    return PlannedDimension(
        id=dimension.id,
        kind=dimension.kind,
        nominal_mm=dimension.nominal_mm,
        tolerance_mm=dimension.tolerance_mm,
        allowed_error_mm=float("nan") if allowed is None else allowed,
        status="unmet" if setting is None else "met",
        probability=float(row.probability[j]) if seen else 0.0,
        expected_accuracy=float(row.expected_accuracy[j]) if seen else 0.0,
        setting=setting,
        gauge=np.stack([gauge.start, gauge.end]) if gauge else None,
        limit=limit,
        warning=("", *WARNINGS)[int(row.validity[j])] if seen else "",
    )


def not_measurable(unusable: Sequence[Unusable]) -> list[PlannedDimension]:
    """The plan's entries for what cannot be measured, with the reason."""
    return [
        PlannedDimension(
            id=entry.id,
            kind=entry.kind,
            nominal_mm=entry.nominal_mm,
            tolerance_mm=entry.tolerance_mm,
            allowed_error_mm=float("nan"),
            status="not_measurable",
            probability=0.0,
            expected_accuracy=0.0,
            setting=None,
            gauge=None,
            limit=entry.reason,
        )
        for entry in unusable
    ]
