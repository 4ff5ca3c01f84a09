"""What a command does not need it does not load: told by the modules that are there afterwards, not by time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from inspections import POSE_UNCERTAINTY, WHOLE_PIXELS, WIDTH, box_part, sections, write_box

TEXT = sections(
    part=box_part(WIDTH),
    camera=WHOLE_PIXELS,
    pose_uncertainty=POSE_UNCERTAINTY,
    requirement="{accuracy: 0.9, probability: 0.5}",
)
VIEWPOINTS = "id,x,y,z,qw,qx,qy,qz\nabove,40,0,350,0,1,0,0\n"
STEP = "ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;\n"
DRAWING = {"plotly", "viewgauge.report"}  # and Jinja, but where Dask is installed pint loads it too
HEAVY = {
    "numpy",
    "scipy",
    "numba",
    "xarray",
    "pandas",
    "trimesh",
    "pydantic",
    "pint",
    "ruamel.yaml",
    "OCP",
    "jinja2",
    *DRAWING,
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_box()
    Path("inspection.yaml").write_text(TEXT)
    Path("viewpoints.csv").write_text(VIEWPOINTS)


def loaded(code: str) -> set[str]:
    """The modules that a fresh interpreter has after running code, which may print."""
    code += "\nimport sys\nprint('\\nmodules:', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("modules:")[2].split())


def after(*arguments: str) -> set[str]:
    """The modules that are there after a command that succeeds."""
    return loaded(f"from viewgauge.cli import main\nassert main({list(arguments)!r}) == 0")


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["evaluate", "--help"]])
def test_help_loads_nothing_heavy(arguments):
    modules = after(*arguments)
    assert not modules & {*HEAVY, "viewgauge.jobs"}


def test_check_of_a_mesh_loads_no_kernel_no_report_and_no_simulation():
    modules = after("check", "inspection.yaml")
    assert "trimesh" in modules
    absent = {
        "OCP",
        "scipy.stats",
        "viewgauge.simulation",
        "viewgauge.formats.step.kernel",
    }
    assert not modules & (absent | DRAWING)


def test_evaluate_loads_no_kernel_no_report_and_no_statistics():
    modules = after("evaluate", "inspection.yaml", "--viewpoints", "viewpoints.csv", "-o", "table.csv")
    assert "numba" in modules
    assert not modules & {"OCP", "scipy.stats", "viewgauge.formats.step.kernel", *DRAWING}


def test_a_step_file_s_reading_begins_before_anything_heavy_is_loaded():
    Path("part.step").write_text(STEP)
    Path("inspection.yaml").write_text(TEXT.replace("box.stl", "part.step"))
    modules = loaded(
        "from viewgauge.formats.step import kernel_process as step_process\n"
        "from viewgauge.jobs.load import load\n"
        "class Started(Exception): pass\n"
        "def popen(*_, **__): raise Started\n"
        "step_process.subprocess.Popen = popen\n"
        "step_process.importlib.util.find_spec = lambda name: name\n"
        "try:\n"
        "    load('inspection.yaml')\n"
        "except Started:\n"
        "    started = True\n"
        "assert started"
    )
    assert not modules & (HEAVY - {"ruamel.yaml"})


def test_the_child_loads_the_kernel_and_nothing_else_that_is_slow():
    pytest.importorskip("OCP")
    modules = loaded(
        "import viewgauge.formats.step.kernel_child, viewgauge.formats.step.kernel, viewgauge.formats.step.brep_archive"
    )
    assert "OCP" in modules
    assert not modules & (HEAVY - {"numpy", "OCP"})
