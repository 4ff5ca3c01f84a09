"""What a page gives away as files."""

from __future__ import annotations

import io
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...formats.poses.viewpoints_file import write_viewpoints
from ...planning import Plan
from ...planning.inspection import Inspection
from ..write import write_plan

__all__ = ["plan_archive", "viewpoints_text"]


def plan_archive(plan: Plan, inspection: Inspection) -> bytes:
    """A ZIP file with what :func:`~viewgauge.jobs.write.write_plan` writes."""
    content = io.BytesIO()
    with tempfile.TemporaryDirectory(prefix="viewgauge-") as folder:
        write_plan(plan, inspection, folder)
        with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(Path(folder).iterdir()):
                archive.write(path, path.name)
    return content.getvalue()


def viewpoints_text(viewpoints: Mapping[str, NDArray[np.float64]]) -> str:
    """A viewpoints file (CSV) of poses ``T_part_camera`` ``(4, 4)`` mm by name."""
    with tempfile.TemporaryDirectory(prefix="viewgauge-") as folder:
        path = Path(folder) / "viewpoints.csv"
        write_viewpoints(path, list(viewpoints), np.array(list(viewpoints.values())).reshape(-1, 4, 4))
        return path.read_text(encoding="utf-8")
