"""The error budget and the capability figures of every characteristic of a plan."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..evaluation import CapabilityFigures, capability_figures, image_segment, spread_mm
from ..evaluation.error_budget import ErrorBudget, averaged_error_budget, error_budget
from ..evaluation.requirement.capability_indices import SIGMAS
from ..geometry import invert, transform
from ..part import Characteristic, rim_axes
from ..planning import Plan, PlannedCharacteristic
from ..planning.inspection import Inspection

__all__ = ["capability_of_characteristics", "error_budgets"]


def error_budgets(inspection: Inspection, plan: Plan) -> dict[str, ErrorBudget]:
    """What causes the uncertainty of each characteristic of a plan, at first order.

    Of a characteristic that is not met at the best pose that was tried; of one that is averaged of the mean of its
    acquisitions. Characteristics that are seen from nowhere, or cannot be measured, have none.

    Parameters
    ----------
    plan
        Of this inspection.

    Returns
    -------
    By the characteristic's id; each of one segment, so its arrays have the shapes that
    :class:`~viewgauge.evaluation.error_budget.ErrorBudget` states without leading axes.
    """
    camera, pose_error = inspection.camera, inspection.pose_error
    of_part = {characteristic.id: characteristic for characteristic in inspection.part.characteristics}
    poses = {viewpoint.id: viewpoint.T_part_camera for viewpoint in plan.viewpoints}
    found = {}
    for characteristic in plan.characteristics:
        if characteristic.acquisitions:
            points = np.array(
                [
                    transform(invert(poses[acquisition.viewpoint]), acquisition.measurand)
                    for acquisition in characteristic.acquisitions
                ]
            )
            axes = np.array(
                [
                    _rim_axis(of_part[characteristic.id], acquisition.measurand, poses[acquisition.viewpoint])
                    for acquisition in characteristic.acquisitions
                ]
            )
            found[characteristic.id] = averaged_error_budget(
                points, camera, pose_error, characteristic.allowed_error_mm, axes
            )
        elif characteristic.T_part_camera is not None and characteristic.measurand is not None:
            start, end = transform(invert(characteristic.T_part_camera), characteristic.measurand)
            tolerance = characteristic.allowed_error_mm / float(np.linalg.norm(end - start))
            axis = _rim_axis(of_part[characteristic.id], characteristic.measurand, characteristic.T_part_camera)
            found[characteristic.id] = error_budget(start, end, camera, pose_error, tolerance, axis)
    return found


def capability_of_characteristics(
    inspection: Inspection, plan: Plan, budgets: Mapping[str, ErrorBudget] | None = None
) -> dict[str, CapabilityFigures]:
    """Expanded uncertainty, %P/T, Cg, Cgk, TUR and risks of the same characteristics, by id.

    Parameters
    ----------
    budgets
        Of the plan, where they are known already.
    """
    found = {}
    of_plan = {characteristic.id: characteristic for characteristic in plan.characteristics}
    for name, budget in (error_budgets(inspection, plan) if budgets is None else budgets).items():
        characteristic, u = of_plan[name], float(budget.combined_uncertainty_mm)
        if u > 0:
            half = None if characteristic.acquisitions else _spread_mm(inspection, characteristic)
            found[name] = capability_figures(u, characteristic.tolerance_mm, inspection.requirement, half)
    return found


def _spread_mm(inspection: Inspection, characteristic: PlannedCharacteristic) -> float:
    """Half the width of the interval that stands for the spread of the errors of one acquisition."""
    assert characteristic.T_part_camera is not None and characteristic.measurand is not None  # noqa: PT018  # it has a budget
    start, end = transform(invert(characteristic.T_part_camera), characteristic.measurand)
    of_part = {d.id: d for d in inspection.part.characteristics}[characteristic.id]
    axis = _rim_axis(of_part, characteristic.measurand, characteristic.T_part_camera)
    image = image_segment(start, end, inspection.camera, inspection.pose_error, rim_axis=axis)
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
    characteristic: Characteristic, measurand: NDArray[np.float64], T_part_camera: NDArray[np.float64]
) -> NDArray[np.float64]:
    """``(3,)``, camera frame: the axis of the rim that a measurand ``(2, 3)`` is a diameter of; zeros where of none."""
    return np.asarray(rim_axes([characteristic.measurand_at(measurand)], T_part_camera[None])[0])
