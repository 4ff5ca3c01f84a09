"""The report as one HTML text that needs nothing from outside."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from importlib.metadata import version
from importlib.resources import files
from string import Template
from typing import Any

from ..evaluation.budget import ErrorBudget
from ..evaluation.gauge_figures import GaugeFigures
from ..evaluation.requirement import Requirement
from ..geometry import Camera, EdgeLocator
from ..part.dimension import Part
from ..planning.result import Plan
from .budget import budget_section, figures_section, refinement_section
from .scene import build_scene
from .summary import summary_markup
from .tables import dimension_table, fact_table, setting_table
from .wording import element, length, requirement_text

__all__ = ["render_report", "resource", "script_data"]


def resource(name: str) -> str:
    """A file that stands beside this one."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def script_data(data: Any) -> str:
    """JSON that cannot end the script element it stands in, whatever strings it holds."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _camera_facts(camera: Camera) -> dict[str, str]:
    columns, rows = camera.resolution
    pitch = " x ".join(f"{1000 * value:g}" for value in dict.fromkeys(camera.pixel_pitch_mm))
    facts = {
        "Focal length": f"{length(camera.focal_length_mm)} mm",
        "Pixel": f"{pitch} µm",
        "Resolution": f"{columns} x {rows} px",
    }
    if camera.locator is None:
        facts["Edge resolution"] = f"{camera.edge_resolution_px:g} px"
    else:
        facts["Edge locator"] = _locator_words(camera.locator)
    if camera.lens is not None:
        facts["Lens"] = f"{camera.lens.model} distortion"
    if camera.intrinsics_covariance is not None:
        facts["Calibration"] = "with its uncertainty"
    if camera.f_number is not None and camera.focus_distance_mm is not None:
        facts["Aperture"] = f"f/{camera.f_number:g}, in focus at {length(camera.focus_distance_mm)} mm"
    return facts


def _locator_words(locator: EdgeLocator) -> str:
    words = f"noise {locator.noise_px:.2g} px, offset {locator.bias_px:.2g} px"
    return words if locator.edge_points is None else f"{words}, {locator.edge_points} points fitted at each end"


def _notes(part: Part, remark: str) -> str:
    notes = [*part.notes, remark] if remark else list(part.notes)
    return element("ul", markup="".join(element("li", note) for note in notes), class_="notes") if notes else ""


def render_report(
    plan: Plan,
    part: Part,
    camera: Camera,
    requirement: Requirement,
    *,
    title: str,
    inputs: Mapping[str, str],
    budgets: Mapping[str, ErrorBudget] | None = None,
    figures: Mapping[str, GaugeFigures] | None = None,
) -> str:
    """The report of a plan as one HTML text that works offline.

    Parameters
    ----------
    title
        Heading, such as the part's name.
    inputs
        What the plan was made from: file names with their hashes, versions.
    budgets, figures
        Of dimensions, by id, as far as they have some.

    Returns
    -------
    HTML with plotly.js inside; no resource is fetched, and the page forbids itself to. All text is escaped. The
    same arguments give the same text.
    """
    from plotly.offline import get_plotlyjs  # here: 5 MB that only a report needs

    scene, remark = build_scene(plan, part, camera)
    made_from = {**inputs, "viewgauge": version("viewgauge"), "Seed": str(plan.seed)}
    return Template(resource("page.html")).substitute(
        title=escape(title),
        style=resource("page.css"),
        requirement=escape(requirement_text(requirement)),
        summary=summary_markup(plan),
        notes=_notes(part, remark),
        dimensions=dimension_table(plan),
        settings=setting_table(plan, part, camera),
        refinement=refinement_section(plan),
        budget=budget_section(plan, budgets or {}),
        figures=figures_section(plan, figures or {}),
        camera=fact_table(_camera_facts(camera)),
        inputs=fact_table(made_from),
        plotly=get_plotlyjs(),
        scene=script_data(scene),
        view=resource("view.js"),
    )
