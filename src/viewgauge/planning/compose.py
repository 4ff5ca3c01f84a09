"""From what the candidates measure to the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..evaluation import WARNINGS, BestRows, Requirement, TableBlock
from ..part import Characteristic, NotMeasurable
from .bounds import Certificate, ViewpointsBound
from .cause import limiting_cause, proof_sentence
from .cover.dominance import Undominated
from .cover.minimum_cover import DEFAULT_TIME_LIMIT_S, Cover, most_probable_minimum_cover
from .cover.travel import shortest_tour
from .plan import Acquisition, Plan, PlannedCharacteristic, PlannedViewpoint
from .refine.refinement import Refinement

__all__ = [
    "Averaged",
    "assigned_viewpoint",
    "choose_viewpoints",
    "compose_plan",
    "planned_not_measurable",
    "without_allowed_error",
]


@dataclass(frozen=True)
class Averaged:
    """A characteristic that the mean of k acquisitions meets: the rows of their viewpoints, and ``(k, 2, 3)`` mm what
    is measured.

    The probability and the expected accuracy are the mean's.
    """

    rows: tuple[int, ...]
    measurands: NDArray[np.float64]
    probability: float
    expected_accuracy: float
    single_probability: float


def without_allowed_error(
    characteristics: Sequence[Characteristic], requirement: Requirement
) -> tuple[tuple[Characteristic, ...], tuple[NotMeasurable, ...]]:
    """Split characteristics into those that the requirement can judge and those that it cannot, with the reason."""
    judged, refused = [], []
    for characteristic in characteristics:
        reason = requirement.cannot_judge(characteristic.tolerance_mm)
        if reason is None:
            judged.append(characteristic)
        else:
            refused.append(
                NotMeasurable(
                    characteristic.id,
                    characteristic.kind,
                    reason,
                    characteristic.nominal_mm,
                    characteristic.tolerance_mm,
                )
            )
    return tuple(judged), tuple(refused)


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
    """For each characteristic the most probable (then most accurate, then first) of K viewpoints, -1 where none is sure
    enough.

    Parameters
    ----------
    table
        ``(K, d)``: of the chosen viewpoints.
    """
    best = BestRows.of(table, np.arange(len(table.reason)))
    met = best.values.visible & (best.values.probability >= required) & (best.viewpoint >= 0)
    return np.where(met, best.viewpoint, -1)


def compose_plan(
    table: TableBlock,
    T_part_camera: NDArray[np.float64],
    names: Sequence[str],
    best: Mapping[int, tuple[BestRows, int]],
    characteristics: Sequence[Characteristic],
    not_measurable: Sequence[NotMeasurable],
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
    anywhere: ViewpointsBound | None = None,
    interrupted: bool = False,
) -> Plan:
    """The plan of K chosen viewpoints.

    Parameters
    ----------
    table
        ``(K, d)``: of the chosen viewpoints and all characteristics.
    T_part_camera, names
        ``(K, 4, 4)`` mm, and K names; they are put in the order of the shortest tour through the viewpoints.
    fixed_names
        A name goes with its viewpoint; else they are given in the order of the tour.
    best
        For each characteristic that no viewpoint meets the best rows of all viewpoints tried, and its place in them.
    poses_of_best
        ``(4, 4)`` mm: of these characteristics the pose that the best row belongs to.
    averaged, certificates
        Of these characteristics those that the mean of several viewpoints meets, and what is proven of the others.
    unusable
        What cannot be measured, for the record.
    """
    order = list(shortest_tour(T_part_camera[:, :3, 3])[0])
    place = {row: n for n, row in enumerate(order)}
    table = TableBlock(*(getattr(table, f.name)[order] for f in fields(table)))
    T_part_camera, names = T_part_camera[order], [names[k] for k in order] if fixed_names else names
    viewpoint = assigned_viewpoint(table, requirement.probability)
    observes: list[list[str]] = [[] for _ in names]
    planned = []
    for j, characteristic in enumerate(characteristics):
        acquisitions = (averaged or {}).get(j)
        if viewpoint[j] >= 0:
            observes[viewpoint[j]].append(characteristic.id)
            chosen = TableBlock(*(getattr(table, f.name)[viewpoint[j]] for f in fields(table)))
            entry = _planned(chosen, j, characteristic, requirement, names[viewpoint[j]], "")
            planned.append(replace(entry, T_part_camera=T_part_camera[viewpoint[j]]))
            continue
        rows, at = best[j]
        entry = _planned(rows.values, at, characteristic, requirement, None, limiting_cause(rows, at))
        if acquisitions is not None:
            seen = [place[row] for row in acquisitions.rows]
            for k in seen:
                observes[k].append(characteristic.id)
            in_order = sorted(zip(seen, acquisitions.measurands, strict=True), key=lambda acquisition: acquisition[0])
            planned.append(
                _averaged(entry, acquisitions, tuple(Acquisition(names[k], measurand) for k, measurand in in_order))
            )
        else:
            pose, certificate = (poses_of_best or {}).get(j), (certificates or {}).get(j)
            proof = proof_sentence(certificate, candidate_count, given=fixed_names)
            planned.append(replace(entry, T_part_camera=pose, certificate=certificate, proof=proof))
    return Plan(
        seed=seed,
        viewpoints=tuple(
            PlannedViewpoint(name, T, tuple(seen)) for name, T, seen in zip(names, T_part_camera, observes, strict=True)
        ),
        characteristics=(*planned, *planned_not_measurable(not_measurable)),
        lower_bound=lower_bound,
        candidate_count=candidate_count,
        refinement=refinement,
        anywhere=anywhere,
        interrupted=interrupted,
    )


def _averaged(
    entry: PlannedCharacteristic, acquisitions: Averaged, of_acquisitions: tuple[Acquisition, ...]
) -> PlannedCharacteristic:
    """The entry of a characteristic that the mean of acquisitions meets."""
    return replace(
        entry,
        status="met",
        probability=acquisitions.probability,
        expected_accuracy=acquisitions.expected_accuracy,
        viewpoint=of_acquisitions[0].viewpoint,
        measurand=of_acquisitions[0].measurand,
        limit="",
        warning="",
        acquisitions=of_acquisitions,
        single_probability=acquisitions.single_probability,
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
        status="not_met" if viewpoint is None else "met",
        probability=float(row.probability[j]) if seen else 0.0,
        expected_accuracy=float(row.expected_accuracy[j]) if seen else 0.0,
        viewpoint=viewpoint,
        measurand=np.stack([measurand.start, measurand.end]) if measurand else None,
        limit=limit,
        warning=("", *WARNINGS)[int(row.validity[j])] if seen else "",
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
            status="not_measurable",
            probability=0.0,
            expected_accuracy=0.0,
            viewpoint=None,
            measurand=None,
            limit=entry.reason,
        )
        for entry in not_measurable
    ]
