"""The report of a plan, with all that follows from it."""

from __future__ import annotations

from dataclasses import replace

from ..execution.chunks import EvaluationJob, evaluator_of
from ..planning import Plan
from ..planning.inspection import ExplicitViewpoints, Inspection
from ..report import PlanDetails, ViewpointView, render_report
from ..report.page.details import MOST_VIEWS
from .budgets import capability_of_characteristics, error_budgets
from .improvement.improve import settled_improvement
from .laws import measurand_laws
from .workbench.viewpoint_view import ViewpointViews

__all__ = ["plan_details", "plan_report"]


def plan_report(plan: Plan, inspection: Inspection, details: PlanDetails | None = None) -> str:
    """The report as one HTML text (:func:`~viewgauge.report.render_report`).

    Parameters
    ----------
    details
        Of the plan, where they are known already.
    """
    warnings = [f"warning: {finding}" for finding in inspection.findings]
    return render_report(
        plan,
        replace(inspection.part, notes=(*inspection.part.notes, *warnings)),
        inspection.camera,
        inspection.requirement,
        title=inspection.name,
        inputs={f"{name} (SHA-256)": digest for name, digest in inspection.inputs.items()},
        details=details or plan_details(plan, inspection),
    )


def plan_details(plan: Plan, inspection: Inspection) -> PlanDetails:
    """Budgets, figures, laws, views, and what to improve."""
    budgets = error_budgets(inspection, plan)
    return PlanDetails(
        budgets,
        capability_of_characteristics(inspection, plan, budgets),
        measurand_laws(inspection, plan),
        _views(plan, inspection),
        settled_improvement(inspection, plan),
    )


def _views(plan: Plan, inspection: Inspection) -> tuple[ViewpointView, ...]:
    """Of as many viewpoints as a report shows; the characteristics are those that can be measured at all."""
    measurable = {planned.id for planned in plan.characteristics if planned.status.is_judged}
    characteristics = tuple(
        characteristic for characteristic in inspection.part.characteristics if characteristic.id in measurable
    )
    if not characteristics or not plan.viewpoints:
        return ()
    poses = ExplicitViewpoints.of_plan(plan)
    table = evaluator_of(EvaluationJob.of(inspection, characteristics, poses)).table(poses.T_part_camera)
    planned = {
        d.id: {d.viewpoint, *(acquisition.viewpoint for acquisition in d.acquisitions)} - {None}
        for d in plan.characteristics
    }
    views = ViewpointViews(inspection.part.mesh)
    return tuple(
        views.view(viewpoint.id, viewpoint.T_part_camera, inspection.camera, characteristics, table, row, planned)
        for row, viewpoint in enumerate(plan.viewpoints[:MOST_VIEWS])
    )
