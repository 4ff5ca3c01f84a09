"""All pairs of points by which a part is measured as arrays, for vectorised evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from .characteristic import Characteristic
from .measurands import PointPair
from .measurands.diameter import stacked_rim_axes

__all__ = ["MeasurandTable"]


@dataclass(frozen=True)
class MeasurandTable:
    """The g measurands of d characteristics, all of them pairs of points, those of one characteristic together.

    Parameters
    ----------
    points
        ``(g, 2, 3)`` mm, part frame: start and end.
    normals
        ``(g, 2, k, 3)`` outward unit normals at start and end, padded with zeros.
    whole
        ``(g,)``: the whole segment must be seen, not only its ends.
    characteristic
        ``(g,)`` index of the characteristic.
    first
        ``(d,)`` index of each characteristic's first measurand.
    rim_axis
        ``(g, 3)``: unit normal of the circle whose whole rim can be fitted; zeros, the default, where there is none.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    whole: NDArray[np.bool_]
    characteristic: NDArray[np.int64]
    first: NDArray[np.int64]
    rim_axis: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        if not len(self.rim_axis):
            object.__setattr__(self, "rim_axis", np.zeros((len(self.points), 3)))

    @classmethod
    def of(cls, characteristics: Sequence[Characteristic]) -> MeasurandTable:
        """Stack the measurands of characteristics, each of which has at least one.

        Raises
        ------
        InputError
            If a measurand is no pair of points: visibility and error laws take no other.
        """
        measurands = [
            (measurand, index)
            for index, characteristic in enumerate(characteristics)
            for measurand in characteristic.measurands
        ]
        if (other := next((g for g, _ in measurands if not isinstance(g, PointPair)), None)) is not None:
            raise InputError(
                "a table of measurands holds pairs of points",
                got=type(other).__name__,
                expected="a length or a diameter",
            )
        most = max((max(len(g.start_normals), len(g.end_normals)) for g, _ in measurands), default=1)
        points, normals = np.zeros((len(measurands), 2, 3)), np.zeros((len(measurands), 2, most, 3))
        for row, (measurand, _) in enumerate(measurands):
            points[row] = measurand.start, measurand.end
            normals[row, 0, : len(measurand.start_normals)] = measurand.start_normals
            normals[row, 1, : len(measurand.end_normals)] = measurand.end_normals
        counts = [len(characteristic.measurands) for characteristic in characteristics]
        return cls(
            points=points,
            normals=normals,
            whole=np.array([characteristics[index].observed == "whole" for _, index in measurands], dtype=bool),
            characteristic=np.array([index for _, index in measurands], dtype=np.int64),
            first=np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64) if counts else np.zeros(0, np.int64),
            rim_axis=stacked_rim_axes([measurand for measurand, _ in measurands]),
        )

    def __len__(self) -> int:
        return len(self.points)

    @property
    def length_mm(self) -> NDArray[np.float64]:
        """``(g,)`` length of each measurand, mm."""
        return np.asarray(np.linalg.norm(self.points[:, 1] - self.points[:, 0], axis=1))
