"""Time and memory of planning a part: reading, evaluating, choosing, writing the report.

Usage: python benchmarks/plan_part.py INSPECTION_FILE PART_FILE [CANDIDATES]

CANDIDATES (default 2000) is the approximate number of candidate viewpoints. Times are of one run, wall clock; memory is
the largest resident set of this process (the child that reads STEP has its own, printed beside it).
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from dataclasses import replace

import viewgauge as vg


class Stopwatch:
    """Prints how long each stage took."""

    def __init__(self) -> None:
        self.start = self.last = time.perf_counter()

    def lap(self, name: str) -> None:
        """Print the time since the last lap."""
        now = time.perf_counter()
        print(f"{name:38s} {now - self.last:8.2f} s")
        self.last = now


def main(inspection_file: str, part_file: str, candidates: int) -> None:
    """Plan once and print the figures."""
    watch = Stopwatch()
    inspection = vg.load(inspection_file, part=part_file)
    watch.lap("read the inspection and the part")
    rolls, distances, targets = 2, 2, 4
    directions = max(1, candidates // (rolls * distances * (targets + 1)))
    options = replace(inspection.candidates, rolls=rolls, distances=distances, targets=targets, directions=directions)
    inspection = replace(inspection, candidates=options)
    chosen = vg.plan(inspection, refine=False, prove=False)
    watch.lap(f"best of {chosen.candidate_count} candidates")
    plan = vg.plan(inspection)
    watch.lap("the same, refined, with proofs")
    with tempfile.TemporaryDirectory() as folder:
        vg.write_plan(plan, inspection, folder)
    watch.lap("write the plan and its report")
    measurands = sum(len(d.measurands) for d in inspection.part.characteristics)
    met = sum(d.status == "met" for d in plan.characteristics)
    print(f"{'in all':38s} {time.perf_counter() - watch.start:8.2f} s")
    print(
        f"{len(inspection.part.characteristics)} characteristics, {measurands} measurands, {plan.count} "
        f"viewpoints, {met} met"
    )
    for name, who in (("this process", resource.RUSAGE_SELF), ("STEP child", resource.RUSAGE_CHILDREN)):
        print(f"largest resident set, {name}: {resource.getrusage(who).ru_maxrss / 1024:.0f} MiB")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) == 4 else 2000)
