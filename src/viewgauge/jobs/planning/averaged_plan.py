"""Viewpoints that are added to an arrangement so that characteristics are averaged from several of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import TableBlock
from ...execution.chunks import EvaluationJob, ViewpointSource, evaluator_of
from ...planning import Averaged, assigned_viewpoint
from ...planning.averaging.shortlist import AcquisitionShortlist
from .averaging_search import AveragedCharacteristic, add_acquisitions
from .refine import Arrangement

__all__ = ["averaged"]


def averaged(
    job: EvaluationJob,
    arrangement: Arrangement,
    not_met: Sequence[int],
    shortlist: AcquisitionShortlist,
    most: int,
    seed: int,
) -> tuple[Arrangement, dict[int, Averaged], NDArray[np.int64]]:
    """Characteristics that the mean of 2 to ``most`` acquisitions meets, and the viewpoints that are added for them.

    Parameters
    ----------
    not_met, shortlist
        Characteristics that no candidate meets, and of them, in this order, the viewpoints worth averaging from.

    Returns
    -------
    The arrangement with the new viewpoints after its own, from which nothing is measured by one acquisition; the
    characteristics; and the new viewpoints' indices in the job's source.
    """
    met = assigned_viewpoint(arrangement.table, job.setup.requirement.probability) >= 0
    still = [place for place, j in enumerate(not_met) if not met[j]]
    asked = [not_met[place] for place in still]
    count, first = len(arrangement.T_part_camera), len(job.source)
    source = _Extended(job.source, arrangement.T_part_camera)
    asked_job = replace(job, characteristics=tuple(job.characteristics[j] for j in asked), source=source)
    added = add_acquisitions(asked_job, shortlist.of_characteristics(still), range(first, first + count), most, seed)
    poses = np.array([source.poses(k, k + 1)[0] for k in added.viewpoints.tolist()]).reshape(-1, 4, 4)
    if len(poses):
        more = evaluator_of(job).table(poses)
        more = replace(more, probability=np.zeros_like(more.probability))  # confirmed is only what is averaged
        table = TableBlock(
            *(np.concatenate([getattr(arrangement.table, f.name), getattr(more, f.name)]) for f in fields(more))
        )
        poses = np.concatenate([arrangement.T_part_camera, poses])
        arrangement = replace(arrangement, T_part_camera=poses, table=table)
    found = {}
    for entry in added.characteristics:
        rows, at = arrangement.best[asked[entry.characteristic]]
        found[asked[entry.characteristic]] = _of(entry, asked_job, float(rows.values.probability[at]))
    return arrangement, found, added.viewpoints


def _of(entry: AveragedCharacteristic, job: EvaluationJob, refined_probability: float) -> Averaged:
    length = job.characteristics[entry.characteristic].nominal_mm
    # mean of |error|, as of a normal law, which a mean of acquisitions is near to
    accuracy = 1 - np.sqrt(2 / np.pi) * entry.deviation_mm / length
    alone = max(entry.probability_single, refined_probability)
    return Averaged(entry.acquisitions, entry.measurands, entry.probability, float(accuracy), alone)


@dataclass(frozen=True, eq=False)
class _Extended:
    """The viewpoints of a source, and after them some more, ``(m, 4, 4)`` mm."""

    source: ViewpointSource
    more: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.source) + len(self.more)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` of viewpoints ``first`` to ``stop - 1``."""
        own = len(self.source)
        if stop <= own:
            return self.source.poses(first, stop)
        more = self.more[max(first - own, 0) : stop - own]
        return np.concatenate([self.source.poses(first, own), more]) if first < own else more
