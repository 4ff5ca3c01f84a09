"""What the workbench asks of child processes."""

from __future__ import annotations

from pathlib import Path

from ...execution.progress import Progress
from ...planning import Plan
from ...planning.inspection import Inspection

__all__ = ["load_uploaded", "plan_again"]


def plan_again(progress: Progress, inspection: Inspection) -> Plan:
    """A plan of an inspection."""
    from ..planning.plan import plan

    return plan(inspection, progress=progress)


def load_uploaded(progress: Progress, path: Path) -> Inspection:
    """Read an inspection file that a visitor sent; nothing outside its folder is read."""
    from ..load import load

    with progress.stage("Reading the inspection and its part"):
        return load(path, within=path.parent)
