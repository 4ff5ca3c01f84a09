"""The laws of the error of each dimension of a plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..evaluation import GaugeLaws
from ..geometry import PoseError, invert, transform
from ..part.characteristic import Gauge, rim_axes
from ..planning import Plan
from ..planning.inspection import Inspection
from ..sensors import Camera

__all__ = ["gauge_laws", "laws_of_look"]


def gauge_laws(inspection: Inspection, plan: Plan) -> dict[str, GaugeLaws]:
    """By the dimension's id: of the setting that measures it, of the mean of several looks, or of the best pose tried.

    Dimensions that are seen from nowhere, or cannot be measured, have none.
    """
    of_part = {dimension.id: dimension for dimension in inspection.part.dimensions}
    poses = {setting.id: setting.T_part_camera for setting in plan.settings}
    found = {}
    for planned in plan.dimensions:
        if planned.looks:
            at = np.array([poses[look.setting] for look in planned.looks])
            ends = np.array([look.gauge for look in planned.looks])
            gauges = [of_part[planned.id].gauge_at(gauge) for gauge in ends]
            points = transform(invert(at)[:, None], ends)
            laws = GaugeLaws.of_mean(points, inspection.camera, inspection.head, rim_axes(gauges, at))
            found[planned.id] = laws
        elif planned.T_part_camera is not None and planned.gauge is not None:
            chosen = of_part[planned.id].gauge_at(planned.gauge)
            found[planned.id] = laws_of_look(
                planned.gauge, chosen, planned.T_part_camera, inspection.camera, inspection.head
            )
    return found


def laws_of_look(
    ends_mm: NDArray[np.float64],
    gauge: Gauge | None,
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    head: PoseError,
) -> GaugeLaws:
    """Of one look at a gauge with ends ``(2, 3)`` mm, part frame; ``gauge`` knows the rim it is a diameter of."""
    axis = rim_axes([gauge], T_part_camera[None])[0]
    return GaugeLaws.of_look(transform(invert(T_part_camera), ends_mm), camera, head, axis)
