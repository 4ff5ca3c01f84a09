"""The report as one HTML text that needs nothing from outside."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from html import escape
from importlib.metadata import version
from importlib.resources import files
from string import Template
from typing import Any

from ...evaluation.requirement.allowed_error import Requirement
from ...part import Part
from ...planning.improve.improvement import Improvement
from ...planning.plan import Plan
from ...sensors import Camera, EdgeDetector
from ..palette import DARK, LIGHT
from ..pictures.part_scene import TRIANGLE_LIMIT, build_scene
from ..wording import element, length, requirement_text
from .budget_section import budget_section, figures_section, refinement_section
from .changes import changes_table
from .details import PlanDetails
from .law_section import law_charts, law_section
from .summary import summary_markup
from .tables import characteristic_table, fact_table, viewpoint_table
from .view_section import view_section

__all__ = ["MOST_BYTES", "render_report", "resource", "script_data"]


MOST_BYTES = 9_900_000
"""Of a report, so that it can be sent by mail."""

_ATTEMPTS = 8


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
    if camera.edge_detector is None:
        facts["Edge resolution"] = f"{camera.edge_resolution_px:g} px"
    else:
        facts["Edge detector"] = _edge_detector_words(camera.edge_detector)
    if camera.lens is not None:
        facts["Lens"] = f"{camera.lens.model} distortion"
    if camera.intrinsics_covariance is not None:
        facts["Calibration"] = "with its uncertainty"
    if camera.f_number is not None and camera.focus_distance_mm is not None:
        facts["Aperture"] = f"f/{camera.f_number:g}, in focus at {length(camera.focus_distance_mm)} mm"
    return facts


def _edge_detector_words(edge_detector: EdgeDetector) -> str:
    words = f"noise {edge_detector.noise_px:.2g} px, offset {edge_detector.bias_px:.2g} px"
    return (
        words
        if edge_detector.edge_points is None
        else f"{words}, {edge_detector.edge_points} points fitted at each end"
    )


def _notes(part: Part, remark: str) -> str:
    notes = [*part.notes, remark] if remark else list(part.notes)
    return element("ul", markup="".join(element("li", note) for note in notes), class_="notes") if notes else ""


def _improvement_section(improvement: Improvement | None) -> str:
    if improvement is None:
        return ""
    hint = (
        "One thing changed alone, the viewpoints as they stand: with so much each characteristic is still "
        "met, or would be. "
        "Hatched: no such change will do; the probability is what is reached without that error. Other "
        "viewpoints, which "
        "viewgauge improve tries, may ask for less."
    )
    content = element("h2", "What to improve", id="improve") + element("p", hint, class_="hint")
    content += changes_table(improvement)
    if improvement.left_out:
        names = ", ".join(improvement.left_out)
        content += element("p", f"No camera or head error is in the way of {names}: they are not seen.", class_="hint")
    return element("section", markup=content)


def render_report(
    plan: Plan,
    part: Part,
    camera: Camera,
    requirement: Requirement,
    *,
    title: str,
    inputs: Mapping[str, str],
    details: PlanDetails | None = None,
) -> str:
    """The report of a plan as one HTML text that works offline.

    Parameters
    ----------
    title
        Heading, such as the part's name.
    inputs
        What the plan was made from: file names with their hashes, versions.
    details
        What follows from the plan, as far as it is to be shown.

    Returns
    -------
    HTML with plotly.js inside; no resource is fetched, and the page forbids itself to. All text is escaped. The
    same arguments give the same text. Where it would be larger than :data:`MOST_BYTES`, views and laws of fewer
    viewpoints and characteristics and a coarser part are shown, and it is said.
    """
    details, triangles = details or PlanDetails(), TRIANGLE_LIMIT
    for _ in range(_ATTEMPTS):
        text = _rendered(plan, part, camera, requirement, title, inputs, details, triangles)
        if len(text.encode()) <= MOST_BYTES:
            break
        details, triangles = details.fewer(), triangles // 2
    return text


def _rendered(
    plan: Plan,
    part: Part,
    camera: Camera,
    requirement: Requirement,
    title: str,
    inputs: Mapping[str, str],
    details: PlanDetails,
    triangles: int,
) -> str:
    from plotly.offline import get_plotlyjs  # here: 5 MB that only a report needs

    scene, remark = build_scene(plan, part, camera, triangles)
    pictures = {
        **scene,
        "laws": law_charts(plan, details.laws, requirement.probability, details.most_laws),
        "themes": [asdict(LIGHT), asdict(DARK)],
    }
    made_from = {**inputs, "viewgauge": version("viewgauge"), "Seed": str(plan.seed)}
    return Template(resource("page.html")).substitute(
        title=escape(title),
        style=resource("page.css"),
        requirement=escape(requirement_text(requirement)),
        summary=summary_markup(plan),
        notes=_notes(part, remark),
        characteristics=characteristic_table(plan),
        viewpoints=viewpoint_table(plan, part, camera),
        refinement=refinement_section(plan),
        views=view_section(details.views, requirement.probability, details.most_views),
        laws=law_section(plan, details.laws, details.most_laws),
        budget=budget_section(plan, details.budgets),
        improvement=_improvement_section(details.improvement),
        figures=figures_section(plan, details.figures),
        camera=fact_table(_camera_facts(camera)),
        inputs=fact_table(made_from),
        plotly=get_plotlyjs(),
        scene=script_data(pictures),
        view=resource("view.js"),
    )
