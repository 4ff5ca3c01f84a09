"""How the time and the memory of a job grow with its size, in this process and on a local cluster.

Usage: python benchmarks/scaling.py [--largest PAIRS] [--table-largest PAIRS] [--workers N …]

Evaluates the example part (15 characteristics, 147 measurands) from ever more candidates, each size in a process of its
own:

- "plan": the whole plan, in which dominated viewpoints are removed as they come;
- "table": every column of the table into Zarr.

Pairs are those of viewpoint and measurand that the kernel is given; a row of the table is a viewpoint and a
characteristic. Memory is the largest resident set of the process; what imports and the part take is the row of the
smallest size. Ten minutes.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import part
from viewgauge.execution.executor import open_executor
from viewgauge.jobs.evaluate import evaluate_into
from viewgauge.jobs.planning.plan import plan


def measure(job: str, pairs: int, workers: int) -> dict[str, float]:
    """One job in this process: seconds, pairs, largest resident set."""
    measurands = len(part.measurands())
    inspection = part.with_candidates(max(256, pairs // measurands))
    small = part.with_candidates(600)  # compiled code is loaded, and the ray caster ready, before the clock starts
    with open_executor(workers=workers or None) as executor, tempfile.TemporaryDirectory(dir=os.getcwd()) as folder:

        def run(i: part.vg.Inspection, name: str) -> int:
            if job == "table":
                return evaluate_into(i, Path(folder) / name, sampled=True, executor=executor).viewpoints
            return plan(i, executor=executor).candidate_count

        run(small, "small.zarr")
        start = time.perf_counter()
        viewpoints = run(inspection, "table.zarr")
        seconds = time.perf_counter() - start
        size = sum(f.stat().st_size for f in Path(folder, "table.zarr").rglob("*") if f.is_file())
    return {
        "viewpoints": viewpoints,
        "pairs": viewpoints * measurands,
        "seconds": seconds,
        "mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "stored": size,
    }


def main() -> None:
    """Measure each size in a process of its own, and print a table."""
    parser = argparse.ArgumentParser(description="How time and memory grow with the size of a job")
    parser.add_argument("--largest", type=float, default=1e9, help="pairs of the largest plan")
    parser.add_argument("--table-largest", type=float, default=1e8, help="pairs of the largest table")
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2], help="local clusters, for one size")
    parser.add_argument("--one", nargs=3, metavar=("JOB", "PAIRS", "WORKERS"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        job, pairs, workers = options.one
        print(json.dumps(measure(job, int(float(pairs)), int(workers))))
        return
    sizes = [10.0**k for k in range(5, 13)]
    jobs = [("plan", p, 0) for p in sizes if p <= options.largest]
    jobs += [("table", p, 0) for p in sizes if p <= options.table_largest]
    jobs += [("plan", min(1e8, options.largest), w) for w in options.workers]
    print("| job | viewpoints | pairs | seconds | ns a pair | stored, bytes a row | memory, MiB |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for job, pairs, workers in jobs:
        command = [sys.executable, __file__, "--one", job, str(pairs), str(workers)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        row = json.loads(done.stdout)
        name = f"{job}, {workers} worker{'s' * (workers > 1)}" if workers else job
        stored = f"{row['stored'] / row['viewpoints'] / 15:.1f}" if row["stored"] else "-"
        print(
            f"| {name} | {row['viewpoints']:,.0f} | {row['pairs']:.3g} | {row['seconds']:.2f} | "
            f"{row['seconds'] / row['pairs'] * 1e9:.1f} | {stored} | {row['mib']:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
