"""The main job: the fewest settings that measure every dimension as required."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..exceptions import InputError, NoCandidateError
from ..part import Dimension, Unusable
from ..part.gauge_table import GaugeTable
from ..planning import Plan, choose_settings, not_measurable, sample_settings, without_allowed_error
from .evaluate import DEFAULT_PRECISION, evaluate, simulate_pairs
from .inspection import ExplicitSettings, Inspection
from .progress import Progress, Silent

__all__ = ["plan"]


def plan(inspection: Inspection, *, seed: int | None = None, progress: Progress | None = None) -> Plan:
    """The fewest sensor settings that measure every dimension as accurately and as surely as required.

    The choice is by the joint model. Where that gives a warning for a pair that was chosen, its probability is found
    with the exact camera, and the choice is made again with it, until all that is stated is either without warning
    or confirmed (``PlannedDimension.warning`` keeps the name). A pair that only the exact camera would accept is
    not looked for.

    Parameters
    ----------
    seed
        In place of the inspection's. The same seed gives the same plan.

    Raises
    ------
    InputError
        If the seed is negative.
    NoCandidateError
        If there is no candidate setting to choose from.
    """
    progress = progress or Silent()
    if seed is not None:
        if seed < 0:
            raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
        inspection = replace(inspection, seed=seed)
    dimensions, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    unusable = (*inspection.part.unusable, *refused)
    if not dimensions:
        return Plan(inspection.seed, (), tuple(not_measurable(unusable)), lower_bound=0, candidate_count=0)
    candidates = _candidates(inspection, GaugeTable.of(dimensions).points)
    table = evaluate(inspection, candidates, progress=progress)
    return _chosen(table, candidates, dimensions, unusable, inspection, progress)


def _chosen(
    table: xr.Dataset,
    candidates: ExplicitSettings,
    dimensions: tuple[Dimension, ...],
    unusable: tuple[Unusable, ...],
    inspection: Inspection,
    progress: Progress,
) -> Plan:
    """The plan, chosen again until no chosen pair rests on a doubtful probability."""
    ids = candidates.ids if inspection.settings is not None else None
    doubtful = table["validity"].values != ""
    while True:  # each time round at least one doubtful pair fewer
        with progress.stage("Choosing the fewest settings"):
            chosen = choose_settings(
                table,
                candidates.T_part_camera,
                dimensions,
                unusable,
                inspection.requirement,
                inspection.seed,
                setting_ids=ids,
            )
        pairs = _pairs_of(chosen, table, candidates)
        pairs = pairs[doubtful[tuple(pairs.T)]]
        if not len(pairs):
            return chosen
        with progress.stage("Confirming what the small-error model does not answer for"):
            table = _confirmed(table, pairs, candidates, dimensions, inspection)
        doubtful[tuple(pairs.T)] = False


def _pairs_of(chosen: Plan, table: xr.Dataset, candidates: ExplicitSettings) -> NDArray[np.int64]:
    """Indices ``(n, 2)`` in the table of the settings and dimensions that are met."""
    column = {str(name): j for j, name in enumerate(table["dimension"].values)}
    pairs = [
        (int(np.flatnonzero((candidates.T_part_camera == s.T_part_camera).all(axis=(1, 2)))[0]), column[name])
        for s in chosen.settings
        for name in s.observes
    ]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _confirmed(
    table: xr.Dataset,
    pairs: NDArray[np.int64],
    candidates: ExplicitSettings,
    dimensions: tuple[Dimension, ...],
    inspection: Inspection,
) -> xr.Dataset:
    """The table with the exact camera's probability and expected accuracy of some pairs."""
    estimates = simulate_pairs(table, pairs, candidates.T_part_camera, dimensions, inspection, DEFAULT_PRECISION)
    table = table.copy(deep=True)
    table["probability"].values[tuple(pairs.T)] = estimates.probability
    table["expected_accuracy"].values[tuple(pairs.T)] = estimates.expected_accuracy
    return table


def _candidates(
    inspection: Inspection, gauge_points: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> ExplicitSettings:
    if inspection.settings is not None:
        if not inspection.settings.ids:
            raise NoCandidateError("no candidate setting is left: the settings file holds none")
        return inspection.settings
    poses = sample_settings(
        gauge_points, inspection.part.mesh, inspection.camera, inspection.candidates, inspection.seed
    )
    return ExplicitSettings(tuple(f"C{k}" for k in range(1, len(poses) + 1)), poses)
