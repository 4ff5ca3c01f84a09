"""``viewgauge plot``: pictures of a plan, one by one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

import viewgauge as vg

from .options import DONE, PartFile
from .terminal.progress import Bars
from .terminal.reading import read_inspection

__all__ = ["plot"]


def plot(
    file: Path,
    plan: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    what: Literal["scene", "table", "budget", "laws", "accuracy", "directions"] = "scene",
    characteristic: str | None = None,
    dark: Annotated[bool, Parameter(negative="")] = False,
    part: PartFile = None,
) -> int:
    """Draw one picture of a plan as an HTML file that needs nothing from outside.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    plan
        Read the plan from this folder, as viewgauge plan wrote it.
    output
        Write the picture to this file: .html.
    what
        Draw the whole plan (scene, table, budget) or one characteristic (laws, accuracy, directions).
    characteristic
        Draw the characteristic of this id; by default the least probable one.
    dark
        Draw light on dark.
    """
    from ..jobs.read_plan import require_plan_of

    inspection = read_inspection(file, part)
    made = vg.read_plan(plan)
    require_plan_of(made, inspection)
    with Bars().stage("Drawing"):
        chart = vg.plan_chart(inspection, made, what, characteristic, dark=dark)
        vg.write_chart(chart, output, f"{inspection.name}: {what}")
    print(f"written to {output}")
    return DONE
