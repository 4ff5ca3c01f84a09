"""Chunks run in this process and on clusters alike; lost workers cost their chunk and nothing else."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from viewgauge.exceptions import InputError, ViewgaugeError, ViewpointsFileError
from viewgauge.execution.executor import InProcess, open_executor


@dataclass(frozen=True)
class Shared:
    """What all items share; ``folder`` is where the functions leave traces."""

    weights: np.ndarray
    folder: str = ""


def weigh(shared, item):
    return shared.weights * item


def leave_trace(shared, item):
    """One file for each time the item is begun; its name tells the process."""
    Path(shared.folder, f"{item}.{os.getpid()}.{time.monotonic_ns()}").touch()


PATIENCE_S = 120  # processes start and end in a second or two; beside a busy machine not


def wait_for(*paths):
    deadline = time.monotonic() + PATIENCE_S
    while not all(Path(path).exists() for path in paths):
        assert time.monotonic() < deadline, paths
        time.sleep(0.01)


def hold_item_3(shared, item):
    """Item 3 is held until somebody says go."""
    leave_trace(shared, item)
    if item == 3:
        wait_for(Path(shared.folder, "go"))
    return item * 10


def end_this_process():
    """Not at once: Dask starts no worker in place of one that ends before its nanny has seen that it is there."""
    time.sleep(0.5)
    os.kill(os.getpid(), signal.SIGKILL)


def end_own_process(shared, item):
    leave_trace(shared, item)
    if item == 2:
        end_this_process()
    return item


def refuse(shared, item):
    leave_trace(shared, item)
    if item == 1:
        raise ViewpointsFileError("no such number", file="s.csv", line=3, key="x", got="two")
    if item == 2:
        raise ZeroDivisionError("by item 2")
    return item


def begun(folder, item="*"):
    return sorted(Path(folder).glob(f"{item}.*.*"))


@pytest.fixture(scope="module")
def two_workers():
    pytest.importorskip("distributed", reason="Dask is not installed")
    with open_executor(workers=2) as executor:
        yield executor


@pytest.fixture
def two_to_lose():
    """Two workers for one test: what is still being replaced when it ends is in nobody's way."""
    pytest.importorskip("distributed", reason="Dask is not installed")
    with open_executor(workers=2) as executor:
        yield executor


# --- the same everywhere ----------------------------------------------------------------------------------------------

SHARED = Shared(np.arange(4.0))
ITEMS = [0.5, 2.0, -1.0, 0.1, 7.0, 3.0, 1e-9]


def results(executor, function=weigh, shared=SHARED, items=ITEMS):
    pairs = list(executor.run(function, shared, items))
    assert sorted(index for index, _ in pairs) == list(range(len(items)))
    return [result for _, result in sorted(pairs, key=lambda pair: pair[0])]


def test_in_this_process():
    with open_executor() as executor:
        assert isinstance(executor, InProcess)
        np.testing.assert_array_equal(results(executor), [SHARED.weights * item for item in ITEMS])


@pytest.mark.parametrize("workers", [1, 3])
def test_a_cluster_gives_the_same(workers):
    pytest.importorskip("distributed", reason="Dask is not installed")
    with open_executor(workers=workers) as executor:
        np.testing.assert_array_equal(results(executor), results(InProcess()))
        processes = {pid for _, (_, pid) in executor.run(own_process, None, range(20))}
    assert_ended(processes)


def test_a_cluster_runs_several_jobs(two_workers):
    np.testing.assert_array_equal(results(two_workers), results(InProcess()))
    assert list(two_workers.run(weigh, SHARED, [])) == []
    np.testing.assert_array_equal(results(two_workers, items=[1.0]), [SHARED.weights])


def test_what_is_common_travels_once_to_each_worker(two_workers):
    class Counted:
        """Counts how often it is packed for a journey."""

        packed = 0

        def __reduce__(self):
            Counted.packed += 1
            return (float, (2.0,))

    assert results(two_workers, lambda factor, item: factor * item, Counted(), list(range(20))) == [
        2.0 * k for k in range(20)
    ]
    assert Counted.packed == 1


# --- bounded in flight ------------------------------------------------------------------------------------------------


class Watched:
    """A sequence that knows how much of it was asked for."""

    def __init__(self, length):
        self.length, self.taken = length, 0

    def __len__(self):
        return self.length

    def __getitem__(self, index):
        self.taken += 1
        return index


def test_no_more_is_sent_than_the_workers_are_ready_for(two_workers):
    items = Watched(10**6)
    stream = two_workers.run(lambda _, item: item, None, items)
    seen = {next(stream)[0] for _ in range(20)}
    assert len(seen) == 20
    assert items.taken <= 20 + 2 * 2, "two for each worker are under way"
    time.sleep(0.5)
    assert items.taken <= 20 + 2 * 2, "nobody took a result meanwhile"
    stream.close()
    np.testing.assert_array_equal(results(two_workers), results(InProcess()))


# --- lost workers -----------------------------------------------------------------------------------------------------


def test_a_lost_worker_costs_its_chunk_only(two_to_lose, tmp_path):
    shared = Shared(np.zeros(1), str(tmp_path))
    stream = two_to_lose.run(hold_item_3, shared, list(range(8)))
    pairs = [next(stream) for _ in range(7)]
    assert 3 not in dict(pairs)
    (held,) = begun(tmp_path, 3)
    os.kill(int(held.name.split(".")[1]), signal.SIGKILL)
    deadline = time.monotonic() + PATIENCE_S
    while len(begun(tmp_path, 3)) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    (tmp_path / "go").touch()
    assert dict([*pairs, *stream]) == {k: 10 * k for k in range(8)}
    assert [len(begun(tmp_path, k)) for k in range(8)] == [1, 1, 1, 2, 1, 1, 1, 1]


def test_an_item_that_kills_its_workers_is_named_when_all_others_are_done(two_to_lose, tmp_path):
    shared, done = Shared(np.zeros(1), str(tmp_path)), []
    with pytest.raises(ViewgaugeError, match=r"item 2 of 6 \(2\) ended the worker process"):
        done.extend(index for index, _ in two_to_lose.run(end_own_process, shared, list(range(6))))
    assert sorted(done) == [0, 1, 3, 4, 5]
    np.testing.assert_array_equal(results(two_to_lose), results(InProcess()))


def own_process(_, item):
    return item, os.getpid()


def test_a_job_begins_while_a_worker_is_being_lost(two_to_lose):
    for _ in range(3):
        _, (_, process) = next(two_to_lose.run(own_process, None, [0]))
        time.sleep(0.5)  # as in end_this_process
        os.kill(process, signal.SIGKILL)  # the scheduler learns of it later
        np.testing.assert_array_equal(results(two_to_lose), results(InProcess()))


def end_own_process_from_1_on(_, item):
    if item > 0:
        end_this_process()
    return item


def test_where_all_items_kill_their_workers_not_all_are_tried_to_the_end(two_to_lose):
    with pytest.raises(ViewgaugeError, match=r"ended the worker process each time it was tried; so did 2 others"):
        list(two_to_lose.run(end_own_process_from_1_on, None, list(range(6))))


@dataclass(frozen=True)
class Written:
    """A table of two columns that workers fill."""

    writer: object
    folder: str


def write_chunk(written, chunk):
    leave_trace(written, chunk)
    if chunk == 3 and len(begun(written.folder, 3)) == 1:
        end_this_process()
    viewpoints = written.writer.layout.viewpoints(chunk)
    values = np.sin(np.arange(viewpoints.start, viewpoints.stop)[:, None] * np.arange(1, 8))
    written.writer.write(viewpoints.start, {"sine": values, "positive": values > 0}, {"chunk": chunk})
    return chunk


def test_workers_write_a_table_and_a_lost_one_leaves_no_trace_in_it(two_to_lose, tmp_path):
    pytest.importorskip("zarr")
    from viewgauge.formats.tables.table_store import Column, TableLayout, open_table

    columns = (Column("sine"), Column("positive", "flag"))
    layout = TableLayout([f"S{k}" for k in range(50)], [f"d{k}" for k in range(7)], columns, 5)
    for name, executor in (("here", InProcess()), ("there", two_to_lose)):
        (tmp_path / name).mkdir()
        (tmp_path / name / ("x" if executor is two_to_lose else "3.0.0")).touch()  # as if begun before: not killed here
        with open_table(tmp_path / f"{name}.zarr", layout, "job") as store:
            written = Written(store.writer(), str(tmp_path / name))
            assert sorted(chunk for _, chunk in executor.run(write_chunk, written, range(10))) == list(range(10))
    assert len(begun(tmp_path / "there", 3)) == 2
    here, there = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        for folder in (tmp_path / "here.zarr", tmp_path / "there.zarr")
    )
    assert here == there


# --- exceptions -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("where", ["here", "cluster"])
def test_an_error_of_the_function_is_raised_as_it_is(where, request, tmp_path):
    executor = InProcess() if where == "here" else request.getfixturevalue("two_workers")
    shared = Shared(np.zeros(1), str(tmp_path))
    with pytest.raises(ViewpointsFileError) as caught:
        list(executor.run(refuse, shared, [0, 1, *range(3, 100)]))
    assert str(caught.value) == "s.csv:3:x: no such number\n  got:      two"
    assert (caught.value.file, caught.value.line, caught.value.key) == ("s.csv", 3, "x")
    assert not caught.value.__cause__
    assert len(begun(tmp_path)) < 20, "what was waiting is not begun"
    with pytest.raises(ZeroDivisionError, match="by item 2"):
        list(executor.run(refuse, shared, [0, 2]))


def test_the_processes_end_with_the_block_however_it_ends():
    pytest.importorskip("distributed", reason="Dask is not installed")

    def fail(error):
        with open_executor(workers=1) as executor:
            processes.append(next(executor.run(own_process, None, [0]))[1][1])
            raise error

    processes = []
    for error in (KeyboardInterrupt, ZeroDivisionError):
        with pytest.raises(error):
            fail(error)
        assert_ended(processes)


def assert_ended(processes):
    """Not a look at all children: a cluster that other tests share may be replacing a worker."""
    import psutil

    assert processes
    deadline = time.monotonic() + PATIENCE_S
    while any(psutil.pid_exists(pid) for pid in processes):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_an_interrupt_from_the_keyboard_ends_all_without_a_word(tmp_path):
    pytest.importorskip("distributed", reason="Dask is not installed")
    script = tmp_path / "job.py"
    script.write_text(
        "import signal, time\n"
        "from viewgauge.execution.executor import open_executor\n"
        "def slow(_, item):\n"
        "    time.sleep(item)\n"
        "if __name__ == '__main__':\n"
        "    signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a test run in the background ignores it
        "    try:\n"
        "        with open_executor(workers=1) as executor:\n"
        "            for _ in executor.run(slow, None, [0, 60]):\n"
        "                print('begun', flush=True)\n"
        "    except KeyboardInterrupt:\n"
        "        print('interrupted', flush=True)\n"
    )
    job = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    assert job.stdout.readline() == "begun\n"
    os.killpg(job.pid, signal.SIGINT)  # as the terminal does: to the workers too
    out, err = job.communicate(timeout=PATIENCE_S)
    assert (job.returncode, out, err) == (0, "interrupted\n", "")
    assert_ends(job.pid)


def test_an_interrupt_inside_dask_is_not_lost():
    pytest.importorskip("distributed", reason="Dask is not installed")
    from viewgauge.execution.interrupts import interrupts_afterwards

    class Ended:
        """What is raised in a destructor is told on the error stream and forgotten."""

        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    def work():
        with interrupts_afterwards():
            Ended()
            reached.append(True)

    reached, before = [], signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
        assert reached
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)


def assert_ends(group):
    """All processes of a group end within a while."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    raise AssertionError("processes are left")


# --- what a user can get wrong ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("workers", [0, -1, 1.5, True])
def test_a_number_of_workers(workers):
    with pytest.raises(InputError, match="a whole number from 1"), open_executor(workers=workers):
        pass


def test_a_scheduler_or_workers():
    with pytest.raises(InputError, match="exclude each other"), open_executor("tcp://127.0.0.1:8786", 2):
        pass


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:9", "127.0.0.1", "tcp://127.0.0.1:99999", "http://127.0.0.1:80", "nonsense", ""]
)
def test_a_scheduler_that_is_not_there(address):
    pytest.importorskip("distributed", reason="Dask is not installed")
    with pytest.raises(InputError, match="the scheduler cannot be reached") as caught, open_executor(address):
        pass
    assert "dask scheduler" in caught.value.hint


def test_without_dask(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "viewgauge.execution.cluster", raising=False)
    monkeypatch.delattr("viewgauge.execution.cluster", raising=False)
    with pytest.raises(InputError, match=r"viewgauge\[distributed\]"), open_executor(workers=1):
        pass


# --- a scheduler elsewhere --------------------------------------------------------------------------------------------


@contextmanager
def running(*arguments):
    process = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])},
    )
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@contextmanager
def scheduler_elsewhere(tmp_path):
    pytest.importorskip("distributed", reason="Dask is not installed")
    import json

    file = tmp_path / "scheduler.json"
    options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    with running("dask_scheduler", *options) as process:
        wait_for(file)
        deadline = time.monotonic() + PATIENCE_S
        while not (text := file.read_text()).rstrip().endswith("}"):  # made, and then written
            assert time.monotonic() < deadline
            time.sleep(0.01)
        yield json.loads(text)["address"], process


def worker_for(address):
    return running("dask_worker", address, "--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--no-nanny")


def test_a_worker_that_joins_later_takes_part(tmp_path):
    shared = Shared(np.zeros(1), str(tmp_path))
    with scheduler_elsewhere(tmp_path) as (address, _), worker_for(address), open_executor(address) as executor:
        stream = executor.run(hold_item_3, shared, list(range(100)))
        first = [next(stream) for _ in range(3)]
        wait_for_trace(tmp_path, 3)
        with worker_for(address):  # the other one is held
            rest = []
            for pair in stream:
                rest.append(pair)
                if len(rest) == 10:
                    (tmp_path / "go").touch()
            assert dict([*first, *rest]) == {k: 10 * k for k in range(100)}
    assert len({path.name.split(".")[1] for path in begun(tmp_path)}) == 2


def wait_for_trace(folder, item):
    deadline = time.monotonic() + PATIENCE_S
    while not begun(folder, item):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_scheduler_without_workers_and_one_that_is_lost(tmp_path, monkeypatch):
    with scheduler_elsewhere(tmp_path) as (address, process):
        from viewgauge.execution import cluster

        with monkeypatch.context() as impatient:
            impatient.setattr(cluster, "_FIRST_WORKER_S", 0.2)
            with pytest.raises(InputError, match="no workers") as caught, open_executor(address):
                pass
        assert f"dask worker {address}" in caught.value.hint
        with worker_for(address), open_executor(address) as executor:
            stream = executor.run(weigh, SHARED, list(range(10**6)))
            next(stream)
            os.killpg(process.pid, signal.SIGKILL)
            with pytest.raises(ViewgaugeError, match="the connection to the Dask scheduler is lost"):
                list(stream)


def test_all_parts_have_the_same_version(tmp_path, monkeypatch):
    with scheduler_elsewhere(tmp_path) as (address, _), worker_for(address):
        from viewgauge.execution import cluster

        monkeypatch.setattr(cluster, "own_version", lambda: "99.0")
        with pytest.raises(InputError, match="the same version") as caught, open_executor(address):
            pass
        assert caught.value.expected == "99.0, as here"
