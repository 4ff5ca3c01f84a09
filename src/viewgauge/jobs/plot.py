"""Pictures of a plan, one by one."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Literal, get_args

from ..exceptions import InputError
from ..formats.files.atomic import write_text_atomically
from ..planning import Plan
from ..planning.inspection import ExplicitViewpoints, Inspection
from ..report import render_chart
from ..report.charts import Figure, accuracy_chart, budget_chart, directions_chart, laws_chart, table_chart
from ..report.palette import DARK, LIGHT
from ..report.pictures.part_scene import build_scene
from .budgets import error_budgets
from .evaluate import evaluate
from .laws import measurand_laws
from .workbench.what_if import WhatIf

__all__ = ["Picture", "plan_chart", "write_chart"]

Picture = Literal["scene", "table", "budget", "laws", "accuracy", "directions"]

_OF_ONE = ("laws", "accuracy", "directions")


def plan_chart(
    inspection: Inspection, plan: Plan, what: Picture, characteristic: str | None = None, *, dark: bool = False
) -> Figure:
    """A picture of a plan as a Plotly figure's ``data`` and ``layout``.

    Parameters
    ----------
    what
        "scene" (part, measurands, cameras), "table" (viewpoint x characteristic), "budget"; and of one characteristic
        "laws" (of its error), "accuracy" (how surely which accuracy is reached), "directions" (from where).
    characteristic
        Id, for those; by default the least probable.

    Raises
    ------
    InputError
        If there is no such picture, no such characteristic, or the characteristic is seen from nowhere.
    """
    if what not in get_args(Picture):
        raise InputError("no such picture", key="what", got=what, expected=", ".join(get_args(Picture)))
    if characteristic is not None and what not in _OF_ONE:
        raise InputError(
            "this picture is of all characteristics", key="characteristic", got=characteristic, expected="none"
        )
    required = inspection.requirement.probability
    if what == "scene":
        scene, _ = build_scene(plan, inspection.part, inspection.camera)
        theme = DARK if dark else LIGHT
        layout = {**scene["layout"], "paper_bgcolor": theme.paper}
        layout["font"] = {**layout["font"], "color": theme.ink}
        return {"data": [*scene["part"], *scene["cameras"]], "layout": layout}
    if what == "budget":
        return budget_chart(error_budgets(inspection, plan), dark=dark)
    if what == "table":
        return _table(inspection, plan, dark=dark)
    laws = measurand_laws(inspection, plan)
    name = characteristic or _least_sure(plan, list(laws))
    if name not in {d.id for d in plan.characteristics}:
        expected = ", ".join(d.id for d in plan.characteristics)
        raise InputError("no such characteristic", key="characteristic", got=name, expected=expected)
    if name not in laws:
        raise InputError("the characteristic is seen from nowhere", key="characteristic", got=name)
    (planned,) = [d for d in plan.characteristics if d.id == name]
    if what == "laws":
        return laws_chart(name, laws[name], planned.allowed_error_mm, dark=dark)
    if what == "accuracy":
        return accuracy_chart(name, laws[name], planned.allowed_error_mm, required, dark=dark)
    what_if = WhatIf(inspection, plan)
    answers = what_if.answers(what_if.today)
    found = what_if.directions(answers, name, what_if.working_distance_mm(answers, name))
    cameras = {s.id: (s.T_part_camera[:3, 3] - found.target_mm).tolist() for s in plan.viewpoints}
    return directions_chart(found, required, cameras, dark=dark)


def write_chart(chart: Figure, path: str | PathLike[str], title: str) -> None:
    """Write a picture as an HTML file that needs nothing from outside; whole or not at all.

    Raises
    ------
    InputError
        If the suffix is not .html.
    """
    suffix = Path(path).suffix.lower()
    if suffix != ".html":
        raise InputError(
            "unknown kind of file for a picture", file=Path(path), got=suffix or "no suffix", expected=".html"
        )
    write_text_atomically(path, render_chart(chart, title))


def _table(inspection: Inspection, plan: Plan, *, dark: bool) -> Figure:
    if not plan.viewpoints:
        raise InputError("there is no viewpoint to show", key="what", got="table")
    table = evaluate(inspection, ExplicitViewpoints.of_plan(plan))
    return table_chart(
        [str(name) for name in table.viewpoint.values],
        [str(name) for name in table.characteristic.values],
        table.probability.values,
        table.reason.values.astype(str),
        inspection.requirement.probability,
        dark=dark,
    )


def _least_sure(plan: Plan, names: list[str]) -> str:
    shown = [d for d in plan.characteristics if d.id in names]
    if not shown:
        raise InputError("no characteristic is seen", key="characteristic")
    return min(shown, key=lambda characteristic: characteristic.probability).id
