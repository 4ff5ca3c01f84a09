"""From which directions one characteristic is measured, and with which probability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Evaluator
from ...geometry import look_at
from ...visibility import REASONS
from .candidate_grid import spread_directions

__all__ = ["DirectionMap", "map_directions"]


@dataclass(frozen=True)
class DirectionMap:
    """The probability of a characteristic for a camera that is aimed at its middle from all around.

    Parameters
    ----------
    characteristic
        Its id.
    target_mm, distance_mm
        ``(3,)`` mm, part frame: what the camera is aimed at; and from how far.
    directions
        ``(n, 3)`` unit vectors, part frame, from the part to the camera, spread uniformly over the sphere.
    probability
        ``(n,)``: of the best roll; 0 where it is not seen.
    reason
        ``(n,)`` names: why it is not seen; empty where it is.
    T_part_camera
        ``(n, 4, 4)`` mm: the poses of these probabilities.
    """

    characteristic: str
    target_mm: NDArray[np.float64]
    distance_mm: float
    directions: NDArray[np.float64]
    probability: NDArray[np.float64]
    reason: NDArray[np.str_]
    T_part_camera: NDArray[np.float64]


def map_directions(evaluator: Evaluator, distance_mm: float, *, directions: int = 900, rolls: int = 2) -> DirectionMap:
    """The map of the evaluator's only characteristic from one distance.

    Parameters
    ----------
    rolls
        Rotations about the optical axis that are tried, spread over half a turn.
    """
    (characteristic,) = evaluator.characteristics
    target = np.mean([(measurand.start + measurand.end) / 2 for measurand in characteristic.measurands], axis=0)
    sphere = spread_directions(directions)
    eyes = np.repeat(target + distance_mm * sphere, rolls, axis=0)
    poses = look_at(eyes, np.broadcast_to(target, eyes.shape), np.tile(np.arange(rolls) * np.pi / rolls, directions))
    table = evaluator.table(poses)
    probability = table.probability[:, 0].reshape(directions, rolls)
    # of rolls that see it the most probable; of those that do not the one that fails last
    best = np.argmax(probability + table.reason[:, 0].reshape(directions, rolls), axis=1)
    rows = np.arange(directions) * rolls + best
    return DirectionMap(
        characteristic.id,
        target,
        distance_mm,
        sphere,
        table.probability[rows, 0],
        np.array(REASONS)[table.reason[rows, 0]],
        poses[rows],
    )
