"""The main job: the fewest settings that measure every dimension as required."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..exceptions import InputError, NoCandidateError
from ..part.gauge_table import GaugeTable
from ..planning import Plan, choose_settings, not_measurable, sample_settings, without_allowed_error
from .evaluate import evaluate
from .inspection import ExplicitSettings, Inspection
from .progress import Progress, Silent

__all__ = ["plan"]


def plan(inspection: Inspection, *, seed: int | None = None, progress: Progress | None = None) -> Plan:
    """The fewest sensor settings that measure every dimension as accurately and as surely as required.

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
    with progress.stage("Choosing the fewest settings"):
        return choose_settings(
            table,
            candidates.T_part_camera,
            dimensions,
            unusable,
            inspection.requirement,
            inspection.seed,
            setting_ids=candidates.ids if inspection.settings is not None else None,
        )


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
