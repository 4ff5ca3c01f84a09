"""From what the candidates measure to the plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from ..evaluation import WARNINGS, BestRows, Requirement, TableBlock
from ..part import Characteristic, NotMeasurable
from .cause import limiting_cause, proof_sentence
from .cover.dominance import Undominated
from .cover.minimum_cover import DEFAULT_TIME_LIMIT_S, Cover, most_probable_minimum_cover
from .findings import Averaged, ChosenViewpoints, NotMetFindings, PlanRecord
from .plan import Acquisition, Plan, PlannedCharacteristic, PlannedViewpoint, Status
from .sort_characteristics import toleranced, without_tolerance

__all__ = [
    "assigned_viewpoint",
    "choose_viewpoints",
    "compose_plan",
    "planned_not_measurable",
]


def choose_viewpoints(kept: Undominated, time_limit_s: float = DEFAULT_TIME_LIMIT_S, gap: float = 0.0) -> Cover:
    """The fewest viewpoints that measure every characteristic that some kept candidate measures; of those the most
    probable.

    Returns
    -------
    The cover, of the viewpoints' indices.
    """
    reachable = kept.level.any(axis=0)
    cover = most_probable_minimum_cover(kept.level[:, reachable], time_limit_s, gap)
    return Cover(tuple(int(k) for k in kept.index[list(cover.chosen)]), cover.lower_bound)


def assigned_viewpoint(table: TableBlock, required: float) -> NDArray[np.int64]:
    """For each characteristic the most probable (then most accurate, then first) of K viewpoints, -1 where none reaches
    the required probability.

    Parameters
    ----------
    table
        ``(K, d)``: of the chosen viewpoints.
    """
    best = BestRows.of(table, np.arange(len(table.reason)))
    met = best.values.visible & (best.values.probability >= required) & (best.viewpoint >= 0)
    return np.where(met, best.viewpoint, -1)


def compose_plan(
    chosen: ChosenViewpoints,
    characteristics: Sequence[Characteristic],
    not_measurable: Sequence[NotMeasurable],
    requirement: Requirement,
    findings: NotMetFindings,
    record: PlanRecord,
) -> Plan:
    """The plan of the chosen viewpoints, put in the order of the shortest tour through them.

    Parameters
    ----------
    characteristics
        All d of them; each is met by a chosen viewpoint, or has an entry in ``findings.best``.
    not_measurable
        What cannot be measured, and what demands nothing, for the record.
    """
    chosen, place = chosen.toured()
    viewpoint = assigned_viewpoint(chosen.table, requirement.probability)
    observes: list[list[str]] = [[] for _ in chosen.names]
    planned = []
    for j, characteristic in enumerate(characteristics):
        k = int(viewpoint[j])
        if k >= 0:
            observes[k].append(characteristic.id)
            row = TableBlock(*(getattr(chosen.table, f.name)[k] for f in fields(chosen.table)))
            entry = _planned(row, j, characteristic, requirement, chosen.names[k], "")
            planned.append(replace(entry, T_part_camera=chosen.T_part_camera[k]))
            continue
        rows, at = findings.best[j]
        entry = _planned(rows.values, at, characteristic, requirement, None, limiting_cause(rows, at))
        if (mean := findings.averaged.get(j)) is not None:
            seen = [place[row] for row in mean.rows]
            for k in seen:
                observes[k].append(characteristic.id)
            in_order = sorted(zip(seen, mean.measurands, strict=True), key=lambda acquisition: acquisition[0])
            acquisitions = tuple(Acquisition(chosen.names[k], measurand) for k, measurand in in_order)
            planned.append(_averaged(entry, mean, acquisitions))
        else:
            certificate = findings.certificates.get(j)
            proof = proof_sentence(certificate, record.candidate_count, given=chosen.names_stay)
            pose = findings.T_part_camera.get(j)
            planned.append(replace(entry, T_part_camera=pose, certificate=certificate, proof=proof))
    viewpoints = zip(chosen.names, chosen.T_part_camera, observes, strict=True)
    return Plan(
        seed=record.seed,
        viewpoints=tuple(PlannedViewpoint(name, T, tuple(seen)) for name, T, seen in viewpoints),
        characteristics=(*planned, *planned_not_measurable(toleranced(not_measurable))),
        without_tolerance=tuple(planned_not_measurable(without_tolerance(not_measurable))),
        lower_bound=record.lower_bound,
        candidate_count=record.candidate_count,
        refinement=record.refinement,
        anywhere=record.anywhere,
        interrupted=record.interrupted,
    )


def _averaged(
    entry: PlannedCharacteristic, mean: Averaged, acquisitions: tuple[Acquisition, ...]
) -> PlannedCharacteristic:
    """The entry of a characteristic that the mean of acquisitions meets."""
    return replace(
        entry,
        status=Status.MET,
        probability=mean.probability,
        expected_accuracy=mean.expected_accuracy,
        viewpoint=acquisitions[0].viewpoint,
        measurand=acquisitions[0].measurand,
        limit="",
        warning="",
        acquisitions=acquisitions,
        single_probability=mean.single_probability,
    )


def _planned(
    row: TableBlock, j: int, characteristic: Characteristic, requirement: Requirement, viewpoint: str | None, limit: str
) -> PlannedCharacteristic:
    """The entry of a characteristic from entry j of a row of the table."""
    seen = bool(row.visible[j])
    measurand = characteristic.measurands[int(row.measurand[j])] if seen else None
    allowed = requirement.allowed_error_mm(characteristic.nominal_mm, characteristic.tolerance_mm)
    return PlannedCharacteristic(
        id=characteristic.id,
        kind=characteristic.kind,
        nominal_mm=characteristic.nominal_mm,
        tolerance_mm=characteristic.tolerance_mm,
        allowed_error_mm=float("nan") if allowed is None else allowed,
        status=Status.NOT_MET if viewpoint is None else Status.MET,
        probability=float(row.probability[j]) if seen else 0.0,
        expected_accuracy=float(row.expected_accuracy[j]) if seen else 0.0,
        viewpoint=viewpoint,
        measurand=np.stack([measurand.start, measurand.end]) if measurand else None,
        limit=limit,
        warning=("", *WARNINGS)[int(row.validity[j])] if seen else "",
        indication=characteristic.indication,
    )


def planned_not_measurable(not_measurable: Sequence[NotMeasurable]) -> list[PlannedCharacteristic]:
    """The plan's entries for what cannot be measured, with the reason."""
    return [
        PlannedCharacteristic(
            id=entry.id,
            kind=entry.kind,
            nominal_mm=entry.nominal_mm,
            tolerance_mm=entry.tolerance_mm,
            allowed_error_mm=float("nan"),
            status=Status(entry.status),
            probability=0.0,
            expected_accuracy=0.0,
            viewpoint=None,
            measurand=None,
            limit=entry.reason,
            indication=entry.indication,
        )
        for entry in not_measurable
    ]
