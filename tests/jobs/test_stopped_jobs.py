"""Long jobs that are killed go on where they were, a full disk is told, and memory holds a chunk, not the job."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from long_jobs import Counting, grid, plan_bytes, tree, write_inspection

import viewgauge as vg
from viewgauge.cli import main
from viewgauge.execution.executor import InProcess
from viewgauge.geometry import PoseError
from viewgauge.part import Mesh


@pytest.fixture(scope="module")
def inspection(tmp_path_factory):
    return write_inspection(tmp_path_factory.mktemp("inspection"))


@pytest.fixture(scope="module")
def poses(inspection):
    sampled = grid(inspection)
    return sampled.poses(0, len(sampled))


# --- killed jobs go on ------------------------------------------------------------------------------------------------


@contextmanager
def started(arguments, folder):
    """The command in a group of processes of its own."""
    job = subprocess.Popen(
        [sys.executable, "-m", "viewgauge", *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        cwd=folder,
        start_new_session=True,
    )
    try:
        yield job
    finally:
        with suppress(ProcessLookupError):
            os.killpg(job.pid, signal.SIGKILL)
        job.wait()


def entries(folder):
    """The chunks that are noted as done in a job's journal."""
    return {path.name for path in Path(folder).glob("*/done/*.npz")}


class TooEarlyError(Exception):
    """The job ended before it could be killed."""


def killed(arguments, folder, journal, after, only_the_first=False):
    """Start a command, kill it without warning once so many more chunks are noted; how many are noted then."""
    at_start = len(entries(journal))
    with started(arguments, folder) as job:
        deadline = time.monotonic() + 300  # imports, beside a busy machine
        while len(entries(journal)) < at_start + after:
            if job.poll() is not None:
                raise TooEarlyError
            assert time.monotonic() < deadline
            time.sleep(0.001)
        (os.kill if only_the_first else os.killpg)(job.pid, signal.SIGKILL)
        job.wait()
        assert_ends(job.pid)  # its workers too, by themselves where only the first was killed
    return len(entries(journal))


def killed_often(arguments, folder, journal, times, only_the_first):
    """Where it is killed is chance; a machine that stalls may see it end before, and it is begun once more."""
    rng = np.random.default_rng()
    for _ in range(10):
        try:
            least = rng.integers(1, 30, times).tolist()
            return [killed(arguments, folder, journal, after, only_the_first) for after in least]
        except TooEarlyError:
            shutil.rmtree(journal.parent)
    raise AssertionError("the job always ended before it could be killed")


def assert_ends(group):
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    raise AssertionError("processes are left")


PLAN = ["plan", "inspection.yaml", "-o", "out", "--no-refine", "--no-prove"]  # what comes after the chunks
JOBS = {
    "plan": ([*PLAN, "--chunk", "4"], "out", "out/.partial"),
    "evaluate": (
        ["evaluate", "inspection.yaml", "--sampled", "-o", "out/t.zarr", "--chunk", "4", "--columns", "probability"],
        "out",
        "out/.t.zarr.partial",
    ),
}


@pytest.mark.skipif(os.name != "posix", reason="groups of processes are POSIX only")
@pytest.mark.parametrize("name", JOBS)
@pytest.mark.parametrize("workers", [0, 2])
def test_a_killed_job_goes_on_where_it_was(tmp_path, monkeypatch, capsys, name, workers):
    pytest.importorskip("zarr")
    if workers:
        pytest.importorskip("distributed", reason="Dask is not installed")
    write_inspection(tmp_path, candidates="{distance: '[200, 400] mm', distances: 4, directions: 40, rolls: 2}")
    monkeypatch.chdir(tmp_path)
    arguments, out, journal = JOBS[name]
    code = main(arguments)
    undisturbed = tree(out)
    Path(out).rename("undisturbed")
    at_work = [*arguments, "--workers", str(workers)] if workers else arguments
    times = 1 if workers else 2
    noted = killed_often(at_work, tmp_path, Path(journal), times, bool(workers))
    assert 0 < noted[0] <= noted[-1]
    assert len(set(noted)) == times, "the second start went on from the first"
    counting = Counting()

    @contextmanager
    def opened(*_):
        yield counting

    monkeypatch.setattr(vg, "open_executor", opened)
    assert main(arguments) == code
    capsys.readouterr()
    total = -(-len(grid(vg.load("inspection.yaml"))) // 4)
    assert counting.chunks[0] == total - noted[-1]
    assert tree(out) == undisturbed
    assert not [path for path in Path(out).rglob("*") if "partial" in path.name]


def test_the_second_pass_of_a_plan_goes_on_too(tmp_path):
    inspection = write_inspection(tmp_path, requirement="{error: 1 nm, probability: 0.95}")
    options = {"refine": False, "prove": False}  # what comes after both passes
    whole = plan_bytes(inspection, tmp_path / "whole", **options)

    class Stopped(Counting):
        """Gives up in the second pass, after ten chunks."""

        def run(self, function, common, items):
            for n, pair in enumerate(super().run(function, common, items)):
                if len(self.chunks) == 2 and n == 10:
                    raise KeyboardInterrupt
                yield pair

    options |= {"journal": tmp_path / "notes", "viewpoints_per_chunk": 20}
    with pytest.raises(KeyboardInterrupt):
        vg.plan(inspection, executor=Stopped(), **options)
    counting = Counting()
    assert plan_bytes(inspection, tmp_path / "again", executor=counting, **options) == whole
    chunks = -(-len(grid(inspection)) // 20)
    assert counting.chunks == [0, chunks - 10]
    assert not (tmp_path / "notes").exists()


def changed(inspection):
    """Inspections that differ in one thing that no file tells of."""
    part = inspection.part
    longer = replace(part.characteristics[0], nominal_mm=61.0)
    moved = Mesh(part.mesh.vertices + 1e-9, part.mesh.triangles)
    yield "characteristic", replace(inspection, part=replace(part, characteristics=(longer, *part.characteristics[1:])))
    yield "mesh", replace(inspection, part=replace(part, mesh=moved))
    yield "seed", replace(inspection, seed=inspection.seed + 1)
    yield "requirement", replace(inspection, requirement=replace(inspection.requirement, probability=0.91))
    yield "pose_error", replace(inspection, pose_error=PoseError(inspection.pose_error.covariance, (0.0, 0.0, -16.01)))


def test_a_job_goes_on_only_with_the_same_contents(inspection, poses, tmp_path):
    pytest.importorskip("zarr")

    class Stopped(InProcess):
        def run(self, function, common, items):
            for n, pair in enumerate(super().run(function, common, items)):
                if n == 5:
                    raise KeyboardInterrupt
                yield pair

    def left_to_do(other, viewpoints=poses[:40], chunk=4, columns=("visible",), **options):
        with pytest.raises(KeyboardInterrupt):
            vg.evaluate_into(
                inspection,
                tmp_path / "t.zarr",
                poses[:40],
                columns=["visible"],
                executor=Stopped(),
                viewpoints_per_chunk=4,
            )
        counting = Counting()
        vg.evaluate_into(
            other,
            tmp_path / "t.zarr",
            viewpoints,
            executor=counting,
            viewpoints_per_chunk=chunk,
            columns=columns,
            **options,
        )
        return counting.chunks[0]

    assert left_to_do(inspection) == 4, "six are written when the sixth is refused"
    for name, other in changed(inspection):
        assert left_to_do(other) == 10, name
    assert left_to_do(inspection, poses[1:41]) == 10
    assert left_to_do(inspection, chunk=5) == 8
    assert left_to_do(inspection, columns=["probability"]) == 10
    assert left_to_do(inspection, method="independent") == 10


FULL_DISK = """
import resource, sys
from viewgauge.cli import main
assert main(sys.argv[1:]) < 2  # everything is imported and compiled
resource.setrlimit(resource.RLIMIT_FSIZE, (300, -1))
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.skipif(os.name != "posix", reason="limits on files are POSIX only")
@pytest.mark.parametrize("arguments", [["-o", "t.csv"], ["-o", "t.zarr"], None])
def test_a_full_disk_is_a_message(tmp_path, arguments):
    pytest.importorskip("zarr")
    write_inspection(tmp_path)
    command = PLAN if arguments is None else None
    command = command or ["evaluate", "inspection.yaml", "--sampled", *arguments]
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, *command, "--chunk", "20"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=600,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert "free some space" in done.stderr
    written = {"-o t.csv": "t.csv", "-o t.zarr": "t.zarr", "": "out/plan.json"}[" ".join(arguments or [])]
    assert (tmp_path / written).exists(), "what was there before stays"


# --- memory -----------------------------------------------------------------------------------------------------------

PEAK = """
import os, sys
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])  # each thread has buffers of its own
from dataclasses import replace
import viewgauge as vg
inspection = vg.load(sys.argv[1])
directions, job = int(sys.argv[2]), sys.argv[3]
def run(directions):
    here = replace(inspection, candidates=replace(inspection.candidates, directions=directions))
    if job == "plan":
        vg.plan(here, viewpoints_per_chunk=1000)
    else:
        path = None if job == "nothing" else sys.argv[4]
        vg.evaluate_into(here, path, sampled=True, viewpoints_per_chunk=1000)
run(directions)
print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM:")))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is told in KiB on Linux")
@pytest.mark.parametrize("job", ["plan", "csv", "zarr"])
def test_memory_is_bounded_by_the_chunk_and_not_by_the_number_of_viewpoints(tmp_path, job):
    pytest.importorskip("zarr")
    write_inspection(tmp_path, candidates="{distance: '[200, 400] mm', distances: 5, rolls: 2, targets: 0}")

    def peak(directions):
        command = [sys.executable, "-c", PEAK, str(tmp_path / "inspection.yaml"), str(directions), job]
        out = subprocess.run([*command, str(tmp_path / f"t.{job}")], capture_output=True, text=True, check=True)
        return int(out.stdout) / 1024

    small, large = peak(1000), peak(8000)
    # To keep all of the larger, 80 000 viewpoints of 5 characteristics, would take 40 MiB (columns) or 14 MiB (of a
    # plan: poses and what is accepted); two runs of the same differ by less than 1 MiB, most of it libraries (220 MiB).
    assert large < small + 9, (small, large)
