"""Views of a target that looks the same when it is turned: each turned as the robot's motion says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .board import Intrinsics
from .robot_calibration import BoardViews
from .sample_findings import rotation_angles

__all__ = ["oriented"]


def oriented(
    views: BoardViews, symmetries: Sequence[NDArray[np.int64]], points_mm: NDArray[np.float64], camera: Intrinsics
) -> BoardViews:
    """The views with the points of one orientation.

    The angle between two poses of the board in the camera is that between the two poses of the flange (their motions
    are conjugate), whatever the calibration is; of each view the turn is taken whose angles to the views before agree.

    Parameters
    ----------
    symmetries
        For each turn the id that each point takes; views must have all points.
    points_mm
        ``(k, 3)`` of the target, by id.
    """
    if len(symmetries) < 2:
        return views
    choices = [replace(views, points_mm=tuple(points_mm[ids] for _ in views.names)) for ids in symmetries]
    every = range(len(views.names))
    boards = np.array([choice.boards(every, camera) for choice in choices])
    robot = views.T_base_flange
    taken = [0]
    for k in every[1:]:
        before = np.arange(k)
        moved = rotation_angles(robot[before], np.broadcast_to(robot[k], (k, 4, 4)))
        seen = boards[taken, before]
        left = [
            np.abs(rotation_angles(seen, np.broadcast_to(turned[k], seen.shape)) - moved).sum() for turned in boards
        ]
        taken.append(int(np.argmin(left)))
    return replace(views, points_mm=tuple(points_mm[symmetries[turn]] for turn in taken))
