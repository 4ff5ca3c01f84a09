"""``viewgauge plot``: pictures of a plan, one by one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

import viewgauge as vg

from .options import DONE, PartFile
from .progress import Bars

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
        The inspection file (YAML).
    plan
        Folder of the plan, as viewgauge plan wrote it.
    output
        The picture: .html.
    what
        scene (the part, its measurands, the cameras), table (viewpoint x characteristic), budget (what the uncertainty
        comes from); of one characteristic laws (of its error), accuracy (how surely which is reached), directions (from
        where).
    characteristic
        Its id; the least sure by default.
    dark
        Light on dark.
    """
    from ..jobs.read_plan import require_plan_of

    with Bars().stage("Reading the inspection and its part"):
        inspection = vg.load(file, part=part)
    made = vg.read_plan(plan)
    require_plan_of(made, inspection)
    with Bars().stage("Drawing"):
        chart = vg.plan_chart(inspection, made, what, characteristic, dark=dark)
        vg.write_chart(chart, output, f"{inspection.name}: {what}")
    print(f"written to {output}")
    return DONE
