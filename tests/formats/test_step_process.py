"""Every way in which reading a STEP file goes wrong is one clear error; stand-in children crash, hang and flood."""

import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from viewgauge.exceptions import PartFileError
from viewgauge.formats.step import kernel_process as step_process
from viewgauge.formats.step.brep_archive import load_brep, save_brep
from viewgauge.formats.step.kernel_child import main as child_main
from viewgauge.formats.step.kernel_process import read_step, reading_step
from viewgauge.part.brep import Brep, Edge, Face, PmiRecord, Reference
from viewgauge.part.mesh import Mesh

posix = pytest.mark.skipif(os.name != "posix", reason="signals and address-space limits are POSIX only")

SAVE = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from test_step_process import example
from viewgauge.formats.step.brep_archive import save_brep
save_brep(example(), Path(sys.argv[2]))
"""


def example() -> Brep:
    """Two faces and an edge of each shape of array that the archive has to keep apart."""
    faces = (
        Face("plane", np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 1.0]), np.nan, False, (0, 1)),
        Face("cylinder", np.zeros(3), np.array([1.0, 0.0, 0.0]), 2.5, True, (1,)),
    )
    line = Edge(
        "line", np.eye(3)[:2], (0, 1), np.arange(12.0).reshape(2, 2, 3), np.zeros(3), np.zeros(3), np.nan, False
    )
    circle = Edge(
        "circle",
        np.arange(9.0).reshape(3, 3),
        (1,),
        np.ones((3, 1, 3)),
        np.ones(3),
        np.eye(3)[1],
        2.5,
        True,
        True,
        True,
    )
    pmi_records = (
        PmiRecord(
            "ü 1", "distance", "linear distance", 4.0, (-0.1, 0.3), (Reference("face", 1),), (Reference("edge", 0),)
        ),
        PmiRecord("2", "angle", "angle", np.nan, None, (), (), "the file gives no value"),
    )
    mesh = Mesh(np.eye(3), np.array([[0, 1, 2]]), 0.05)
    return Brep("part", "inch", faces, (line, circle), mesh, pmi_records, 3, ("a note",))


@pytest.fixture
def step_file(tmp_path: Path) -> Path:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;\n")
    return path


def child(code: str) -> tuple[str, ...]:
    return (sys.executable, "-c", code)


def refused(path: Path, code: str | None = None, **options: float) -> PartFileError:
    command = {} if code is None else {"_child_command": child(code)}
    with pytest.raises(PartFileError) as caught:
        read_step(path, **options, **command)
    assert str(path) in str(caught.value)
    assert "Traceback" not in str(caught.value)
    return caught.value


def test_a_brep_survives_the_archive_unchanged(tmp_path):
    brep = example()
    save_brep(brep, tmp_path)
    again = load_brep(tmp_path)
    assert (again.name, again.length_unit, again.plus_minus_count, again.notes) == ("part", "inch", 3, ("a note",))
    assert again.pmi_records[0] == brep.pmi_records[0]
    assert again.pmi_records[1].tolerance_mm is None
    assert np.isnan(again.pmi_records[1].nominal_mm)
    assert again.mesh.chord_error_mm == 0.05
    np.testing.assert_array_equal(again.mesh.triangles, brep.mesh.triangles)
    for old, new in zip(brep.edges, again.edges, strict=True):
        for field in ("points", "normals", "centre", "axis", "radius_mm"):
            np.testing.assert_array_equal(getattr(old, field), getattr(new, field))
        for field in ("kind", "faces", "closed", "seam", "smooth"):
            assert getattr(old, field) == getattr(new, field)
    for old, new in zip(brep.faces, again.faces, strict=True):
        for field in ("kind", "origin", "axis", "radius_mm", "concave", "edges"):
            np.testing.assert_array_equal(getattr(old, field), getattr(new, field))


def test_a_child_delivers(step_file):
    assert read_step(step_file, _child_command=child(SAVE)).name == "part"


def test_missing_file(tmp_path):
    error = refused(tmp_path / "none.step")
    assert "does not exist" in error.problem
    assert error.hint


def test_folder(tmp_path):
    assert "folder" in refused(tmp_path).problem


@pytest.mark.parametrize("content", ["", " \n\t\n"])
def test_empty_file(tmp_path, content):
    path = tmp_path / "empty.step"
    path.write_text(content)
    assert refused(path).problem == "the file is empty"


@pytest.mark.parametrize("content", [b"solid cube\nendsolid", b"\x89PNG\r\n", b"#1=POINT();END-ISO-10303-21;"])
def test_not_a_step_file_starts_no_child(tmp_path, content):
    path = tmp_path / "part.step"
    path.write_bytes(content)
    error = refused(path, "raise SystemExit('started')")
    assert error.problem == "this is not a STEP file"
    assert "ISO-10303-21" in str(error.expected)
    assert error.got


def test_truncated_file_starts_no_child(tmp_path):
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=CARTESIAN_POINT('',(0.,")
    error = refused(path, "raise SystemExit('started')")
    assert error.problem == "the file is truncated"
    assert "CARTESIAN_POINT" in str(error.got)


@posix
@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the administrator may read every file")
def test_unreadable_file(step_file):
    step_file.chmod(0)
    assert refused(step_file).problem == "the file cannot be opened"


@posix
@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT"])
def test_a_crash_is_named(step_file, name):
    words = "print('\\x1b[31mlast words\\x1b[0m\\n\\x1b[0m', flush=True)"
    error = refused(step_file, f"import os, signal; {words}; os.kill(os.getpid(), signal.{name})")
    assert name in error.problem
    assert error.got == "last words"
    assert error.hint


def test_an_unexplained_exit_is_a_crash(step_file):
    assert "exit code 7" in refused(step_file, "raise SystemExit(7)").problem


def test_a_child_that_claims_success_without_a_result(step_file):
    assert "cannot be read" in refused(step_file, "pass").problem


@posix
def test_a_crash_over_the_characteristics_leaves_the_geometry(step_file):
    crash = (
        "import json, os, signal, sys\nif json.loads(sys.argv[3])['with_pmi']: os.kill(os.getpid(), signal.SIGSEGV)\n"
    )
    brep = read_step(step_file, _child_command=child(crash + SAVE))
    assert brep.notes[0] == "a note"
    assert "SIGSEGV" in brep.notes[1]
    assert "geometry only" in brep.notes[1]


@posix
def test_a_hanging_child_is_killed_with_what_it_started(step_file, tmp_path):
    pids = tmp_path / "pids"
    code = (
        "import os, subprocess, sys, time\n"
        "other = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        f"open({str(pids)!r}, 'w').write(f'{{os.getpid()}} {{other.pid}}')\n"
        "time.sleep(600)"
    )
    error = refused(step_file, code, timeout_s=3.0)
    assert "took longer than 3 s" in error.problem
    for pid in pids.read_text().split():
        _wait_until_gone(int(pid))


def _wait_until_gone(pid: int) -> None:
    """Fails after a minute; a killed orphan may stay listed as a zombie until init collects it."""
    for _ in range(600):
        try:
            os.kill(pid, 0)
            if Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
                return
        except (ProcessLookupError, FileNotFoundError):
            return
        time.sleep(0.1)
    pytest.fail(f"process {pid} is still there")


def test_other_work_is_done_while_the_child_reads(step_file, tmp_path, monkeypatch):
    flag = tmp_path / "flag"
    wait = f"import os, time\nwhile not os.path.exists({str(flag)!r}): time.sleep(0.01)\n"
    monkeypatch.setattr(step_process, "_CHILD", child(wait + SAVE))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: name)
    with reading_step(step_file) as finish:
        flag.touch()  # while the child waits for it
        assert finish().name == "part"


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, PartFileError])
def test_a_block_that_fails_ends_the_child(step_file, tmp_path, monkeypatch, interruption):
    pid = tmp_path / "pid"
    code = f"import os, time\nopen({str(pid)!r}, 'w').write(str(os.getpid()))\ntime.sleep(600)"
    monkeypatch.setattr(step_process, "_CHILD", child(code))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: name)

    def wait_and_fail():
        while not (pid.exists() and pid.read_text()):
            time.sleep(0.01)
        raise interruption("now")

    with pytest.raises(interruption), reading_step(step_file):
        wait_and_fail()
    if os.name == "posix":
        _wait_until_gone(int(pid.read_text()))


def test_what_is_wrong_with_the_file_is_reported_when_the_part_is_asked_for(tmp_path):
    with reading_step(tmp_path / "none.step") as finish, pytest.raises(PartFileError, match="does not exist"):
        finish()


def test_a_flood_of_messages_neither_blocks_nor_shows(step_file, capfd):
    flood = "import sys\nfor stream in (sys.stdout, sys.stderr): stream.write('noise ' * 2_000_000)\n"
    assert read_step(step_file, _child_command=child(flood + SAVE)).name == "part"
    assert capfd.readouterr() == ("", "")


def test_coordinates_that_are_not_finite(step_file):
    spoilt = SAVE.replace("save_brep(", "brep = example()\nbrep.mesh.vertices[0, 0] = float('nan')\nsave_brep(")
    assert "not finite" in refused(step_file, spoilt.replace("(example(),", "(brep,")).problem


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("memory", "more than 6 GiB"),
        ("import", "cannot be loaded"),
        ("failed", "failed on this file"),
        ("refused", "Why"),
    ],
)
def test_what_the_child_reports_reaches_the_user(step_file, kind, words):
    record = json.dumps({"kind": kind, "problem": "Why", "got": None, "expected": None, "hint": None})
    code = f"import sys; open(sys.argv[2] + '/error.json', 'w').write({record!r}); sys.exit(1)"
    error = refused(step_file, code)
    assert words in error.problem
    if kind == "import":
        assert 'pip install "viewgauge[step]"' in str(error.hint)
        assert error.got == "Why"


def test_a_bad_alloc_on_the_way_down_is_memory(step_file):
    code = "import os, sys; print(\"terminate called after throwing 'std::bad_alloc'\", flush=True); os.abort()"
    assert "GiB of memory" in refused(step_file, code).problem


@posix
def test_the_memory_limit_is_set_in_the_child(step_file):
    code = (
        "import sys, types\n"
        "from viewgauge.formats.step import kernel_child\n"
        "kernel = types.ModuleType('viewgauge.formats.step.kernel')\n"
        "kernel.read_part = lambda *_, **__: bytearray(2**31)\n"
        "sys.modules['viewgauge.formats.step.kernel'] = kernel\n"
        "sys.exit(kernel_child.main(sys.argv[1:]))"
    )
    error = refused(step_file, code, memory_bytes=2**30)
    assert "more than 1 GiB of memory" in error.problem


def test_without_the_kernel_the_user_is_reported_what_to_install(step_file, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    error = refused(step_file)
    assert error.hint == 'pip install "viewgauge[step]"'


def test_the_child_reports_a_kernel_that_cannot_be_loaded(step_file, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "viewgauge.formats.step.kernel", None)  # importing it now raises ImportError
    monkeypatch.setattr("viewgauge.formats.step.kernel_child._limit_memory", lambda _: None)
    options = json.dumps({"chord_error_mm": None, "with_pmi": True, "memory_bytes": 2**33})
    assert child_main([str(step_file), str(tmp_path), options]) == 1
    assert json.loads((tmp_path / "error.json").read_text())["kind"] == "import"
