"""What measurands have in common whose value is the distance between two edge points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError

__all__ = ["PointPair"]


@dataclass(frozen=True)
class PointPair:
    """A pair of edge points whose distance is the value; the kinds of pairs are subclasses of it.

    Visibility and error laws take pairs: their tables have two points in each row.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, part frame.
    start_normals, end_normals
        ``(m, 3)``, m >= 1: outward unit normals of the faces that adjoin the edge at that point. The point
        can be seen only from in front of at least one of them.
    source
        Where the pair lies, in words, such as "edges 12 and 40".
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    start_normals: NDArray[np.float64]
    end_normals: NDArray[np.float64]
    source: str = ""

    kind: ClassVar[str]
    unit: ClassVar[str] = "mm"

    @classmethod
    def of(cls, points: ArrayLike, normals: Sequence[NDArray[np.float64]], source: str = "") -> Self:
        """The pair of two points ``(2, 3)`` mm, part frame, with the normals ``(m, 3)`` of the faces at each."""
        start, end = _two_points(points, many=False)
        if len(normals) != 2:
            raise InputError("each of the two points needs its faces' normals", key="normals", got=len(normals))
        return cls(start, end, normals[0], normals[1], source)

    @property
    def points(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm, part frame: start and end."""
        return np.stack([self.start, self.end])

    @property
    def normals(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The normals ``(m, 3)`` of the faces at the start, and those at the end."""
        return self.start_normals, self.end_normals

    @property
    def rim_axis(self) -> NDArray[np.float64] | None:
        """``(3,)`` unit normal of the circle whose whole rim can be fitted; None where there is no such rim."""
        return None

    @property
    def length_mm(self) -> float:
        """Distance between the two points, mm."""
        return float(np.linalg.norm(self.end - self.start))

    def value(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(...)`` mm: distance between located points ``(..., 2, 3)`` mm; 0 where they coincide."""
        p = _two_points(points)
        return np.asarray(np.linalg.norm(p[..., 1, :] - p[..., 0, :], axis=-1))

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., 2, 3)`` mm/mm: -t at the start and t at the end, t the unit direction from start to end.

        Raises
        ------
        InputError
            Where two points coincide: a distance of 0 has no derivative.
        """
        p = _two_points(points)
        run = p[..., 1, :] - p[..., 0, :]
        # scaled first: the squares of tiny and of huge coordinates are no numbers
        scale = np.abs(run).max(axis=-1, keepdims=True, initial=0.0)
        if (scale == 0).any():
            raise InputError(
                "the distance between two points that coincide has no gradient",
                key="points",
                expected="two different points",
            )
        run = run / scale
        direction = run / np.linalg.norm(run, axis=-1, keepdims=True)
        return np.stack([-direction, direction], axis=-2)


def _two_points(points: ArrayLike, *, many: bool = True) -> NDArray[np.float64]:
    p = np.asarray(points, dtype=float)
    if p.shape[-2:] != (2, 3) or not (many or p.ndim == 2):
        expected = "(..., 2, 3): start and end, mm" if many else "(2, 3): start and end, mm"
        raise InputError("must be a pair of points", key="points", got=f"shape {p.shape}", expected=expected)
    return p
