"""The inspection of a command, read with a spinner and with its findings shown."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import viewgauge as vg

from .progress import Bars

if TYPE_CHECKING:
    from ...findings import Finding
    from ...planning.inspection import Inspection

__all__ = ["print_findings", "read_inspection", "read_to_render"]


def read_inspection(
    file: Path,
    part: Path | None,
    *,
    chord_error_mm: float | None = None,
    meanwhile: Callable[[], object] | None = None,
    may_be_empty: bool = False,
) -> Inspection:
    """The inspection; what is implausible in it is shown on standard error. Arguments as :func:`viewgauge.load`."""
    with Bars().stage("Reading the inspection and its part"):
        inspection = vg.load(
            file, part=part, chord_error_mm=chord_error_mm, meanwhile=meanwhile, may_be_empty=may_be_empty
        )
    print_findings(inspection.findings)
    return inspection


def read_to_render(file: Path, part: Path | None, chord_error_mm: float | None) -> Inspection:
    """The inspection with a mesh as fine as images of the part need; its findings are shown on standard error."""
    from ...jobs.images.load_to_render import load_to_render

    with Bars().stage("Reading the inspection and its part"):
        inspection = load_to_render(file, part=part, chord_error_mm=chord_error_mm)
    print_findings(inspection.findings)
    return inspection


def print_findings(findings: Iterable[Finding]) -> None:
    """Each finding as a warning on standard error."""
    for finding in findings:
        print(f"viewgauge: warning: {finding}", file=sys.stderr)
