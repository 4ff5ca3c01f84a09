"""Long jobs in chunks: the same bytes wherever and in whatever pieces they run, and whichever worker is lost."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from long_jobs import grid, plan_bytes, tree, write_inspection

import viewgauge as vg
from viewgauge.evaluation import COLUMNS
from viewgauge.evaluation.segment import image_segment
from viewgauge.exceptions import InputError, ViewgaugeError
from viewgauge.execution.chunks import VIEWPOINTS_PER_CHUNK
from viewgauge.execution.executor import InProcess, open_executor
from viewgauge.formats.poses.viewpoints_file import write_viewpoints
from viewgauge.geometry import invert, transform
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.planning.cover.minimum_cover import DEFAULT_TIME_LIMIT_S
from viewgauge.planning.inspection import ExplicitViewpoints
from viewgauge.visibility import REASONS


@pytest.fixture(scope="module")
def inspection(tmp_path_factory):
    return write_inspection(tmp_path_factory.mktemp("inspection"))


@pytest.fixture(scope="module")
def poses(inspection):
    sampled = grid(inspection)
    return sampled.poses(0, len(sampled))


@pytest.fixture(scope="module")
def executors():
    """By number of workers, 0 for this process."""
    pytest.importorskip("distributed", reason="Dask is not installed")
    with open_executor(workers=1) as one, open_executor(workers=2) as two, open_executor(workers=3) as three:
        yield {0: InProcess(), 1: one, 2: two, 3: three}


def content(path):
    return tree(path) if Path(path).is_dir() else Path(path).read_bytes()


# --- the same everywhere: tables --------------------------------------------------------------------------------------

CASES = [("joint", 1, 24), ("joint", 7, 100), ("joint", 256, 600), ("joint", 1000, 600), ("independent", 40, 150)]


@pytest.mark.parametrize(("method", "chunk", "viewpoints"), [*CASES, ("monte-carlo", 2, 5)])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".zarr"])
def test_a_table_is_the_same_wherever_it_is_made(
    inspection, poses, executors, tmp_path, method, chunk, viewpoints, suffix
):
    pytest.importorskip("zarr" if suffix == ".zarr" else "pyarrow")
    options = {"method": method, "precision": 0.01}
    some = poses[17 : 17 + viewpoints]
    expected = vg.evaluate(inspection, some, **options)
    found = []
    for workers, executor in executors.items():
        path = tmp_path / f"{workers}{suffix}"
        found.append(vg.evaluate_into(inspection, path, some, executor=executor, viewpoints_per_chunk=chunk, **options))
        assert content(path) == content(tmp_path / f"0{suffix}"), workers
        assert found[-1].best_of_each() == found[0].best_of_each()
    assert sorted(os.listdir(tmp_path)) == [f"{workers}{suffix}" for workers in (0, 1, 2, 3)]
    assert_equal_columns(read(tmp_path / f"0{suffix}"), expected, suffix)
    assert_best(found[0], expected)


def read(path):
    """Columns by name, flat."""
    if path.suffix == ".zarr":
        import xarray as xr

        with xr.open_zarr(path, consolidated=False) as table:
            return {name: table[name].values.ravel() for name in table.data_vars}
    import pandas as pd

    rows = pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path, keep_default_na=False)
    return {name: rows[name].to_numpy() for name in rows.columns[2:]}


def assert_equal_columns(got, expected, suffix):
    names = set(expected.data_vars) - (set() if suffix == ".zarr" else {"measurand"})
    assert set(got) == names
    for name in names:
        whole = expected[name].values.ravel()
        if whole.dtype == float:
            if got[name].dtype == object:  # an empty cell is NaN
                got[name] = np.array([float(cell) if cell != "" else np.nan for cell in got[name]])
            np.testing.assert_allclose(got[name], whole, rtol=0, atol=1e-12, err_msg=name)
        else:
            assert got[name].tolist() == whole.tolist(), name


def assert_best(evaluation, table):
    """What is left of a streamed table is what a look at the whole one gives: visible, most probable, most accurate,
    first.
    """
    assert evaluation.viewpoints == table.sizes["viewpoint"]
    for name, row in evaluation.best_of_each().items():
        column = table.sel(characteristic=name)
        rank = np.lexsort((-column["expected_accuracy"], -column["probability"], ~column["visible"]))
        best = column.isel(viewpoint=int(rank[0]))
        for key in ("visible", "accepted"):
            assert row[key] == bool(best[key])
        assert row["probability"] == pytest.approx(float(best["probability"]), abs=1e-12)
        if row["visible"]:
            assert row["viewpoint"] == str(best["viewpoint"].values)


@pytest.mark.parametrize("method", ["joint", "independent"])
def test_pieces_do_not_show_in_the_values(inspection, poses, tmp_path, method):
    pytest.importorskip("pyarrow")
    tables = []
    for chunk in (1, 7, 256, 1000):
        path = tmp_path / f"{chunk}.parquet"
        vg.evaluate_into(inspection, path, poses[:300], method=method, viewpoints_per_chunk=chunk)
        tables.append(read(path))
    for other in tables[1:]:
        for name, values in tables[0].items():
            if values.dtype == float:
                np.testing.assert_allclose(other[name], values, rtol=0, atol=1e-12, err_msg=name)
            else:
                assert other[name].tolist() == values.tolist(), name


def test_sampled_candidates_are_those_of_the_grid(inspection, poses, tmp_path):
    pytest.importorskip("zarr")
    import xarray as xr

    evaluation = vg.evaluate_into(inspection, tmp_path / "t.zarr", sampled=True, viewpoints_per_chunk=100)
    assert evaluation.viewpoints == len(poses)
    table = xr.open_zarr(tmp_path / "t.zarr", consolidated=False).load()
    assert table["viewpoint"].values.tolist() == [f"C{k}" for k in range(1, len(poses) + 1)]
    expected = vg.evaluate(inspection, poses)
    np.testing.assert_allclose(table["probability"].values, expected["probability"].values, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(table["reason"].values, expected["reason"].values)
    nothing_written = vg.evaluate_into(inspection, None, sampled=True, viewpoints_per_chunk=77)
    assert nothing_written.best_of_each() == evaluation.best_of_each()


def test_only_the_columns_asked_for(inspection, poses, tmp_path):
    pytest.importorskip("zarr")
    import xarray as xr

    vg.evaluate_into(inspection, tmp_path / "t.zarr", poses[:20], columns=["accepted", "probability"])
    assert set(xr.open_zarr(tmp_path / "t.zarr", consolidated=False).data_vars) == {"probability", "accepted"}
    vg.evaluate_into(inspection, tmp_path / "t.csv", poses[:20], columns=("measurand", "visible"))
    lines = (tmp_path / "t.csv").read_text().splitlines()
    assert lines[0] == "viewpoint,characteristic,visible,measurand"
    assert len(lines) == 1 + 20 * 5
    for columns in ([], [""], ["bogus"], ["probability", "probability"], ["probability_low"]):
        for path in (None, tmp_path / "t.csv"):
            with pytest.raises(InputError, match="column"):
                vg.evaluate_into(inspection, path, poses[:2], columns=columns)


@pytest.mark.parametrize("chunk", [0, -1, 2.5, True, "7"])
def test_a_number_of_viewpoints(inspection, poses, chunk):
    for job in (
        lambda: vg.plan(inspection, viewpoints_per_chunk=chunk),
        lambda: vg.evaluate_into(inspection, None, poses, viewpoints_per_chunk=chunk),
    ):
        with pytest.raises(InputError, match="a whole number from 1 on"):
            job()


def test_no_viewpoints(inspection):
    nothing = ExplicitViewpoints((), np.zeros((0, 4, 4)))
    for given in (nothing, np.zeros((0, 4, 4))):
        with pytest.raises(InputError, match="no viewpoints to evaluate"):
            vg.evaluate_into(inspection, None, given)
        with pytest.raises(InputError, match="no viewpoints to evaluate"):
            vg.evaluate(inspection, given)


# --- against the conditions and equations written out in NumPy --------------------------------------------------------


def written_out():
    path = Path(__file__).parents[1] / "visibility" / "test_culling.py"
    spec = importlib.util.spec_from_file_location("culling_written_out", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.reference


def hidden(eye, point, boxes=(((0, 0, 0), (100, 60, 20)), ((0, 0, 0), (60, 60, 40)))):
    """Whether the straight line from the eye to the point passes through a box, by more than a touch (slabs)."""
    for low, high in boxes:
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (np.array(low) - eye) / (point - eye), (np.array(high) - eye) / (point - eye)
        enter, leave = np.nanmax(np.minimum(a, b)), min(np.nanmin(np.maximum(a, b)), 1.0)
        if leave - enter > 1e-3:
            return True
    return False


def test_the_table_is_that_of_the_equations_written_out(inspection, poses, tmp_path):
    pytest.importorskip("pyarrow")
    some = poses[::7]
    vg.evaluate_into(inspection, tmp_path / "t.parquet", some, viewpoints_per_chunk=16)
    table = {name: values.reshape(len(some), -1) for name, values in read(tmp_path / "t.parquet").items()}
    characteristics = inspection.part.characteristics
    measurands = MeasurandTable.of(characteristics)
    assert len(measurands) == len(characteristics), "one measurand each"
    strict, lenient = (
        written_out()(some, measurands, inspection.camera, inspection.limits, slack) for slack in (-1e-9, 1e-9)
    )
    tolerance = np.array(
        [inspection.requirement.allowed_error_mm(d.nominal_mm, d.tolerance_mm) for d in characteristics]
    )
    tolerance /= measurands.length_mm
    clear, seen, unlike = strict == lenient, 0, 0
    for (k, j), reason in np.ndenumerate(table["reason"]):
        if not clear[k, j]:
            continue
        if REASONS[strict[k, j]]:
            assert reason == REASONS[strict[k, j]], (k, j)
            assert table["probability"][k, j] == 0
            continue
        ends = [measurands.points[j, 0], measurands.points[j, 1]] if characteristics[j].observed == "ends" else []
        blocked = [hidden(some[k, :3, 3], end) for end in ends]
        if ends:
            unlike += (reason == "occluded") != any(blocked)
        if reason:
            continue
        seen += 1
        start, end = transform(invert(some[k]), measurands.points[j])
        image = image_segment(start, end, inspection.camera, inspection.pose_error, "joint")
        expected = {
            "probability": image.success_probability(tolerance[j]),
            "expected_accuracy": image.expected_accuracy(),
            "angle_rad": image.angle_rad,
            "relative_tolerance": tolerance[j],
        }
        for name, value in expected.items():
            assert table[name][k, j] == pytest.approx(float(value), rel=0, abs=1e-11), (name, k, j)
    assert seen > 50
    assert (table["reason"] == "occluded").sum() > 5
    assert unlike <= 0.02 * table["reason"].size, "only sights that graze an edge may be judged otherwise"


# --- the same everywhere: plans ---------------------------------------------------------------------------------------


WAYS = ((0, 1), (0, 7), (0, 256), (0, 1000), (1, 7), (2, 256), (3, 64), (2, 1000))


@pytest.mark.parametrize(
    ("refine", "ways"), [(False, WAYS), (True, WAYS[-3:-1]), pytest.param(True, WAYS, marks=pytest.mark.study)]
)
def test_a_plan_is_the_same_wherever_and_in_whatever_pieces_it_is_made(inspection, executors, tmp_path, refine, ways):
    """Refining begins with what the pieces give, in this process."""
    options = {} if refine else {"refine": False, "prove": False}
    whole = plan_bytes(inspection, tmp_path / "whole", **options)
    assert sorted(whole) == ["assignments.csv", "plan.json", "report.html", "viewpoints.csv"]
    assert json.loads(whole["plan.json"])["count"] >= 2
    for workers, chunk in ways:
        folder = tmp_path / f"{workers} {chunk}"
        again = plan_bytes(inspection, folder, executor=executors[workers], viewpoints_per_chunk=chunk, **options)
        assert again == whole, (workers, chunk)


@pytest.mark.parametrize("requirement", ["{error: 20 um, probability: 0.95}", "{error: 1 nm, probability: 0.95}"])
@pytest.mark.parametrize("refine", [False, pytest.param(True, marks=pytest.mark.study)])
def test_so_are_the_best_of_what_is_not_met(executors, tmp_path, requirement, refine):
    options = {} if refine else {"refine": False, "prove": False}
    inspection = write_inspection(tmp_path, requirement=requirement)
    whole = plan_bytes(inspection, tmp_path / "whole", **options)
    assert "not_met" in {d["status"] for d in json.loads(whole["plan.json"])["characteristics"]}
    for workers, chunk in ((0, 7), (2, 50)):
        folder, pieces = (
            tmp_path / f"{workers} {chunk}",
            {"executor": executors[workers], "viewpoints_per_chunk": chunk},
        )
        assert plan_bytes(inspection, folder, **pieces, **options) == whole


@pytest.mark.parametrize(("probability", "not_met"), [(0.99, []), (0.993, ["under"])])
def test_a_doubtful_pair_that_the_full_camera_refutes_is_chosen_again(
    executors, tmp_path, monkeypatch, probability, not_met
):
    import viewgauge.simulation

    refuted, real = [], viewgauge.simulation.estimate_success_probabilities

    def estimate(*arguments, **options):
        found = real(*arguments, **options)
        refuted.extend(found.probability < probability)
        return found

    monkeypatch.setattr(viewgauge.simulation, "estimate_success_probabilities", estimate)
    inspection = write_inspection(
        tmp_path,
        pose_uncertainty="{translation: 25 mm, rotation: 4 deg}",
        requirement=f"{{accuracy: 0.8, probability: {probability}}}",
        candidates="{distance: '[250, 400] mm', directions: 8, rolls: 1}",
    )
    whole = plan_bytes(inspection, tmp_path / "whole", refine=False)
    assert 0 < sum(refuted) < len(refuted), "some pairs are refuted, some confirmed"
    planned = json.loads(whole["plan.json"])["characteristics"]
    assert [d["id"] for d in planned if d["status"] != "met"] == not_met
    met = [d for d in planned if d["status"] == "met"]
    assert all(d["warning"] and d["probability"] >= probability for d in met)
    for workers, chunk in ((0, 1), (0, 7), (2, 5)):
        folder = tmp_path / f"{workers} {chunk}"
        pieces = {"executor": executors[workers], "viewpoints_per_chunk": chunk}
        assert plan_bytes(inspection, folder, refine=False, **pieces) == whole


def test_where_nearly_all_is_doubtful_few_choices_are_made(tmp_path, monkeypatch):
    module, rounds = importlib.import_module("viewgauge.jobs.planning.choice"), []
    real = module.choose_viewpoints
    monkeypatch.setattr(module, "choose_viewpoints", lambda kept, *rest: rounds.append(len(kept)) or real(kept, *rest))
    inspection = write_inspection(
        tmp_path,
        pose_uncertainty="{translation: 25 mm, rotation: 5 deg}",
        requirement="{accuracy: 0.75, probability: 0.985}",
    )
    plan = vg.plan(inspection, refine=False)
    assert all(d.warning for d in plan.characteristics if d.status == "met")
    assert 2 < len(rounds) < 20, (
        "ever more of the most probable are looked into each time round; one by one takes about 70"
    )


# --- lost workers -----------------------------------------------------------------------------------------------------


def own_process(_, item):
    time.sleep(0.02)
    return item, os.getpid()


class Disturbed:
    """An executor of which a worker is killed each time after so many results."""

    def __init__(self, executor, after):
        self.executor, self.after, self.killed = executor, after, []

    def run(self, function, common, items):
        found = {pid for _, (_, pid) in self.executor.run(own_process, None, range(20))}
        for n, pair in enumerate(self.executor.run(function, common, items)):
            if n in self.after:
                os.kill(found.pop(), signal.SIGKILL)
                self.killed.append(n)
            yield pair


def test_a_table_and_a_plan_survive_the_loss_of_workers(inspection, poses, executors, tmp_path):
    pytest.importorskip("zarr")
    disturbed = Disturbed(executors[3], (2, 8, 20))
    for name, executor in (("quiet", InProcess()), ("disturbed", disturbed)):
        vg.evaluate_into(inspection, tmp_path / f"{name}.zarr", poses, executor=executor, viewpoints_per_chunk=20)
    assert disturbed.killed == [2, 8, 20]
    assert tree(tmp_path / "disturbed.zarr") == tree(tmp_path / "quiet.zarr")
    assert sorted(os.listdir(tmp_path)) == ["disturbed.zarr", "quiet.zarr"]
    disturbed = Disturbed(executors[2], (2, 12))
    whole = plan_bytes(inspection, tmp_path / "quiet")
    assert plan_bytes(inspection, tmp_path / "disturbed", executor=disturbed, viewpoints_per_chunk=20) == whole
    assert disturbed.killed == [2, 12]


# --- what can go wrong outside ----------------------------------------------------------------------------------------


def test_a_worker_that_does_not_see_the_folder_says_so(inspection, poses, executors, tmp_path, monkeypatch):
    pytest.importorskip("zarr")
    from viewgauge.formats.tables.table_zarr import ZarrTable

    real = ZarrTable.writer
    elsewhere = Path("not", "on", "this", "machine")
    monkeypatch.setattr(ZarrTable, "writer", lambda table: replace(real(table), job=elsewhere))
    with pytest.raises(InputError, match="is not there on") as caught:
        vg.evaluate_into(inspection, tmp_path / "t.zarr", poses[:9], executor=executors[1], viewpoints_per_chunk=3)
    assert "all workers share" in caught.value.hint


def test_an_error_in_a_chunk_keeps_what_was_there(inspection, poses, tmp_path):
    (tmp_path / "t.csv").write_text("old")

    class Failing(InProcess):
        def run(self, function, common, items):
            yield next(iter(super().run(function, common, items)))
            raise ViewgaugeError("lost")

    with pytest.raises(ViewgaugeError, match="lost"):
        vg.evaluate_into(inspection, tmp_path / "t.csv", poses, executor=Failing(), viewpoints_per_chunk=9)
    assert (tmp_path / "t.csv").read_text() == "old"
    assert os.listdir(tmp_path) == ["t.csv"]


# --- one number in two places -----------------------------------------------------------------------------------------


def test_the_command_line_has_the_default_of_the_jobs():
    from viewgauge.cli import app

    assert app._VIEWPOINTS_PER_CHUNK == VIEWPOINTS_PER_CHUNK
    assert app._TIME_LIMIT_S == DEFAULT_TIME_LIMIT_S


def test_the_contract_columns_are_written_first(inspection, poses, tmp_path):
    vg.evaluate_into(inspection, tmp_path / "t.csv", poses[:1])
    assert (tmp_path / "t.csv").read_text().splitlines()[0].split(",")[2:] == [*COLUMNS, "validity"]


def test_a_viewpoints_file_is_as_good_as_its_poses(inspection, poses, tmp_path):
    write_viewpoints(tmp_path / "s.csv", [f"S{k}" for k in range(1, 31)], poses[:30])
    expected = vg.evaluate_into(inspection, None, poses[:30]).best_of_each()
    got = vg.evaluate_into(inspection, None, tmp_path / "s.csv", viewpoints_per_chunk=7).best_of_each()
    for name, row in expected.items():
        assert got[name]["viewpoint"] == row["viewpoint"]
        assert got[name]["probability"] == pytest.approx(row["probability"], abs=1e-9), "a file has 12 digits or so"
