"""The first command says that it compiles, the next one has nothing to say."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from viewgauge.cli.terminal.first_run import LINE

CAMERA = """cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.21, 0.105, 0.0003, -0.0002]
  distortion_model: radtan
  intrinsics: [2801.25, 2799.75, 1012.5, 770.125]
  resolution: [2048, 1536]
"""


@pytest.fixture
def run(tmp_path):
    """Runs viewgauge in a process of its own, with an empty cache of kernels to begin with."""
    (tmp_path / "camera.yaml").write_text(CAMERA)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "viewgauge", *arguments]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)

    return run


def kernels(folder: Path) -> list[Path]:
    return sorted((folder / "kernels").rglob("*.nbc"))


def test_one_line_is_printed_where_a_kernel_is_compiled_and_none_where_all_are_cached(run, tmp_path):
    first = run("camera", "camera.yaml", "--json")
    compiled = kernels(tmp_path)
    assert len(compiled) > 1
    assert first.stderr == LINE + "\n"
    again = run("camera", "camera.yaml", "--json")
    assert kernels(tmp_path) == compiled
    assert again.stderr == ""
    assert json.loads(first.stdout) == json.loads(again.stdout)
    compiled[0].unlink()
    assert run("camera", "camera.yaml").stderr == LINE + "\n"  # for a single one that the cache lacks


def test_what_needs_no_kernel_is_silent(run, tmp_path):
    assert run("plan", "--help").stderr == ""
    assert not kernels(tmp_path)
