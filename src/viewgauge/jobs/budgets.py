"""The error budget and the gauge's figures of every dimension of a plan."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..evaluation import GaugeFigures, gauge_figures, image_segment, spread_mm
from ..evaluation.error_budget import ErrorBudget, averaged_error_budget, error_budget
from ..evaluation.requirement.capability_indices import SIGMAS
from ..geometry import invert, transform
from ..part import Dimension
from ..part.characteristic import rim_axes
from ..planning import Plan, PlannedDimension
from ..planning.inspection import Inspection

__all__ = ["error_budgets", "figures_of_gauges"]


def error_budgets(inspection: Inspection, plan: Plan) -> dict[str, ErrorBudget]:
    """What causes the uncertainty of each dimension of a plan, at first order.

    Of a dimension that is not met at the best pose that was tried; of one that is averaged of the mean of its looks.
    Dimensions that are seen from nowhere, or cannot be measured, have none.

    Parameters
    ----------
    plan
        Of this inspection.

    Returns
    -------
    By the dimension's id; each of one segment, so its arrays have the shapes that
    :class:`~viewgauge.evaluation.error_budget.ErrorBudget` states without leading axes.
    """
    camera, head = inspection.camera, inspection.head
    of_part = {dimension.id: dimension for dimension in inspection.part.dimensions}
    poses = {setting.id: setting.T_part_camera for setting in plan.settings}
    found = {}
    for dimension in plan.dimensions:
        if dimension.looks:
            points = np.array([transform(invert(poses[look.setting]), look.gauge) for look in dimension.looks])
            axes = np.array(
                [_rim_axis(of_part[dimension.id], look.gauge, poses[look.setting]) for look in dimension.looks]
            )
            found[dimension.id] = averaged_error_budget(points, camera, head, dimension.allowed_error_mm, axes)
        elif dimension.T_part_camera is not None and dimension.gauge is not None:
            start, end = transform(invert(dimension.T_part_camera), dimension.gauge)
            tolerance = dimension.allowed_error_mm / float(np.linalg.norm(end - start))
            axis = _rim_axis(of_part[dimension.id], dimension.gauge, dimension.T_part_camera)
            found[dimension.id] = error_budget(start, end, camera, head, tolerance, axis)
    return found


def figures_of_gauges(
    inspection: Inspection, plan: Plan, budgets: Mapping[str, ErrorBudget] | None = None
) -> dict[str, GaugeFigures]:
    """Expanded uncertainty, %P/T, Cg, Cgk, TUR and risks of the same dimensions, by id.

    Parameters
    ----------
    budgets
        Of the plan, where they are known already.
    """
    found = {}
    of_plan = {dimension.id: dimension for dimension in plan.dimensions}
    for name, budget in (error_budgets(inspection, plan) if budgets is None else budgets).items():
        dimension, u = of_plan[name], float(budget.combined_uncertainty_mm)
        if u > 0:
            half = None if dimension.looks else _spread_mm(inspection, dimension)
            found[name] = gauge_figures(u, dimension.tolerance_mm, inspection.requirement, half)
    return found


def _spread_mm(inspection: Inspection, dimension: PlannedDimension) -> float:
    """Half the width of the interval that stands for the spread of the errors of one look."""
    assert dimension.T_part_camera is not None and dimension.gauge is not None  # noqa: PT018  # it has a budget
    start, end = transform(invert(dimension.T_part_camera), dimension.gauge)
    of_part = {d.id: d for d in inspection.part.dimensions}[dimension.id]
    axis = _rim_axis(of_part, dimension.gauge, dimension.T_part_camera)
    image = image_segment(start, end, inspection.camera, inspection.head, rim_axis=axis)
    angle = float(image.angle_rad)
    px_per_mm = np.linalg.norm(np.array([np.cos(angle), np.sin(angle)]) / np.asarray(inspection.camera.pixel_pitch_mm))
    return spread_mm(
        float(image.sigma_displacement_mm * px_per_mm),
        float(image.length_mm * px_per_mm),
        angle,
        float(np.linalg.norm(end - start)),
        inspection.camera,
        getattr(inspection.requirement, "sigmas", SIGMAS),
        float(np.sqrt(image.sigma_camera_mm**2 + (image.camera.half_widths_mm**2).sum() / 6) * px_per_mm),
    )


def _rim_axis(
    dimension: Dimension, gauge: NDArray[np.float64], T_part_camera: NDArray[np.float64]
) -> NDArray[np.float64]:
    """``(3,)``, camera frame: the axis of the rim that a gauge ``(2, 3)`` is a diameter of; zeros where of none."""
    return np.asarray(rim_axes([dimension.gauge_at(gauge)], T_part_camera[None])[0])
