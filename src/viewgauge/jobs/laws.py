"""The laws of the error of each characteristic of a plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..evaluation import MeasurandLaws
from ..geometry import PoseError, invert, transform
from ..part import PointPair, rim_axes
from ..planning import Plan
from ..planning.inspection import Inspection
from ..sensors import Camera

__all__ = ["laws_of_acquisition", "measurand_laws"]


def measurand_laws(inspection: Inspection, plan: Plan) -> dict[str, MeasurandLaws]:
    """By the characteristic's id: of the viewpoint that measures it, of the mean of several viewpoints, or of the best
    pose tried.

    Characteristics that are seen from nowhere, or cannot be measured, have none.
    """
    of_part = {characteristic.id: characteristic for characteristic in inspection.part.characteristics}
    poses = {viewpoint.id: viewpoint.T_part_camera for viewpoint in plan.viewpoints}
    found = {}
    for planned in plan.characteristics:
        if planned.acquisitions:
            at = np.array([poses[acquisition.viewpoint] for acquisition in planned.acquisitions])
            ends = np.array([acquisition.measurand for acquisition in planned.acquisitions])
            measurands = [of_part[planned.id].measurand_at(measurand) for measurand in ends]
            points = transform(invert(at)[:, None], ends)
            laws = MeasurandLaws.of_mean(points, inspection.camera, inspection.pose_error, rim_axes(measurands, at))
            found[planned.id] = laws
        elif planned.T_part_camera is not None and planned.measurand is not None:
            chosen = of_part[planned.id].measurand_at(planned.measurand)
            found[planned.id] = laws_of_acquisition(
                planned.measurand, chosen, planned.T_part_camera, inspection.camera, inspection.pose_error
            )
    return found


def laws_of_acquisition(
    ends_mm: NDArray[np.float64],
    measurand: PointPair | None,
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    pose_error: PoseError,
) -> MeasurandLaws:
    """The laws of one image of a measurand with ends ``(2, 3)`` mm, part frame; ``measurand`` knows the rim it is a
    diameter of.
    """
    axis = rim_axes([measurand], T_part_camera[None])[0]
    return MeasurandLaws.of_acquisition(transform(invert(T_part_camera), ends_mm), camera, pose_error, axis)
