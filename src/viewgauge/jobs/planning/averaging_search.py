"""Characteristics that no single viewpoint meets, measured from several viewpoints and averaged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...evaluation import Acquisitions
from ...execution.chunks import Chunk, EvaluationJob, evaluator_of
from ...geometry import invert, transform
from ...part import rim_axes
from ...planning.averaging.acquisition_search import AcquisitionCandidates
from ...planning.averaging.averaged_viewpoints import ChosenAcquisitions, plan_acquisitions
from ...planning.averaging.shortlist import AcquisitionShortlist, acquisition_scores

__all__ = ["AddedAcquisitions", "AveragedCharacteristic", "acquisitions_chunk", "add_acquisitions"]

_DRAWS = 400_000  # of the full camera model for each averaged characteristic: its 99.9 % interval is ±1e-3 at 0.95


@dataclass(frozen=True)
class AveragedCharacteristic:
    """A characteristic of a job that the mean of k acquisitions meets.

    Parameters
    ----------
    characteristic
        Its index in the job.
    acquisitions
        k indices into the planned viewpoints followed by the added ones.
    measurands
        ``(k, 2, 3)`` mm, part frame: what is measured in each acquisition.
    probability
        Of the mean; by the full camera model where that finds it less probable than the law does.
    probability_single
        Of the best single acquisition.
    deviation_mm
        Standard deviation of the mean's error.
    """

    characteristic: int
    acquisitions: tuple[int, ...]
    measurands: NDArray[np.float64]
    probability: float
    probability_single: float
    deviation_mm: float


@dataclass(frozen=True)
class AddedAcquisitions:
    """What averaging adds to a plan.

    Parameters
    ----------
    viewpoints
        ``(m,)`` indices of the viewpoints that are added to those of the plan, ascending.
    characteristics
        The characteristics that are met now.
    """

    viewpoints: NDArray[np.int64]
    characteristics: tuple[AveragedCharacteristic, ...]


def acquisitions_chunk(job: EvaluationJob, chunk: Chunk) -> AcquisitionShortlist:
    """Of a chunk's viewpoints those from which a mean may be worth having, for each of the job's characteristics."""
    return _shortlisted(job, np.arange(*chunk), job.source.poses(*chunk))


def _shortlisted(job: EvaluationJob, index: NDArray[np.int64], poses: NDArray[np.float64]) -> AcquisitionShortlist:
    table = evaluator_of(job).table(poses)
    row, characteristic = np.nonzero(table.visible)
    acquisitions = _acquisitions(job, poses[row], characteristic, table.measurand[row, characteristic])
    return AcquisitionShortlist.of(index[row], characteristic, acquisition_scores(acquisitions))


def add_acquisitions(
    job: EvaluationJob, shortlist: AcquisitionShortlist, planned: Sequence[int], most: int, seed: int
) -> AddedAcquisitions:
    """Meet what the mean of 2 to ``most`` acquisitions meets, from planned viewpoints and as few others as are found to
    do.

    The full camera model is asked about every mean that is chosen: averaging takes away what is drawn anew at each
    acquisition, but not what the small-error model leaves out. Where the law is above its 99.9 % interval, the full
    camera model's estimate takes its place; if that misses the requirement, one acquisition more is tried.

    Parameters
    ----------
    job
        With the characteristics that no single viewpoint meets, and a pose error whose common part is stated.
    shortlist
        Of all viewpoints of the job's source, by :func:`acquisitions_chunk`.
    planned
        Indices of the plan's viewpoints, in its order.
    """
    candidates = _candidates(job, shortlist, planned)
    fewest: dict[int, int] = {}
    confirmed: dict[tuple[int, tuple[int, ...]], float] = {}
    while True:  # each time round at least one characteristic is tried with more acquisitions
        found = plan_acquisitions(candidates, planned, most, job.setup.requirement.probability, fewest)
        for chosen in found:
            if (chosen.characteristic, chosen.viewpoints) not in confirmed:
                confirmed[chosen.characteristic, chosen.viewpoints] = _confirmed(job, chosen, seed)
        probability = {f.characteristic: confirmed[f.characteristic, f.viewpoints] for f in found}
        refuted = [f for f in found if probability[f.characteristic] < job.setup.requirement.probability]
        if not refuted:
            return _added(job, found, probability, planned)
        fewest |= {f.characteristic: len(f.viewpoints) + 1 for f in refuted}


def _candidates(job: EvaluationJob, shortlist: AcquisitionShortlist, planned: ArrayLike) -> list[AcquisitionCandidates]:
    """For each characteristic the planned and all shortlisted viewpoints that see it, each by its best measurand.

    Those on another characteristic's list are among them: a viewpoint may serve both.
    """
    planned = np.asarray(planned, dtype=np.int64)
    index = np.unique(np.concatenate([shortlist.viewpoint, planned]))
    poses, evaluator = _poses(job, index.tolist()), evaluator_of(job)
    table = evaluator.table(poses)
    candidates = []
    for characteristic, allowed in enumerate(evaluator.allowed_error_mm.tolist()):
        row = np.flatnonzero(table.visible[:, characteristic])
        measurand = table.measurand[row, characteristic].astype(np.int64)
        points = _seen(job, poses[row], np.full(len(row), characteristic), measurand)
        image = job.setup.camera.to_pixels(job.setup.camera.project(points))
        acquisitions = _acquisitions(job, poses[row], np.full(len(row), characteristic), measurand)
        own = np.append(shortlist.viewpoint[shortlist.characteristic == characteristic], planned)
        good = np.isin(index[row], own)
        step = 0.0 if job.setup.camera.edge_detector else job.setup.camera.edge_resolution_px
        candidates.append(AcquisitionCandidates(index[row], measurand, acquisitions, image, step, allowed, good))
    return candidates


def _seen(
    job: EvaluationJob, poses: NDArray[np.float64], characteristic: NDArray[np.int64], measurand: NDArray[np.integer]
) -> NDArray[np.float64]:
    """``(n, 2, 3)`` mm: ends of measurands in the camera frames of n poses."""
    return transform(invert(poses)[:, None], _measurands(job, characteristic, measurand))


def _acquisitions(
    job: EvaluationJob, poses: NDArray[np.float64], characteristic: NDArray[np.int64], measurand: NDArray[np.integer]
) -> Acquisitions:
    chosen = [job.characteristics[j].measurands[g] for j, g in zip(characteristic, measurand, strict=True)]
    return Acquisitions.of(
        _seen(job, poses, characteristic, measurand), job.setup.camera, job.setup.pose_error, rim_axes(chosen, poses)
    )


def _measurands(
    job: EvaluationJob, characteristic: NDArray[np.int64], measurand: NDArray[np.integer]
) -> NDArray[np.float64]:
    """``(n, 2, 3)`` mm, part frame."""
    chosen = [job.characteristics[j].measurands[g] for j, g in zip(characteristic, measurand, strict=True)]
    return np.array([(one.start, one.end) for one in chosen]).reshape(-1, 2, 3)


def _poses(job: EvaluationJob, viewpoints: Sequence[int]) -> NDArray[np.float64]:
    return np.array([job.source.poses(k, k + 1)[0] for k in viewpoints]).reshape(-1, 4, 4)


def _confirmed(job: EvaluationJob, chosen: ChosenAcquisitions, seed: int) -> float:
    """The probability of a mean, after the full camera model was asked."""
    from ...simulation import estimate_averaged_probability

    characteristic = np.full(len(chosen.viewpoints), chosen.characteristic)
    poses = _poses(job, chosen.viewpoints)
    points = _seen(job, poses, characteristic, np.array(chosen.measurands))
    axes = rim_axes([job.characteristics[chosen.characteristic].measurands[g] for g in chosen.measurands], poses)
    allowed = float(evaluator_of(job).allowed_error_mm[chosen.characteristic])
    estimate = estimate_averaged_probability(
        points, job.setup.camera, job.setup.pose_error, allowed, draws=_DRAWS, rng=seed, rim_axis=axes
    )
    return chosen.probability if chosen.probability <= estimate.high else estimate.probability


def _added(
    job: EvaluationJob, found: Sequence[ChosenAcquisitions], probability: dict[int, float], planned: Sequence[int]
) -> AddedAcquisitions:
    new = sorted({k for chosen in found for k in chosen.viewpoints}.difference(planned))
    place = {k: n for n, k in enumerate([*planned, *new])}
    return AddedAcquisitions(
        np.array(new, dtype=np.int64),
        tuple(
            AveragedCharacteristic(
                chosen.characteristic,
                tuple(place[k] for k in chosen.viewpoints),
                _measurands(job, np.full(len(chosen.measurands), chosen.characteristic), np.array(chosen.measurands)),
                probability[chosen.characteristic],
                chosen.probability_single,
                chosen.deviation_mm,
            )
            for chosen in found
        ),
    )
