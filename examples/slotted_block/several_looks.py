"""The numbers of docs/howto/looks.md: what averaging several looks gains on the block, and what limits the gain.

Usage: python several_looks.py
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import viewgauge as vg
from viewgauge.execution.chunks import EvaluationJob, candidate_grid
from viewgauge.jobs.planning.averaging_search import AddedLooks, add_looks, looks_chunk
from viewgauge.planning import CandidateGrid, PlannedSetting

FILE = Path(__file__).parent / "looks.yaml"


def single_plan(inspection: vg.Inspection) -> tuple[vg.Plan, EvaluationJob, list[int]]:
    """The plan without averaging, a job with the dimensions that it leaves, and its settings' indices in that job."""
    plan = vg.plan(replace(inspection, looks=1), refine=False, prove=False)
    grid = candidate_grid(inspection, inspection.part.dimensions)
    left = {planned.id for planned in plan.dimensions if planned.status == "unmet"}
    job = EvaluationJob.of(inspection, [d for d in inspection.part.dimensions if d.id in left], grid)
    return plan, job, [index_of(setting, grid) for setting in plan.settings]


def index_of(setting: PlannedSetting, grid: CandidateGrid) -> int:
    """The candidate that a planned setting is."""
    poses = grid.poses(0, len(grid))
    (index,) = (poses == setting.T_part_camera).all(axis=(1, 2)).nonzero()[0]
    return int(index)


def averaged(job: EvaluationJob, planned: list[int], most: int) -> AddedLooks:
    """What at most so many looks meet of the job's dimensions."""
    return add_looks(job, looks_chunk(job, (0, len(job.source))), planned, most, seed=0)


def main() -> None:
    """Print the tables of the page."""
    inspection = vg.load(FILE)
    plan, job, planned = single_plan(inspection)
    met = sum(dimension.status == "met" for dimension in plan.dimensions)
    print(f"one look: {met} of {len(plan.dimensions)} dimensions met from {plan.count} settings\n")

    print("looks at most | met | settings")
    for most in (2, 3, 4, 8):
        added = averaged(job, planned, most)
        print(f"{most:13} | {met + len(added.dimensions):3} | {plan.count + len(added.settings)}")

    print(f"\ndimension | best look | mean | looks, at most {inspection.looks}")
    for entry in averaged(job, planned, inspection.looks).dimensions:
        name = job.dimensions[entry.dimension].id
        print(f"{name:9} | {entry.probability_single:9.3f} | {entry.probability:.3f} | {len(entry.looks)}")

    print("\nof the same error of a look | met with at most 3")
    head = inspection.head
    for said, share in (("nothing common", 0.0), ("half of the variance common", 0.5), ("all common", 1.0)):
        other = vg.PoseError(
            head.covariance, T_camera_head=head.T_camera_head, common_covariance=share * head.covariance
        )
        added = averaged(replace(job, head=other), planned, 3)
        print(f"{said:27} | {met + len(added.dimensions)}")


if __name__ == "__main__":
    main()
