"""A mesh with characteristics from the inspection file, with the CAD kernel out of reach."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BLOCKED = "import sys; sys.modules['OCP'] = None"  # importing it now raises ModuleNotFoundError

BOX = """part:
  file: box.stl
  characteristics:
    - id: width
      points: [[0, 0, 40], [80, 0, 40]]
      unit: mm
      tolerance: 0.1 mm
    - id: depth
      points: [[0, 0, 40], [0, 50, 40]]
      unit: mm
      tolerance: 0.1 mm
      observed: whole
    - id: rear
      points: [[0, 50, 40], [80, 50, 40]]
      unit: mm
      tolerance: "[-0.1, 0.2] mm"
    - id: foot
      points: [[0, 0, 0], [80, 0, 0]]
      unit: mm
      tolerance: "[-0.1, 0.2] mm"
    - id: heel
      points: [[0, 50, 0], [80, 50, 0]]
      unit: mm
      tolerance: "[-0.1, 0.2] mm"
camera: {focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048], edge_detector: {quantization: 0.1 px}}
pose_uncertainty: {translation: 0.1 mm, rotation: 0.02 deg}
requirement: {accuracy: 0.995, probability: 0.95}
candidates: {directions: 60, rolls: 2}
"""


def run(*arguments: str, cwd: Path, prelude: str = "") -> subprocess.CompletedProcess[str]:
    code = f"{prelude}\nimport sys\nfrom viewgauge.cli import main\nsys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=cwd, capture_output=True, text=True, timeout=300, check=False
    )


def test_a_mesh_is_planned_without_the_cad_kernel(tmp_path):
    import trimesh

    trimesh.creation.box(bounds=[(0, 0, 0), (80, 50, 40)]).export(tmp_path / "box.stl")
    (tmp_path / "box.yaml").write_text(BOX)
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
    (tmp_path / "box.yaml").write_text(BOX)
    done = run("check", "box.yaml", "--part", "box.step", cwd=tmp_path, prelude=BLOCKED)
    assert done.returncode == 2
    assert "viewgauge[step]" in done.stderr
    assert "Traceback" not in done.stderr
