"""What might be measured from a cell of eye positions: a superset for every viewing direction."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Requirement, Setup
from ...part import Characteristic
from ...part.measurand_table import MeasurandTable
from ..candidates.candidate_grid import spread_directions
from ..region import Region
from .branch_and_bound import Budget, acceptable_distances, widest_tangent
from .distance_grid import DistanceGrid
from .eye_region import Faces, distance_range, first_cell
from .measurand_groups import measurand_groups

__all__ = ["AXES", "AXES_APART_RAD", "CellSets"]

AXES = 400
"""Viewing directions, spread over the sphere."""
AXES_APART_RAD = 0.14
"""No direction is farther than this from the nearest of them; a test checks it."""
_BINS = 64
_BUDGET_OF_A_LENGTH = Budget(boxes=300_000)
_PAIRS = 1 << 18  # cell x measurand at once
_NEAR = 0.5  # of the distance: larger cells are not examined direction by direction


class CellSets:
    """The sets of characteristics that might be measured from one eye position in a cell, made ready for many cells.

    A characteristic belongs to the set of a cell and a viewing direction if some measurand of it has both ends at
    distances at which the required probability is not excluded, at each end a face that can be turned to the cell, and
    both ends in the circle about the field of view for some eye in the cell and some direction near that one.
    """

    def __init__(
        self,
        characteristics: Sequence[Characteristic],
        setup: Setup,
        region: Region,
    ) -> None:
        self._measurands = measurands = MeasurandTable.of(characteristics)
        self._region = region
        self._faces = Faces(measurands.points, measurands.normals, setup.limits)
        self._half_view_rad = math.atan(widest_tangent(setup.camera, setup.limits))
        self._axes = spread_directions(AXES)
        allowed = np.array([_allowed(setup.requirement, characteristic) for characteristic in characteristics])
        self._groups: list[tuple[NDArray[np.int64], DistanceGrid]] = []
        self.examined = 0
        """Pairs of a cell, or a cell and a viewing direction, with a measurand's end, so far."""
        low, high = first_cell(region)
        for members, length, tolerance in (
            measurand_groups(measurands.length_mm, allowed[measurands.characteristic]) if len(low) else ()
        ):
            nearest, farthest = distance_range(low, high, measurands.points[members])
            anywhere = DistanceGrid(float(nearest.min()), float(farthest.max()), _BINS)
            anywhere.fill()
            accepted = acceptable_distances(
                length,
                tolerance,
                anywhere,
                setup,
                budget=_BUDGET_OF_A_LENGTH,
                rims=bool(measurands.rim_axis[members].any()),
            )
            self._groups.append((members, accepted))

    def of(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """The sets ``(m, d)`` of cells ``(n, 3)`` to ``(n, 3)`` mm, and for each the index of its cell ``(m,)``."""
        owners, sets = [np.zeros(0, np.int64)], [np.zeros((0, len(self._measurands.first)), dtype=bool)]
        step = max(_PAIRS // max(len(self._measurands), 1), 1)
        for first in range(0, len(low), step):
            part = slice(first, first + step)
            for owner, rows in self._some(low[part], high[part]):
                owners.append(owner + first)
                sets.append(rows)
        return np.concatenate(owners), np.concatenate(sets)

    def _some(
        self, low: NDArray[np.float64], high: NDArray[np.float64]
    ) -> Iterator[tuple[NDArray[np.int64], NDArray[np.bool_]]]:
        points = self._measurands.points
        self.examined += 2 * len(points) * len(low)
        nearest, farthest = distance_range(low, high, points)
        measurable = self._faces.possible(low, high, nearest) & self._region.possible(low, high)[:, None]
        for members, accepted in self._groups:
            ranges = np.stack([nearest[:, members], farthest[:, members]], axis=-1).reshape(-1, 4)
            found = accepted.any_in(accepted.rectangles(ranges))
            measurable[:, members] &= found.reshape(len(low), -1)
        some = np.flatnonzero(measurable.any(axis=1))
        middle, radius = (low + high)[some] / 2, np.linalg.norm((high - low)[some], axis=1) / 2
        measurable = measurable[some]
        sight = points - middle[:, None, None]
        distance = np.linalg.norm(sight, axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            sight /= distance[..., None]
            slack = np.arcsin(np.minimum(radius[:, None, None] / distance, 1.0))
        slack[distance <= radius[:, None, None]] = np.pi
        # all in one field of view about their mean direction, or too large a cell: one set
        mean = np.einsum("ng,ngex->nx", measurable, np.nan_to_num(sight))
        mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
        apart = np.arccos(np.clip(np.einsum("ngex,nx->nge", sight, mean), -1, 1)) - slack > self._half_view_rad
        wide = (apart.any(axis=2) & measurable).any(axis=1)
        wide &= (np.where(measurable, slack.max(axis=2), 0.0)).max(axis=1, initial=0.0) < _NEAR
        yield some[~wide], self._characteristics(measurable[~wide])
        for k in np.flatnonzero(wide):
            measurands = np.flatnonzero(measurable[k])
            sets = self._by_direction(measurands, sight[k, measurands], slack[k, measurands])
            yield np.full(len(sets), some[k]), sets

    def _by_direction(
        self, measurands: NDArray[np.int64], sight: NDArray[np.float64], slack: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Different sets ``(m, d)`` of a cell's k measurands: unit vectors to the ends ``(k, 2, 3)``, their spread,
        rad.
        """
        self.examined += 2 * len(measurands) * AXES
        reach = np.cos(np.minimum(self._half_view_rad + AXES_APART_RAD + slack, np.pi)) - 1e-9
        seen = (sight @ self._axes.T >= reach[..., None]).all(axis=1)
        characteristic = self._measurands.characteristic[measurands]
        first = np.flatnonzero(np.diff(characteristic, prepend=-1))
        sets = np.zeros((AXES, len(self._measurands.first)), dtype=bool)
        sets[:, characteristic[first]] = np.logical_or.reduceat(seen, first, axis=0).T
        _, which = np.unique(np.packbits(sets, axis=1), axis=0, return_index=True)
        return np.asarray(sets[which[sets[which].any(axis=1)]])

    def _characteristics(self, measurands: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """``(m, d)`` from ``(m, g)``: some measurand of the characteristic."""
        return np.asarray(np.logical_or.reduceat(measurands, self._measurands.first, axis=1))


def _allowed(requirement: Requirement, characteristic: Characteristic) -> float:
    allowed = requirement.allowed_error_mm(characteristic.nominal_mm, characteristic.tolerance_mm)
    return 0.0 if allowed is None else allowed
