"""schema as a user meets it: printed, or written to a file."""

from __future__ import annotations

import json
from pathlib import Path

from viewgauge.cli import main


def test_the_schema_is_printed_and_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["schema"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert {"camera", "pose_uncertainty", "requirement"} <= set(printed["properties"])
    assert main(["schema", "-o", "inspection.schema.json"]) == 0
    assert capsys.readouterr().out == "written to inspection.schema.json\n"
    assert json.loads(Path("inspection.schema.json").read_text(encoding="utf-8")) == printed


def test_a_place_that_cannot_be_written_is_reported(tmp_path, capsys):
    assert main(["schema", "-o", str(tmp_path / "none" / "schema.json")]) == 2
    assert "create the folder" in capsys.readouterr().err
