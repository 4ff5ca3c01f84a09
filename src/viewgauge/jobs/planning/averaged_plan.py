"""To an arrangement of settings those that come to it where dimensions may be averaged from several looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ...evaluation import TableBlock
from ...execution.chunks import EvaluationJob, SettingSource, evaluator_of
from ...planning import Averaged, assigned_setting
from ...planning.averaging.shortlist import LookShortlist
from .averaging_search import DimensionByLooks, add_looks
from .refine import Arrangement

__all__ = ["averaged"]


def averaged(
    job: EvaluationJob, arrangement: Arrangement, unmet: Sequence[int], shortlist: LookShortlist, most: int, seed: int
) -> tuple[Arrangement, dict[int, Averaged], NDArray[np.int64]]:
    """Dimensions that the mean of 2 to ``most`` looks meets, and the settings that come to those of the arrangement.

    Parameters
    ----------
    unmet, shortlist
        Dimensions that no candidate meets, and of them, in this order, the settings worth averaging from.

    Returns
    -------
    The arrangement with the new settings after its own, from which nothing is measured by one look; the dimensions; and
    the new settings' indices in the job's source.
    """
    met = assigned_setting(arrangement.table, job.requirement.probability) >= 0
    still = [place for place, j in enumerate(unmet) if not met[j]]
    asked = [unmet[place] for place in still]
    count, first = len(arrangement.T_part_camera), len(job.source)
    source = _Extended(job.source, arrangement.T_part_camera)
    looked = replace(job, dimensions=tuple(job.dimensions[j] for j in asked), source=source)
    added = add_looks(looked, shortlist.of_dimensions(still), range(first, first + count), most, seed)
    poses = np.array([source.poses(k, k + 1)[0] for k in added.settings.tolist()]).reshape(-1, 4, 4)
    if len(poses):
        more = evaluator_of(job).table(poses)
        more = replace(more, probability=np.zeros_like(more.probability))  # confirmed is only what is averaged
        table = TableBlock(
            *(np.concatenate([getattr(arrangement.table, f.name), getattr(more, f.name)]) for f in fields(more))
        )
        poses = np.concatenate([arrangement.T_part_camera, poses])
        arrangement = replace(arrangement, T_part_camera=poses, table=table)
    found = {}
    for entry in added.dimensions:
        rows, at = arrangement.best[asked[entry.dimension]]
        found[asked[entry.dimension]] = _of(entry, looked, float(rows.values.probability[at]))
    return arrangement, found, added.settings


def _of(entry: DimensionByLooks, job: EvaluationJob, refined_probability: float) -> Averaged:
    length = job.dimensions[entry.dimension].nominal_mm
    # mean of |error|, as of a normal law, which a mean of looks is near to
    accuracy = 1 - np.sqrt(2 / np.pi) * entry.deviation_mm / length
    alone = max(entry.probability_single, refined_probability)
    return Averaged(entry.looks, entry.gauges, entry.probability, float(accuracy), alone)


@dataclass(frozen=True, eq=False)
class _Extended:
    """The settings of a source, and after them some more, ``(m, 4, 4)`` mm."""

    source: SettingSource
    more: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.source) + len(self.more)

    def poses(self, first: int, stop: int) -> NDArray[np.float64]:
        """``T_part_camera`` of settings ``first`` to ``stop - 1``."""
        own = len(self.source)
        if stop <= own:
            return self.source.poses(first, stop)
        more = self.more[max(first - own, 0) : stop - own]
        return np.concatenate([self.source.poses(first, own), more]) if first < own else more
