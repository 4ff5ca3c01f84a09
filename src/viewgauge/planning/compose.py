"""From what the candidates measure to the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..evaluation import WARNINGS, BestRows, Requirement, TableBlock
from ..part import Dimension, Unusable
from .bounds import Certificate, SettingsBound
from .cause import limiting_cause, proof_sentence
from .cover.dominance import Undominated
from .cover.minimum_cover import DEFAULT_TIME_LIMIT_S, Cover, surest_minimum_cover
from .cover.travel import shortest_tour
from .plan import Look, Plan, PlannedDimension, PlannedSetting
from .refine.refinement import Refinement

__all__ = [
    "Averaged",
    "assigned_setting",
    "choose_settings",
    "compose_plan",
    "planned_not_measurable",
    "without_allowed_error",
]


@dataclass(frozen=True)
class Averaged:
    """A dimension that the mean of k looks meets: the rows of their settings, and ``(k, 2, 3)`` mm what is measured.

    The probability and the expected accuracy are the mean's.
    """

    rows: tuple[int, ...]
    gauges: NDArray[np.float64]
    probability: float
    expected_accuracy: float
    single_probability: float


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
    fixed_names: bool = False,
    poses_of_best: Mapping[int, NDArray[np.float64]] | None = None,
    averaged: Mapping[int, Averaged] | None = None,
    certificates: Mapping[int, Certificate] | None = None,
    refinement: Refinement | None = None,
    anywhere: SettingsBound | None = None,
    interrupted: bool = False,
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
        For each dimension that no setting meets the best rows of all settings tried, and its place in them.
    poses_of_best
        ``(4, 4)`` mm: of these dimensions the pose that the best row belongs to.
    averaged, certificates
        Of these dimensions those that the mean of several looks meets, and what is proven of the others.
    unusable
        What cannot be measured, for the record.
    """
    order = list(shortest_tour(T_part_camera[:, :3, 3])[0])
    place = {row: n for n, row in enumerate(order)}
    table = TableBlock(*(getattr(table, f.name)[order] for f in fields(table)))
    T_part_camera, names = T_part_camera[order], [names[k] for k in order] if fixed_names else names
    setting = assigned_setting(table, requirement.probability)
    observes: list[list[str]] = [[] for _ in names]
    planned = []
    for j, dimension in enumerate(dimensions):
        looks = (averaged or {}).get(j)
        if setting[j] >= 0:
            observes[setting[j]].append(dimension.id)
            chosen = TableBlock(*(getattr(table, f.name)[setting[j]] for f in fields(table)))
            entry = _planned(chosen, j, dimension, requirement, names[setting[j]], "")
            planned.append(replace(entry, T_part_camera=T_part_camera[setting[j]]))
            continue
        rows, at = best[j]
        entry = _planned(rows.values, at, dimension, requirement, None, limiting_cause(rows, at))
        if looks is not None:
            seen = [place[row] for row in looks.rows]
            for k in seen:
                observes[k].append(dimension.id)
            in_order = sorted(zip(seen, looks.gauges, strict=True), key=lambda look: look[0])
            planned.append(_averaged(entry, looks, tuple(Look(names[k], gauge) for k, gauge in in_order)))
        else:
            pose, certificate = (poses_of_best or {}).get(j), (certificates or {}).get(j)
            proof = proof_sentence(certificate, candidate_count, given=fixed_names)
            planned.append(replace(entry, T_part_camera=pose, certificate=certificate, proof=proof))
    return Plan(
        seed=seed,
        settings=tuple(
            PlannedSetting(name, T, tuple(seen)) for name, T, seen in zip(names, T_part_camera, observes, strict=True)
        ),
        dimensions=(*planned, *planned_not_measurable(unusable)),
        lower_bound=lower_bound,
        candidate_count=candidate_count,
        refinement=refinement,
        anywhere=anywhere,
        interrupted=interrupted,
    )


def _averaged(entry: PlannedDimension, looks: Averaged, of_looks: tuple[Look, ...]) -> PlannedDimension:
    """The entry of a dimension that the mean of looks meets."""
    return replace(
        entry,
        status="met",
        probability=looks.probability,
        expected_accuracy=looks.expected_accuracy,
        setting=of_looks[0].setting,
        gauge=of_looks[0].gauge,
        limit="",
        warning="",
        looks=of_looks,
        single_probability=looks.single_probability,
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


def planned_not_measurable(unusable: Sequence[Unusable]) -> list[PlannedDimension]:
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
