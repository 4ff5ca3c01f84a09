"""A mesh with characteristics from the inspection file, with the CAD kernel out of reach."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from inspections import BOX, HEEL, WIDTH, box_part, entry, sections, write_box

BLOCKED = "import sys; sys.modules['OCP'] = None"  # importing it now raises ModuleNotFoundError

PART = box_part(
    WIDTH,
    entry("depth", "[0, 0, 40]", "[0, 50, 40]", observed="whole"),
    entry("rear", "[0, 50, 40]", "[80, 50, 40]", "'[-0.1, 0.2] mm'"),
    entry("foot", "[0, 0, 0]", "[80, 0, 0]", "'[-0.1, 0.2] mm'"),
    HEEL,
)
TEXT = sections(**{**BOX, "part": PART, "candidates": "{directions: 60, rolls: 2}"})


def run(*arguments: str, cwd: Path, prelude: str = "") -> subprocess.CompletedProcess[str]:
    code = f"{prelude}\nimport sys\nfrom viewgauge.cli import main\nsys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=cwd, capture_output=True, text=True, timeout=600, check=False
    )


def test_a_mesh_is_planned_without_the_cad_kernel(tmp_path):
    write_box(tmp_path)
    (tmp_path / "box.yaml").write_text(TEXT)
    done = run("plan", "box.yaml", "-o", "out", "--json", cwd=tmp_path, prelude=BLOCKED)
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert [d["status"] for d in document["characteristics"]] == ["met"] * 5
    assert [d["nominal_mm"] for d in document["characteristics"]] == pytest.approx([80.0, 50.0, 80.0, 80.0, 80.0])
    assert document["proven"]
    assert document["count"] == 2, "no camera sees all four long edges of a box, two see them"
    assert json.loads((tmp_path / "out" / "plan.json").read_text()) == document


def test_a_step_file_without_the_cad_kernel_is_one_message(tmp_path):
    (tmp_path / "box.step").write_text("ISO-10303-21;HEADER;ENDSEC;DATA;ENDSEC;END-ISO-10303-21;\n")
    (tmp_path / "box.yaml").write_text(TEXT)
    done = run("check", "box.yaml", "--part", "box.step", cwd=tmp_path, prelude=BLOCKED)
    assert done.returncode == 2
    assert "viewgauge[step]" in done.stderr
    assert "Traceback" not in done.stderr
