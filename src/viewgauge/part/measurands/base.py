"""The protocol that every measurand fulfils: edge points, and a value with its gradient computed from them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Measurand"]


@runtime_checkable
class Measurand(Protocol):
    """A quantity that is computed from k located edge points.

    The error of a measured value is, to first order, ``sum_j gradient_j . d_j`` with ``d_j`` the error of edge point
    j, mm, part frame. Whoever predicts, simulates or measures needs no more of a measurand than this.
    """

    kind: ClassVar[str]
    """Name under which the class is registered, such as "length"."""

    unit: ClassVar[str]
    """Unit of the value, "mm" or "rad"; the gradient is in this unit per mm."""

    @classmethod
    def of(cls, points: ArrayLike, normals: Sequence[NDArray[np.float64]], source: str = "") -> Self:
        """The measurand on edge points ``(k, 3)`` mm, part frame, with the normals of the faces at each."""
        ...

    @property
    def points(self) -> NDArray[np.float64]:
        """``(k, 3)`` mm, part frame: the edge points where the drawing has them."""
        ...

    @property
    def normals(self) -> tuple[NDArray[np.float64], ...]:
        """k arrays ``(m, 3)``, m >= 1: outward unit normals of the faces that adjoin the edge at each point.

        A point can be seen only from in front of at least one of its faces.
        """
        ...

    @property
    def source(self) -> str:
        """Where the measurand lies, in words, such as "edges 12 and 40"."""
        ...

    def value(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(...)``: the value at located edge points ``(..., k, 3)`` mm, in any one frame."""
        ...

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """``(..., k, 3)``: derivative of :meth:`value` with respect to each located edge point, same frame.

        Raises
        ------
        InputError
            Where the value has no derivative.
        """
        ...
