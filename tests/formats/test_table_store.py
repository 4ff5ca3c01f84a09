"""Tables written chunk by chunk: the formats, the order, and jobs that are killed and go on."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from viewgauge.exceptions import InputError
from viewgauge.formats.tables.table_store import Column, TableLayout, open_table
from viewgauge.formats.tables.whole_table import write_table

REASONS = ("out_of_view", 'a "quoted", name', "ünder", "")
COLUMNS = (
    Column("visible", "flag"),
    Column("reason", "name", REASONS),
    Column("probability"),
    Column("measurand", "whole", in_rows=False),
    Column("accepted", "flag"),
    Column("validity", "name", ("",)),
    Column("angle_rad"),
    Column("count", "whole"),
)


def layout(viewpoints=23, characteristics=5, chunk_viewpoints=4):
    return TableLayout(
        ["S,1", 'S"2', "", *(f"S{k}" for k in range(3, viewpoints))][:viewpoints],
        [f"dim {k}" for k in range(characteristics)],
        COLUMNS,
        chunk_viewpoints,
        {"nominal_mm": np.arange(characteristics) + 0.1, "allowed_error_mm": np.full(characteristics, 1e-3)},
        {"method": "joint", "required_probability": 0.95},
    )


def whole(of):
    """All values of a table; some are NaN, infinite or zero, and some chunks are all the same."""
    shape = (len(of.viewpoint_ids), len(of.characteristic_ids))
    rng = np.random.default_rng(5)
    visible = rng.random(shape) < 0.5
    visible[:4] = False
    angle = np.where(visible, rng.normal(size=shape) * 10.0 ** rng.integers(-12, 12, shape), np.nan)
    angle.ravel()[-3:] = [np.inf, -np.inf, -0.0][: angle.size]
    return {
        "visible": visible,
        "reason": np.where(visible, 3, rng.integers(0, 3, shape)).astype(np.int8),
        "probability": np.where(visible, rng.random(shape), 0.0),
        "measurand": rng.integers(0, 9, shape),
        "accepted": visible & (rng.random(shape) < 0.5),
        "validity": np.zeros(shape, dtype=np.uint8),
        "angle_rad": angle,
        "count": rng.integers(-5, 10**12, shape),
    }


def part(of, values, chunk):
    return of.viewpoints(chunk).start, {name: array[of.viewpoints(chunk)] for name, array in values.items()}


def write(path, of, order=None, **options):
    values = whole(of)
    with open_table(path, of, **options) as store:
        for chunk in range(of.chunks) if order is None else order:
            store.write(*part(of, values, chunk))


def dataset(of):
    """The same as a dataset in memory."""
    xr = pytest.importorskip("xarray")
    values, over = whole(of), ("viewpoint", "characteristic")
    texts = {c.name: np.array(c.names, dtype=object)[values[c.name]] for c in COLUMNS if c.kind == "name"}
    return xr.Dataset(
        {name: (over, array) for name, array in {**values, **texts}.items()},
        coords={
            "viewpoint": ("viewpoint", list(of.viewpoint_ids)),
            "characteristic": ("characteristic", list(of.characteristic_ids)),
            **{name: ("characteristic", array) for name, array in of.coordinates.items()},
        },
        attrs=dict(of.attrs),
    )


def rows(of):
    names = [column.name for column in of.row_columns]
    frame = dataset(of)[names].to_dataframe(dim_order=["viewpoint", "characteristic"]).reset_index()
    return frame[["viewpoint", "characteristic", *names]]


def tree(folder):
    """Each file of a folder with its bytes."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


# --- formats: what pandas and xarray write of the same values ---------------------------------------------------------


@pytest.mark.parametrize("chunk_viewpoints", [1, 4, 23, 100])
def test_csv_is_that_of_pandas_to_the_byte(tmp_path, chunk_viewpoints):
    of = layout(chunk_viewpoints=chunk_viewpoints)
    write(tmp_path / "t.csv", of)
    rows(of).to_csv(tmp_path / "expected.csv", index=False, lineterminator="\n")
    assert (tmp_path / "t.csv").read_bytes() == (tmp_path / "expected.csv").read_bytes()


def test_parquet_reads_like_that_of_pandas(tmp_path):
    pytest.importorskip("pyarrow")
    import pandas as pd

    of = layout()
    write(tmp_path / "t.parquet", of)
    rows(of).to_parquet(tmp_path / "expected.parquet", index=False)
    read, expected = (pd.read_parquet(tmp_path / name) for name in ("t.parquet", "expected.parquet"))
    pd.testing.assert_frame_equal(read, expected, check_exact=True)


def test_zarr_reads_like_that_of_xarray(tmp_path):
    pytest.importorskip("zarr")
    import xarray as xr

    of = layout()
    write(tmp_path / "t.zarr", of)
    expected = dataset(of)
    for name in ("reason", "validity"):
        expected[name] = expected[name].astype(str)
    expected.to_zarr(tmp_path / "expected.zarr", consolidated=False, zarr_format=2)
    read, expected = (xr.load_dataset(tmp_path / name, consolidated=False) for name in ("t.zarr", "expected.zarr"))
    xr.testing.assert_identical(read, expected)
    for name in read.data_vars:
        assert read[name].dtype.kind == expected[name].dtype.kind, name


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
def test_a_dataset_is_written_like_its_chunks(tmp_path, suffix, monkeypatch):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    monkeypatch.setattr("viewgauge.formats.tables.whole_table._PAIRS_PER_CHUNK", 20)
    of = layout()
    write(tmp_path / f"a{suffix}", of)
    write_table(dataset(of), tmp_path / f"b{suffix}", [column.name for column in of.row_columns])
    if suffix == ".zarr":
        import xarray as xr

        xr.testing.assert_identical(*(xr.load_dataset(tmp_path / f"{n}.zarr", consolidated=False) for n in "ab"))
    else:
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
def test_tables_without_rows(tmp_path, suffix):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    for of in (layout(viewpoints=0), layout(characteristics=0)):
        write(tmp_path / f"t{suffix}", of)
        assert (tmp_path / f"t{suffix}").exists()


# --- complete or absent, in any order ---------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
def test_chunks_come_in_any_order(tmp_path, suffix):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    of = layout()
    write(tmp_path / f"a{suffix}", of)
    for name, order in (("b", [5, 4, 3, 2, 1, 0]), ("c", [2, 0, 5, 1, 4, 3])):
        write(tmp_path / f"{name}{suffix}", of, order)
        if suffix == ".zarr":
            assert tree(tmp_path / f"{name}.zarr") == tree(tmp_path / "a.zarr")
        else:
            assert (tmp_path / f"{name}{suffix}").read_bytes() == (tmp_path / f"a{suffix}").read_bytes()
    assert sorted(os.listdir(tmp_path)) == [f"{name}{suffix}" for name in "abc"]


def test_early_chunks_wait_on_the_disk(tmp_path):
    of, values = layout(), whole(layout())
    with open_table(tmp_path / "t.csv", of) as store:
        for chunk in (5, 4, 2):
            store.write(*part(of, values, chunk))
        assert sorted(path.name for path in tmp_path.rglob("*.npz")) == ["2.npz", "4.npz", "5.npz"]
        for chunk in (0, 1):
            store.write(*part(of, values, chunk))
        assert sorted(path.name for path in tmp_path.rglob("*.npz")) == ["4.npz", "5.npz"]
        store.write(*part(of, values, 3))


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError])
def test_a_failure_leaves_what_was_there(tmp_path, suffix, error):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    of, values = layout(), whole(layout())
    path = tmp_path / f"t{suffix}"

    def fail():
        with open_table(path, of) as store:
            store.write(*part(of, values, 0))
            store.write(*part(of, values, 2))
            raise error

    for left in ([], [path.name]):
        with pytest.raises(error):
            fail()
        assert os.listdir(tmp_path) == left
        write(path, of)


@pytest.mark.parametrize("suffix", [".csv", ".zarr"])
def test_errors_of_the_program(tmp_path, suffix):
    if suffix == ".zarr":
        pytest.importorskip("zarr")
    of, path = layout(), tmp_path / f"t{suffix}"
    with pytest.raises(ValueError, match="missing"):
        write(path, of, [0, 1])
    with (
        pytest.raises(ValueError, match="no chunk of 4 viewpoints begins with viewpoint 3"),
        open_table(path, of) as store,
    ):
        store.write(3, {})
    with pytest.raises(ValueError, match=r"column visible of chunk 5: shape \(4, 5\)"), open_table(path, of) as store:
        store.write(20, part(of, whole(of), 0)[1])
    if suffix == ".csv":
        with pytest.raises(ValueError, match="chunk 1 was written before"):
            write(path, of, [1, 1])
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
def test_unwritable_places(tmp_path, suffix):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    with pytest.raises(InputError, match="create the folder"):
        open_table(tmp_path / "none" / f"t{suffix}", layout())
    (tmp_path / f"t{suffix}").mkdir() if suffix != ".zarr" else (tmp_path / "t.zarr").write_text("")
    with pytest.raises(InputError, match="give another path"):
        write(tmp_path / f"t{suffix}", layout())
    with pytest.raises(InputError, match="is not known"):
        open_table(tmp_path / "t.xlsx", layout())
    assert os.listdir(tmp_path) == [f"t{suffix}"]


@pytest.mark.parametrize(("suffix", "library"), [(".zarr", "zarr"), (".parquet", "pyarrow")])
def test_a_missing_library_is_named(tmp_path, monkeypatch, suffix, library):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(InputError, match=f"needs {library}") as caught:
        open_table(tmp_path / f"t{suffix}", layout())
    assert "viewgauge[tables]" in caught.value.hint
    assert os.listdir(tmp_path) == []


def test_csv_goes_to_a_device():
    command = [sys.executable, "-c", WRITE_TO_STDOUT]
    out = subprocess.run(command, stdout=subprocess.PIPE, check=True, cwd=Path(__file__).parent).stdout
    assert out.startswith(b"viewpoint,characteristic,visible,")
    assert out.count(b"\n") == 1 + 23 * 5


WRITE_TO_STDOUT = """
import os, tempfile
from test_table_store import layout, write
with tempfile.TemporaryDirectory() as folder:
    os.symlink("/dev/stdout", folder + "/t.csv")
    write(folder + "/t.csv", layout(), [1, 0, 2, 3, 5, 4])
"""


# --- Zarr: several processes, jobs that go on -------------------------------------------------------------------------


def test_what_is_done_is_reported_and_need_not_be_written_again(tmp_path):
    pytest.importorskip("zarr")
    of, values, path = layout(), whole(layout()), tmp_path / "t.zarr"
    write(tmp_path / "once.zarr", of)

    def begin(fingerprint, chunks):
        with open_table(path, of, fingerprint) as store:
            done = dict(store.done)
            for chunk in chunks:
                store.write(*part(of, values, chunk), {"best": [chunk, None]})
            raise KeyboardInterrupt
        return done

    for chunks in ((3, 0), (1,)):
        with pytest.raises(KeyboardInterrupt):
            begin("job", chunks)
        assert not path.exists()
    with open_table(path, of, "job") as store:
        assert store.done == {k: {"best": [k, None]} for k in (0, 1, 3)}
        for chunk in (2, 4, 5):
            store.write(*part(of, values, chunk))
    assert tree(path) == tree(tmp_path / "once.zarr")
    assert sorted(os.listdir(tmp_path)) == ["once.zarr", "t.zarr"]
    # another job begins with nothing
    with pytest.raises(KeyboardInterrupt):
        begin("job", (3, 0))
    with open_table(path, of, "other job") as store:
        assert store.done == {}
        for chunk in range(6):
            store.write(*part(of, values, chunk))
    assert tree(path) == tree(tmp_path / "once.zarr")


def test_several_processes_write_each_their_chunks(tmp_path):
    pytest.importorskip("zarr")
    of = layout(viewpoints=40)
    write(tmp_path / "once.zarr", of)
    with open_table(tmp_path / "t.zarr", of, "job") as store:
        packed = pickle.dumps(store.writer())
        assert b"S17" not in packed, "workers need no ids"
        command = [sys.executable, "-c", WRITE_EACH_THIRD]
        workers = [
            subprocess.Popen([*command, str(k)], stdin=subprocess.PIPE, cwd=Path(__file__).parent) for k in range(3)
        ]
        for worker in workers:
            worker.stdin.write(packed)
            worker.stdin.close()
        assert [worker.wait() for worker in workers] == [0, 0, 0]
    assert tree(tmp_path / "t.zarr") == tree(tmp_path / "once.zarr")


WRITE_EACH_THIRD = """
import pickle, sys
from test_table_store import layout, part, whole
writer = pickle.load(sys.stdin.buffer)
of = layout(viewpoints=40)
for chunk in range(int(sys.argv[1]), of.chunks, 3):
    writer.write(*part(of, whole(of), chunk), {"by": sys.argv[1]})
"""

JOB = """
import sys, time
from test_table_store import layout, part, whole
from viewgauge.formats.tables.table_store import open_table
of = layout(viewpoints=100)
values = whole(of)
print("begins", flush=True)
with open_table(sys.argv[1], of, "job") as store:
    print("done", len(store.done), flush=True)
    for chunk in reversed(range(of.chunks)):
        if chunk not in store.done:
            store.write(*part(of, values, chunk), {"chunk": chunk})
            print("wrote", chunk, flush=True)
print("finished", flush=True)
"""


def test_a_job_that_is_killed_again_and_again_gives_the_same_bytes(tmp_path):
    pytest.importorskip("zarr")
    of = layout(viewpoints=100)
    write(tmp_path / "once.zarr", of)
    path, done, rng = tmp_path / "t.zarr", [], np.random.default_rng(6)

    def run(lines, delay_s):
        """Run until so many lines are told and then a moment longer; whether it has finished."""
        command = [sys.executable, "-c", JOB, str(path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parent) as job:
            reported = [job.stdout.readline() for _ in range(lines)]
            try:
                job.wait(delay_s)
            except subprocess.TimeoutExpired:
                os.kill(job.pid, signal.SIGKILL)
            reported += job.stdout.readlines()
        done.extend(int(line.split()[1]) for line in reported if line.startswith("done"))
        return "finished\n" in reported

    # killed while the table is begun, in the midst of chunks, and a hair before or after the end
    for lines in (1, 2, 4, 9, 3, 6, 2):
        assert not run(lines, rng.uniform(0, 0.01))
        assert not path.exists()
    assert done == sorted(done), "nothing is lost"
    assert done[-1] > 10
    assert run(1, 60)
    assert tree(path) == tree(tmp_path / "once.zarr")
    assert sorted(os.listdir(tmp_path)) == ["once.zarr", "t.zarr"]


def test_what_a_killed_writer_left_is_not_in_the_table(tmp_path):
    pytest.importorskip("zarr")
    of, values = layout(), whole(layout())
    write(tmp_path / "once.zarr", of)
    with open_table(tmp_path / "t.zarr", of, "job") as store:
        (table,) = tmp_path.glob(".t.zarr.partial/*/table")
        (table / "reason" / "0.5c0ffee.partial").write_text("half")
        (table / ".zattrs.tmp").write_text("half")
        for chunk in range(of.chunks):
            store.write(*part(of, values, chunk))
    assert tree(tmp_path / "t.zarr") == tree(tmp_path / "once.zarr")


def test_a_table_that_another_process_writes_is_refused(tmp_path):
    pytest.importorskip("zarr")
    pytest.importorskip("fcntl", reason="a POSIX system")
    of, values = layout(), whole(layout())
    with open_table(tmp_path / "t.zarr", of, "job") as store:
        with pytest.raises(InputError, match=r"t\.zarr: another process is writing this"):
            open_table(tmp_path / "t.zarr", of, "job")
        for chunk in range(of.chunks):
            store.write(*part(of, values, chunk))
    assert os.listdir(tmp_path) == ["t.zarr"]
