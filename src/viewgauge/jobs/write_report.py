"""The report of a plan, with all that follows from it."""

from __future__ import annotations

from ..execution.chunks import EvaluationJob, evaluator_of
from ..planning import Plan
from ..planning.inspection import ExplicitSettings, Inspection
from ..report import PlanDetails, SettingView, render_report
from ..report.page.details import MOST_VIEWS
from .budgets import error_budgets, figures_of_gauges
from .improvement.improve import settled_improvement
from .laws import gauge_laws
from .workbench.viewpoint_view import SettingViews

__all__ = ["plan_details", "plan_report"]


def plan_report(plan: Plan, inspection: Inspection, details: PlanDetails | None = None) -> str:
    """The report as one HTML text (:func:`~viewgauge.report.render_report`).

    Parameters
    ----------
    details
        Of the plan, where they are known already.
    """
    return render_report(
        plan,
        inspection.part,
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
        figures_of_gauges(inspection, plan, budgets),
        gauge_laws(inspection, plan),
        _views(plan, inspection),
        settled_improvement(inspection, plan),
    )


def _views(plan: Plan, inspection: Inspection) -> tuple[SettingView, ...]:
    """Of as many settings as a report shows; the dimensions are those that can be measured at all."""
    measurable = {planned.id for planned in plan.dimensions if planned.status != "not_measurable"}
    dimensions = tuple(dimension for dimension in inspection.part.dimensions if dimension.id in measurable)
    if not dimensions or not plan.settings:
        return ()
    poses = ExplicitSettings.of_plan(plan)
    table = evaluator_of(EvaluationJob.of(inspection, dimensions, poses)).table(poses.T_part_camera)
    planned = {d.id: {d.setting, *(look.setting for look in d.looks)} - {None} for d in plan.dimensions}
    views = SettingViews(inspection.part.mesh)
    return tuple(
        views.view(setting.id, setting.T_part_camera, inspection.camera, dimensions, table, row, planned)
        for row, setting in enumerate(plan.settings[:MOST_VIEWS])
    )
