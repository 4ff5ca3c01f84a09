"""Inspection files of the shared cases are in the format before version 2; this turns their text into version 2."""

from __future__ import annotations

import re
from pathlib import Path

CASES = Path(__file__).resolve().parents[3] / "shared" / "cases"
"""Small inputs that failed once, beside the checkout; tests of them are skipped where the folder is absent."""

_POINTS = re.compile(r"^(\s*)start: (\[[^\]]*\]) (\w+)\n\s*end: (\[[^\]]*\]) \3$", re.M)


def version_2(text: str) -> str:
    """The same inspection in the present format, as text."""
    text = _POINTS.sub(r"\1points: [\2, \4]\n\1unit: \3", text)
    text = re.sub(r"\bpivot: (\[[^\]]*\]) (\w+)", r'frame: {position: "\1 \2"}', text)
    text = re.sub(r"\bedge_resolution: ([^,}\n]+)", r"edge_detector: {quantization: \1}", text)
    renamed = {"dimensions:": "characteristics:", "head:": "pose_uncertainty:", "locator:": "edge_detector:"}
    for old, new in renamed.items():
        text = re.sub(rf"(^|[\s{{]){old}", rf"\g<1>{new}", text, flags=re.M)
    return re.sub(r'(?<!")(\[[^\[\]]*\]) (mm|um|m|deg|rad|px)\b(?!")', r'"\1 \2"', text)


def copy_case(case: Path, folder: Path, part: str | None = None) -> Path:
    """Copy an inspection file of the cases with what lies beside it, converted; returns the copy's path."""
    for beside in case.parent.iterdir():
        if beside.is_file() and beside != case:
            (folder / beside.name).write_bytes(beside.read_bytes())
    text = version_2(case.read_text())
    (folder / case.name).write_text(text if part is None else re.sub(r"file: \S+", f"file: {part}", text, count=1))
    return folder / case.name
