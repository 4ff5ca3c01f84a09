"""The report as one HTML text that needs nothing from outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version

from ...evaluation.requirement.allowed_error import Requirement
from ...part import Part
from ...planning.improve.improvement import Improvement
from ...planning.plan import Plan
from ...sensors import Camera, EdgeDetector
from ..palette import DARK, LIGHT
from ..pictures.part_scene import TRIANGLE_LIMIT, build_scene
from ..templating import Markup, render, render_page
from ..wording import length
from .budget_section import budget_section, capability_section, refinement_section
from .changes import changes_table
from .details import PlanDetails
from .law_section import law_charts, law_section
from .summary import summary_section
from .tables import characteristics_section, viewpoints_section
from .view_section import view_section

__all__ = ["MOST_BYTES", "render_report"]

MOST_BYTES = 9_900_000
"""Of a report, so that it can be sent by mail."""

_ATTEMPTS = 8


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
    if camera.focus_distance_mm is not None:
        facts["Principal distance"] = (
            f"{length(camera.principal_distance_mm)} mm, focused at {length(camera.focus_distance_mm)} mm"
        )
    if (radius := camera.field_radius_px) is not None:
        facts["Field"] = f"within {radius:.0f} px of the principal point, as far as the lens model holds"
    if camera.usable_region is not None:
        facts["Usable region"] = "part of the image"
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


def _improvement_section(improvement: Improvement | None) -> Markup:
    return Markup() if improvement is None else render("improve_section.html", changes=changes_table(improvement))


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
    scene, remark = build_scene(plan, part, camera, triangles)
    pictures = {
        **scene,
        "laws": law_charts(plan, details.laws, requirement.probability, details.most_laws),
        "themes": [asdict(LIGHT), asdict(DARK)],
    }
    return render_page(
        "page.html",
        pictures,
        title=title,
        requirement=requirement.text,
        summary=summary_section(plan),
        notes=[*part.notes, remark] if remark else part.notes,
        characteristics=characteristics_section(plan),
        viewpoints=viewpoints_section(plan, part, camera),
        views=view_section(details.views, requirement.probability, details.most_views),
        laws=law_section(plan, details.laws, details.most_laws),
        budget=budget_section(plan, details.budgets),
        improvement=_improvement_section(details.improvement),
        capability=capability_section(plan, details.figures),
        refinement=refinement_section(plan),
        camera=_camera_facts(camera),
        inputs={**inputs, "viewgauge": version("viewgauge"), "Seed": str(plan.seed)},
    )
