"""Work in a child process: its result, its errors, its end on request."""

from __future__ import annotations

import os
import time

import pytest

from viewgauge.exceptions import InputError, JobCancelledError, ViewgaugeError
from viewgauge.execution.child_process import Job


def adds(progress, a, b):
    with progress.stage("Adding", 2) as advance:
        advance(1)
        advance(1)
    return a + b


def refuses(_):
    raise InputError("not that", key="what", got=3, expected="4", hint="try 4")


def breaks(_):
    raise RuntimeError("a defect")


def vanishes(_):
    os._exit(7)


def sleeps(_, path):
    path.write_text(str(os.getpid()))
    time.sleep(600)


def takes_memory(_):
    return bytearray(6 * 2**30) and None


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def started(path):
    deadline = time.monotonic() + 300
    while not (path.exists() and path.read_text()) and time.monotonic() < deadline:
        time.sleep(0.05)
    return int(path.read_text())


def test_the_result_comes_back_with_the_stages():
    stages = []
    job = Job(adds, 2, 3, watcher=stages.append)
    assert job.result() == 5
    assert not job.running
    assert (stages[0].name, stages[0].total, stages[0].share) == ("Adding", 2, 0.0)


def test_a_users_mistake_comes_back_as_it_was_raised():
    with pytest.raises(InputError) as caught:
        Job(refuses).result()
    assert (caught.value.problem, caught.value.key, caught.value.got, caught.value.hint) == (
        "not that", "what", 3, "try 4",
    )  # fmt: skip
    assert "expected: 4" in str(caught.value)


def test_a_defect_is_reported_without_ending_the_parent():
    with pytest.raises(ViewgaugeError, match="unexpected error: RuntimeError: a defect"):
        Job(breaks).result()


def test_a_crash_is_reported():
    with pytest.raises(ViewgaugeError, match=r"crashed \(exit code 7\)"):
        Job(vanishes).result()


def test_it_ends_on_request(tmp_path):
    job = Job(sleeps, tmp_path / "pid")
    child = started(tmp_path / "pid")
    assert job.running
    assert alive(child)
    job.cancel()
    with pytest.raises(JobCancelledError):
        job.result()
    assert not alive(child)


def test_it_ends_when_its_time_is_up(tmp_path):
    job = Job(sleeps, tmp_path / "pid", timeout_s=0.2)
    with pytest.raises(ViewgaugeError, match=r"longer than 0\.2 s"):
        job.result()


@pytest.mark.skipif(os.name != "posix", reason="limits of memory are POSIX only")
def test_memory_is_limited():
    with pytest.raises(ViewgaugeError, match="more memory"):
        Job(takes_memory, memory_bytes=4 * 2**30).result()
