"""Observability: whether a measurand can be observed from a viewpoint, and the reason where it cannot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry import VIEWS, view_block
from ..part.measurand_table import MeasurandTable
from ..sensors import Camera
from .culling import OCCLUDED, VISIBLE, Culling
from .limits import ObservationLimits
from .occlusion import Occluder, SightLines

__all__ = ["observe"]


def observe(
    T_part_camera: NDArray[np.float64],
    measurands: MeasurandTable,
    camera: Camera,
    occluder: Occluder,
    limits: ObservationLimits,
) -> NDArray[np.int8]:
    """Test every measurand from every viewpoint.

    The conditions, in this order: both ends in front of the camera; both inside the image less a margin; at each
    end at least one adjoining face turned to the camera; image long enough; both ends in focus; not hidden by
    the part (both ends, or the whole segment where the characteristic asks for it). Occlusion, the costly one, is
    last and only tested where nothing else fails.

    Parameters
    ----------
    T_part_camera
        ``(n, 4, 4)`` mm.

    Returns
    -------
    ``(n, g)`` index into :data:`~viewgauge.visibility.REASONS`: the first condition that fails, or the last index
    where the measurand is visible.
    """
    culling, lines = Culling(measurands, camera, limits), SightLines(measurands, occluder)
    reasons = np.empty((len(T_part_camera), len(measurands)), np.int8)
    for first in range(0, len(T_part_camera), VIEWS):
        poses = T_part_camera[first : first + VIEWS]
        views = view_block(poses)
        reason = culling.reasons(views, len(poses))[:, : len(poses)].T
        viewpoint, measurand = np.nonzero(reason == VISIBLE)
        hidden = lines.hidden(views, viewpoint, measurand)
        reason[viewpoint[hidden], measurand[hidden]] = OCCLUDED
        reasons[first : first + VIEWS] = reason
    return reasons
