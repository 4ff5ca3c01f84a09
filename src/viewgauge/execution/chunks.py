"""A long job in chunks of viewpoints: what a chunk needs, and what it gives. Each runs in this or in another
process.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..evaluation import BestRows, Evaluator, Setup, TableBlock
from ..evaluation.segment import FirstOrderMethod
from ..exceptions import InputError, NoCandidateError
from ..geometry import invert, transform
from ..part import Characteristic, Mesh, rim_axes
from ..part.measurand_table import MeasurandTable
from ..planning import CandidateGrid, Undominated, probability_levels
from ..planning.inspection import ExplicitViewpoints, Inspection
from ..planning.region import Workpiece

if TYPE_CHECKING:
    from ..simulation import FullModelEstimates

__all__ = [
    "CONFIDENCE",
    "DEFAULT_PRECISION",
    "VIEWPOINTS_PER_CHUNK",
    "Chunk",
    "ChunkWriter",
    "Corrections",
    "EvaluationJob",
    "TableJob",
    "ViewpointSource",
    "accepted_chunk",
    "best_chunk",
    "candidate_grid",
    "chunks_of",
    "evaluator_of",
    "reachable",
    "require_chunk_size",
    "simulate_pairs",
    "simulated",
    "table_chunk",
]

_log = logging.getLogger(__name__)

VIEWPOINTS_PER_CHUNK = 16_384
"""By default: some MB for each characteristic, and for the usual part a few tenths of a second."""

DEFAULT_PRECISION = 1e-3
CONFIDENCE = 0.99  # of the intervals of the full camera model
_PAIRS_SIMULATED = 500  # at once

Chunk = tuple[int, int]
"""First viewpoint, and the one after the last."""


class ChunkWriter(Protocol):
    """What writes a chunk of a table from any process."""

    def write(
        self, first_viewpoint: int, values: Mapping[str, NDArray[np.generic]], summary: Mapping[str, Any] | None = None
    ) -> None:
        """Write the chunk of viewpoints that begins with ``first_viewpoint``: a column ``(m, d)`` a name, and a
        summary.
        """
        ...


class ViewpointSource(Protocol):
    """Viewpoints by their index, made or kept."""

    def __len__(self) -> int: ...

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` ``(m, 4, 4)`` mm of viewpoints ``first`` to ``stop - 1``, as far as there are."""
        ...


@dataclass(frozen=True)
class Corrections:
    """Probabilities of some pairs of viewpoint and characteristic, found otherwise, which take the first-order ones'
    place.
    """

    viewpoint: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    characteristic: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    probability: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    expected_accuracy: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    def applied(self, table: TableBlock, index: NDArray[np.int64]) -> TableBlock:
        """To the table of viewpoints with these ascending indices, in place."""
        row = np.searchsorted(index, self.viewpoint)
        here = np.flatnonzero(np.isin(self.viewpoint, index))
        table.probability[row[here], self.characteristic[here]] = self.probability[here]
        table.expected_accuracy[row[here], self.characteristic[here]] = self.expected_accuracy[here]
        return table


@dataclass(frozen=True, eq=False)  # by identity: what is made ready for it is kept for it
class EvaluationJob:
    """What all chunks of a job share.

    Parameters
    ----------
    threads
        Of a chunk; None for as many as there are processors.
    """

    characteristics: tuple[Characteristic, ...]
    mesh: Mesh
    setup: Setup
    source: ViewpointSource
    method: FirstOrderMethod = "joint"
    threads: int | None = None
    corrections: Corrections = field(default_factory=Corrections)

    @classmethod
    def of(
        cls,
        inspection: Inspection,
        characteristics: Sequence[Characteristic],
        source: ViewpointSource,
        method: FirstOrderMethod = "joint",
        threads: int | None = None,
    ) -> EvaluationJob:
        """A job with some characteristics of an inspection."""
        return cls(
            tuple(characteristics),
            inspection.part.mesh,
            inspection.setup,
            source,
            method,
            threads,
        )


@lru_cache(maxsize=2)
def evaluator_of(job: EvaluationJob) -> Evaluator:
    """The job's evaluator, made once in each process."""
    return Evaluator(job.characteristics, job.mesh, job.setup, job.method, job.threads)


def candidate_grid(inspection: Inspection, characteristics: Sequence[Characteristic]) -> CandidateGrid:
    """The candidates that an inspection samples to measure some characteristics."""
    points = MeasurandTable.of(characteristics).points
    return CandidateGrid(points, inspection.part.mesh, inspection.camera, inspection.candidates, inspection.seed)


def reachable(inspection: Inspection, characteristics: Sequence[Characteristic]) -> ExplicitViewpoints:
    """The explicit viewpoints that the stated members of the allowed region allow.

    Distance and cone say how viewpoints are sampled; given ones are not asked for them.
    """
    viewpoints, options = inspection.viewpoints, inspection.candidates
    assert viewpoints is not None  # the caller's condition
    if not options.regions:
        return viewpoints
    ends = MeasurandTable.of(characteristics).points.reshape(-1, 3)
    workpiece = Workpiece(inspection.part.mesh, (ends.min(axis=0) + ends.max(axis=0)) / 2)
    stays = options.stated_region(workpiece).allows(viewpoints.T_part_camera)
    outside = " or ".join(dict.fromkeys(member.outside for member in options.regions))
    if not stays.any():
        raise NoCandidateError(
            f"no candidate viewpoint is left: every one of the {len(viewpoints)} viewpoints of the file is {outside}"
        )
    if not stays.all():
        _log.info("%d of %d explicit viewpoints are left out: %s", (~stays).sum(), len(stays), outside)
    rows = np.flatnonzero(stays)
    return ExplicitViewpoints(tuple(viewpoints.ids[k] for k in rows), viewpoints.T_part_camera[rows])


def chunks_of(source: ViewpointSource, size: int) -> list[Chunk]:
    """The source in chunks of ``size`` viewpoints."""
    return [(first, min(first + size, len(source))) for first in range(0, len(source), size)]


def require_chunk_size(viewpoints: int) -> None:
    """Raise InputError unless a chunk can have this many viewpoints."""
    if isinstance(viewpoints, bool) or not isinstance(viewpoints, int | np.integer) or viewpoints < 1:
        raise InputError(
            "not a number of viewpoints", key="chunk", got=repr(viewpoints), expected="a whole number from 1 on"
        )


def accepted_chunk(job: EvaluationJob, chunk: Chunk) -> Undominated:
    """Of a chunk's viewpoints those that a cover may need."""
    accepted = evaluator_of(job).accepted(job.source.poses(*chunk))
    level = probability_levels(accepted.probability, job.setup.requirement.probability, len(job.source))
    some = np.flatnonzero(level.any(axis=1))
    kept = Undominated(len(job.characteristics))
    kept.add(chunk[0] + some, level[some], accepted.certain[some])
    return kept


def best_chunk(job: EvaluationJob, chunk: Chunk) -> BestRows:
    """The best of a chunk's viewpoints for each characteristic."""
    table, index = evaluator_of(job).table(job.source.poses(*chunk)), np.arange(*chunk)
    return BestRows.of(job.corrections.applied(table, index), index)


@dataclass(frozen=True, eq=False)
class TableJob:
    """What all chunks of a table share.

    Parameters
    ----------
    precision, seed
        With ``precision`` the full camera model judges each visible pair.
    columns
        Names of the columns wanted; none to keep only the best of each characteristic.
    writer
        What writes a chunk from any process; None to give it back.
    """

    evaluation: EvaluationJob
    columns: tuple[str, ...]
    precision: float | None = None
    seed: int = 0
    writer: ChunkWriter | None = None


def table_chunk(job: TableJob, chunk: Chunk) -> tuple[BestRows, dict[str, NDArray[np.generic]]]:
    """The best of a chunk's viewpoints for each characteristic, and the columns of its table if nobody else writes
    them.
    """
    evaluation = job.evaluation
    poses = evaluation.source.poses(*chunk)
    table = evaluator_of(evaluation).table(poses)
    extra: dict[str, NDArray[np.generic]] = {}
    if job.precision is not None:
        table, low, high = simulated(table, poses, evaluation, job.precision, job.seed)
        extra = {"probability_low": low, "probability_high": high}
    best = BestRows.of(table, np.arange(*chunk))
    accepted = table.visible & (table.probability >= evaluation.setup.requirement.probability)
    own = {"visible": table.visible, "accepted": accepted, **extra}
    values = {name: own[name] if name in own else getattr(table, name) for name in job.columns}
    if job.writer is None:
        return best, values
    job.writer.write(chunk[0], values, {"best": {name: array.tolist() for name, array in best.arrays().items()}})
    return best, {}


def simulated(
    table: TableBlock, poses: NDArray[np.float64], job: EvaluationJob, precision: float, seed: int
) -> tuple[TableBlock, NDArray[np.float64], NDArray[np.float64]]:
    """The table with the full camera model's probability and expected accuracy of visible pairs, and the intervals'
    ends.
    """
    probability, accuracy = table.probability.copy(), table.expected_accuracy.copy()
    low, high = np.zeros(probability.shape), np.zeros(probability.shape)
    pairs = np.argwhere(table.visible)
    for first in range(0, len(pairs), _PAIRS_SIMULATED):
        some = pairs[first : first + _PAIRS_SIMULATED]
        estimates = simulate_pairs(table, some, poses, job, precision, seed)
        at = tuple(some.T)
        probability[at], accuracy[at] = estimates.probability, estimates.expected_accuracy
        low[at], high[at] = estimates.low, estimates.high
    return replace(table, probability=probability, expected_accuracy=accuracy), low, high


def simulate_pairs(
    table: TableBlock,
    pairs: NDArray[np.int64],
    poses: NDArray[np.float64],
    job: EvaluationJob,
    precision: float,
    seed: int,
) -> FullModelEstimates:
    """The full camera model's word on visible pairs ``(n, 2)`` of a table: indices of viewpoint and characteristic."""
    from ..simulation import Sampling, estimate_success_probabilities

    viewpoint, characteristic = pairs.T
    measurands = [job.characteristics[j].measurands[table.measurand[k, j]] for k, j in pairs]
    ends = np.array([(measurand.start, measurand.end) for measurand in measurands])
    points = transform(invert(poses[viewpoint])[:, None], ends)
    return estimate_success_probabilities(
        points[:, 0],
        points[:, 1],
        job.setup.camera,
        job.setup.pose_error,
        table.relative_tolerance[viewpoint, characteristic],
        sampling=Sampling(precision=precision, confidence=CONFIDENCE, seed=seed),
        rim_axis=rim_axes(measurands, poses[viewpoint]),
    )
