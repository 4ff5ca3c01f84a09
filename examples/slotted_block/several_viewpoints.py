"""The numbers of docs/howto/averaging.md: what averaging several viewpoints gains on the block, and what limits the
gain.

Usage: python several_viewpoints.py
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import viewgauge as vg
from viewgauge.execution.chunks import EvaluationJob, candidate_grid
from viewgauge.jobs.planning.averaging_search import AddedAcquisitions, acquisitions_chunk, add_acquisitions
from viewgauge.planning import CandidateGrid, PlannedViewpoint

FILE = Path(__file__).parent / "averaging.yaml"


def single_plan(inspection: vg.Inspection) -> tuple[vg.Plan, EvaluationJob, list[int]]:
    """The plan without averaging, a job with the characteristics that it leaves, and its viewpoints' indices in that
    job.
    """
    plan = vg.plan(replace(inspection, averaged_viewpoints=1), refine=False, prove=False)
    grid = candidate_grid(inspection, inspection.part.characteristics)
    left = {planned.id for planned in plan.characteristics if planned.status == "not_met"}
    job = EvaluationJob.of(inspection, [d for d in inspection.part.characteristics if d.id in left], grid)
    return plan, job, [index_of(viewpoint, grid) for viewpoint in plan.viewpoints]


def index_of(viewpoint: PlannedViewpoint, grid: CandidateGrid) -> int:
    """The candidate that a planned viewpoint is."""
    poses = grid.poses(0, len(grid))
    (index,) = (poses == viewpoint.T_part_camera).all(axis=(1, 2)).nonzero()[0]
    return int(index)


def averaged(job: EvaluationJob, planned: list[int], most: int) -> AddedAcquisitions:
    """What at most so many acquisitions meet of the job's characteristics."""
    return add_acquisitions(job, acquisitions_chunk(job, (0, len(job.source))), planned, most, seed=0)


def main() -> None:
    """Print the tables of the page."""
    inspection = vg.load(FILE)
    plan, job, planned = single_plan(inspection)
    met = sum(characteristic.status == "met" for characteristic in plan.characteristics)
    print(f"one acquisition: {met} of {len(plan.characteristics)} characteristics met from {plan.count} viewpoints\n")

    print("at most | met | viewpoints")
    for most in (2, 3, 4, 8):
        added = averaged(job, planned, most)
        print(f"{most:7} | {met + len(added.characteristics):3} | {plan.count + len(added.viewpoints)}")

    print(f"\ncharacteristic | best acquisition | mean | acquisitions, at most {inspection.averaged_viewpoints}")
    for entry in averaged(job, planned, inspection.averaged_viewpoints).characteristics:
        name = job.characteristics[entry.characteristic].id
        print(f"{name:14} | {entry.probability_single:16.3f} | {entry.probability:.3f} | {len(entry.acquisitions)}")

    print("\ncommon part of the pose error | met with at most 3")
    pose_error = inspection.pose_error
    for said, share in (("nothing common", 0.0), ("half of the variance common", 0.5), ("all common", 1.0)):
        other = vg.PoseError(
            pose_error.covariance,
            T_camera_frame=pose_error.T_camera_frame,
            common_covariance=share * pose_error.covariance,
        )
        added = averaged(replace(job, setup=replace(job.setup, pose_error=other)), planned, 3)
        print(f"{said:27} | {met + len(added.characteristics)}")


if __name__ == "__main__":
    main()
