"""A journal keeps what is done, of its own job, and lets one process in at a time."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from viewgauge.exceptions import InputError
from viewgauge.formats.files.journal import ChunkJournal, read_entry, record_entry


def entries(journal):
    return {chunk: read_entry(path) for chunk, path in journal.done().items()}


def test_what_was_recorded_is_there_again(tmp_path):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        assert journal.done() == {}
        journal.record(7, costs=np.arange(3.0), names=np.array(["ü", ""]))
        record_entry(journal.job, 0, n=5)
    with ChunkJournal(tmp_path / "j", "job") as journal:
        assert list(journal.done()) == [0, 7]
        np.testing.assert_array_equal(entries(journal)[7]["costs"], [0, 1, 2])
        assert entries(journal)[7]["names"].tolist() == ["ü", ""]
        assert entries(journal)[0]["n"] == 5
        journal.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_chunk_is_recorded_anew(tmp_path):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        journal.record(1, n=1)
        journal.record(1, n=2)
        assert entries(journal)[1]["n"] == 2


def test_another_job_starts_from_nothing_and_late_workers_of_the_first_do_no_harm(tmp_path):
    with ChunkJournal(tmp_path / "j", "first") as journal:
        journal.record(1, n=1)
        late = journal.job
    with ChunkJournal(tmp_path / "j", "second") as journal:
        assert journal.done() == {}
        with pytest.raises(FileNotFoundError):
            record_entry(late, 2, n=2)
        assert journal.done() == {}
    with ChunkJournal(tmp_path / "j", "first") as journal:
        assert journal.done() == {}


@pytest.mark.parametrize("length", [0, 1, 30, 200, -1])
def test_a_torn_entry_counts_as_not_done(tmp_path, length):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        journal.record(1, n=np.arange(100))
        journal.record(2, n=2)
        whole = journal.done()[1].read_bytes()
        journal.done()[1].write_bytes(whole[:length])
        assert list(journal.done()) == [2]


def test_a_changed_entry_counts_as_not_done(tmp_path):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        journal.record(1, n=np.arange(100))
        content = bytearray(journal.done()[1].read_bytes())
        content[500] ^= 1
        journal.done()[1].write_bytes(content)
        assert journal.done() == {}


def test_strange_files_are_no_entries(tmp_path):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        for name in ("x.npz", ".7", "8", "9.txt"):
            (journal.job / "done" / name).write_text("")
        assert journal.done() == {}


def test_a_failed_recording_leaves_nothing(tmp_path, monkeypatch):
    with ChunkJournal(tmp_path / "j", "job") as journal:
        with pytest.raises(ValueError, match="no objects"):
            journal.record(1, n=np.array([object()]))
        monkeypatch.setattr("os.replace", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            journal.record(1, n=1)
        assert journal.done() == {}
        assert list((journal.job / "done").iterdir()) == []


HOLD = """
import sys, time
from viewgauge.formats.files.journal import ChunkJournal
journal = ChunkJournal(sys.argv[1], "job", target="table.zarr")
journal.record(1, n=1)
print("held", flush=True)
time.sleep(60)
"""


def test_one_process_at_a_time(tmp_path):
    pytest.importorskip("fcntl", reason="a POSIX system")
    command = [sys.executable, "-c", HOLD, str(tmp_path / "j")]
    holder = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(InputError, match="another process is writing this") as caught:
            ChunkJournal(tmp_path / "j", "other job", target="table.zarr")
        assert caught.value.file == "table.zarr"
        assert f"process {holder.pid} on " in caught.value.got
    finally:
        os.kill(holder.pid, signal.SIGKILL)
        holder.wait()
        holder.stdout.close()
    with ChunkJournal(tmp_path / "j", "job") as journal:  # the dead one's lock holds nobody up
        assert list(journal.done()) == [1]


def test_a_process_does_not_open_it_twice(tmp_path):
    pytest.importorskip("fcntl", reason="a POSIX system")
    with ChunkJournal(tmp_path / "j", "job"), pytest.raises(InputError, match="another process"):
        ChunkJournal(tmp_path / "j", "job")


@pytest.mark.parametrize(("place", "hint"), [("none/j", "create the folder"), ("file/j", "is a file, not a folder")])
def test_unwritable_places(tmp_path, place, hint):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError) as caught:
        ChunkJournal(tmp_path / place, "job")
    assert hint in caught.value.hint
