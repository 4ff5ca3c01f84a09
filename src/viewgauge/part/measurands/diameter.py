"""The diameter of a hole or boss between opposite points of its rim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .point_pair import PointPair

__all__ = ["Diameter", "rim_axes", "stacked_rim_axes"]

_UNIT_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Diameter(PointPair):
    """The distance between two opposite points of a rim.

    Parameters
    ----------
    rim_axis
        ``(3,)`` unit normal, part frame, of the circle, where its whole rim is an outer edge, so that an edge detector
        may fit all of it; None where only the two points can be located.

    Raises
    ------
    InputError
        If the axis is not a finite unit vector.
    """

    rim_axis: NDArray[np.float64] | None = None

    kind: ClassVar[str] = "diameter"

    def __post_init__(self) -> None:
        axis = self.rim_axis
        if axis is None:
            return
        if axis.shape != (3,) or not abs(float(axis @ axis) - 1) <= _UNIT_TOLERANCE:
            raise InputError("must be a unit vector", key="rim_axis", got=axis, expected="[x, y, z] of length 1")


def stacked_rim_axes(pairs: Sequence[PointPair | None]) -> NDArray[np.float64]:
    """``(n, 3)``: the pairs' rim axes, part frame; zeros for a pair without one, and where there is no pair."""
    axes = np.zeros((len(pairs), 3))
    for row, pair in enumerate(pairs):
        if pair is not None and pair.rim_axis is not None:
            axes[row] = pair.rim_axis
    return axes


def rim_axes(pairs: Sequence[PointPair | None], T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 3)``: the rim axis of each pair in the camera frame of its pose ``(n, 4, 4)``; zeros where it has none."""
    return np.asarray(np.einsum("nji,nj->ni", T_part_camera[:, :3, :3], stacked_rim_axes(pairs)))
