"""From the table setting x dimension to the plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..evaluation import Requirement
from ..part import Dimension, Unusable
from .cause import limiting_cause
from .cover import DEFAULT_TIME_LIMIT_S, surest_minimum_cover
from .dominance import probability_levels
from .result import Plan, PlannedDimension, PlannedSetting

__all__ = ["choose_settings", "not_measurable", "without_allowed_error"]


def without_allowed_error(
    dimensions: Sequence[Dimension], requirement: Requirement
) -> tuple[tuple[Dimension, ...], tuple[Unusable, ...]]:
    """Split dimensions into those that the requirement can judge and those that it cannot, with the reason."""
    judged, refused = [], []
    for dimension in dimensions:
        if requirement.allowed_error_mm(dimension.nominal_mm, dimension.tolerance_mm) is None:
            reason = "it has no tolerance (a basic value), and the requirement is a fraction of the tolerance"
            refused.append(Unusable(dimension.id, dimension.kind, reason, dimension.nominal_mm))
        else:
            judged.append(dimension)
    return tuple(judged), tuple(refused)


def choose_settings(
    table: xr.Dataset,
    T_part_camera: NDArray[np.float64],
    dimensions: Sequence[Dimension],
    unusable: Sequence[Unusable],
    requirement: Requirement,
    seed: int,
    setting_ids: Sequence[str] | None = None,
    time_limit_s: float = DEFAULT_TIME_LIMIT_S,
) -> Plan:
    """The fewest candidate settings that measure every dimension that some candidate measures as required.

    Parameters
    ----------
    table
        Of the n candidates and the dimensions, from :func:`~viewgauge.evaluation.evaluate_settings`.
    T_part_camera
        ``(n, 4, 4)`` mm.
    unusable
        What cannot be measured, for the record.
    setting_ids
        Names of the n candidates; the chosen ones are called S1, S2, … where not given.
    """
    probability = np.where(table["visible"].values, table["probability"].values, 0.0)
    reachable = np.asarray((probability >= requirement.probability).any(axis=0))
    cover = surest_minimum_cover(probability_levels(probability[:, reachable], requirement.probability), time_limit_s)
    names = {k: setting_ids[k] if setting_ids else f"S{n}" for n, k in enumerate(cover.chosen, start=1)}
    planned = []
    observes: dict[int, list[str]] = {k: [] for k in cover.chosen}
    visible, accuracy = table["visible"].values, table["expected_accuracy"].values
    for j, dimension in enumerate(dimensions):
        pool = list(cover.chosen) if reachable[j] else range(len(probability))
        k = max(pool, key=lambda k: (visible[k, j], probability[k, j], accuracy[k, j]), default=None)
        if k is not None and reachable[j]:
            observes[k].append(dimension.id)
        planned.append(_planned(table, k, j, dimension, names.get(k) if k is not None and reachable[j] else None))
    planned += not_measurable(unusable)
    return Plan(
        seed=seed,
        settings=tuple(PlannedSetting(names[k], T_part_camera[k], tuple(observes[k])) for k in cover.chosen),
        dimensions=tuple(planned),
        lower_bound=cover.lower_bound,
        candidate_count=len(T_part_camera),
    )


def _planned(table: xr.Dataset, k: int | None, j: int, dimension: Dimension, setting: str | None) -> PlannedDimension:
    seen = k is not None and bool(table["visible"].values[k, j])
    gauge = dimension.gauges[int(table["gauge"].values[k, j])] if seen else None
    return PlannedDimension(
        id=dimension.id,
        kind=dimension.kind,
        nominal_mm=dimension.nominal_mm,
        tolerance_mm=dimension.tolerance_mm,
        allowed_error_mm=float(table["allowed_error_mm"].values[j]),
        status="unmet" if setting is None else "met",
        probability=float(table["probability"].values[k, j]) if seen else 0.0,
        expected_accuracy=float(table["expected_accuracy"].values[k, j]) if seen else 0.0,
        setting=setting,
        gauge=np.stack([gauge.start, gauge.end]) if gauge else None,
        limit="" if setting else limiting_cause(table.isel(dimension=j)),
        warning=str(table["validity"].values[k, j]) if seen and "validity" in table else "",
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
