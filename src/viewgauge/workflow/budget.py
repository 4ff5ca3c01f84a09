"""The error budget and the gauge's figures of every dimension of a plan."""

from __future__ import annotations

import numpy as np

from ..evaluation import GaugeFigures, gauge_figures, image_segment, spread_mm
from ..evaluation.budget import ErrorBudget, error_budget
from ..evaluation.capability import SIGMAS
from ..geometry import invert, transform
from ..planning import Plan, PlannedDimension
from .inspection import Inspection

__all__ = ["error_budgets", "figures_of_gauges"]


def error_budgets(inspection: Inspection, plan: Plan) -> dict[str, ErrorBudget]:
    """What causes the uncertainty of each dimension of a plan, at first order.

    Of a dimension that is not met at the best pose that was tried. Dimensions that are seen from nowhere, cannot be
    measured, or are averaged from several looks have none.

    Parameters
    ----------
    plan
        Of this inspection.

    Returns
    -------
    By the dimension's id; each of one segment, so its arrays have the shapes that
    :class:`~viewgauge.evaluation.ErrorBudget` states without leading axes.
    """
    found = {}
    for dimension in _measured(plan):
        start, end = _seen(dimension)
        tolerance = dimension.allowed_error_mm / float(np.linalg.norm(end - start))
        found[dimension.id] = error_budget(start, end, inspection.camera, inspection.head, tolerance)
    return found


def figures_of_gauges(inspection: Inspection, plan: Plan) -> dict[str, GaugeFigures]:
    """Expanded uncertainty, %P/T, Cg, Cgk, TUR and risks of the same dimensions, by id."""
    camera, requirement = inspection.camera, inspection.requirement
    sigmas = getattr(requirement, "sigmas", SIGMAS)
    budgets = error_budgets(inspection, plan)
    found = {}
    for dimension in _measured(plan):
        start, end = _seen(dimension)
        image = image_segment(start, end, camera, inspection.head)
        angle = float(image.angle_rad)
        pitch = np.asarray(camera.pixel_pitch_mm)
        px_per_mm = float(np.hypot(*(np.array([np.cos(angle), np.sin(angle)]) / pitch)))
        half = spread_mm(
            float(image.sigma_displacement_mm) * px_per_mm,
            float(image.length_mm) * px_per_mm,
            angle,
            float(np.linalg.norm(end - start)),
            camera,
            sigmas,
        )
        u = float(budgets[dimension.id].combined_uncertainty_mm)
        if u > 0:
            found[dimension.id] = gauge_figures(u, dimension.tolerance_mm, requirement, half)
    return found


def _measured(plan: Plan) -> list[PlannedDimension]:
    return [d for d in plan.dimensions if d.T_part_camera is not None and d.gauge is not None]


def _seen(dimension: PlannedDimension) -> np.ndarray:
    """``(2, 3)`` mm: the gauge in the frame of the camera that looks at it."""
    assert dimension.T_part_camera is not None and dimension.gauge is not None  # noqa: PT018  # the caller's condition
    return transform(invert(dimension.T_part_camera), dimension.gauge)
