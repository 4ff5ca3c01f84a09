"""What a condition on the camera's pose must be able to do to be a member of the allowed region."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ...part import Mesh

__all__ = ["UNLIMITED", "Region", "RegionMember", "Workpiece", "eyes_of"]

UNLIMITED = np.array([[-np.inf] * 3, [np.inf] * 3])
"""``(2, 3)`` mm: the bounds of a region that limits no coordinate of the eye."""
UNLIMITED.flags.writeable = False


@dataclass(frozen=True, eq=False)
class Workpiece:
    """What a condition may refer to.

    Parameters
    ----------
    mesh
        The part's surface, mm, part frame.
    middle_mm
        ``(3,)`` mm, part frame: the middle of all measurands.
    """

    mesh: Mesh
    middle_mm: NDArray[np.float64]


class Region(Protocol):
    """A set of camera poses, with an outer bound for boxes of eye positions.

    The eye is the camera's centre of projection. All positions are in the part frame, mm.
    """

    @property
    def bounds(self) -> NDArray[np.float64]:
        """``(2, 3)`` mm: lowest and highest corner of a box outside of which no eye is allowed (:data:`UNLIMITED`)."""
        ...

    def allows(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: whether poses ``(n, 4, 4)`` mm are allowed."""
        ...

    def possible(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """``(n,)``: False only where no pose is allowed whose eye is in the box between corners ``(n, 3)`` mm.

        Bounds over all poses rest on this: it may be True too often, never False too often. Low and high may be equal.
        """
        ...


@runtime_checkable
class RegionMember(Protocol):
    """A condition on the camera's pose as the user states it, before the part is known.

    A member is a frozen dataclass of plain numbers: two inspections are the same job only if their members print the
    same. To add a kind, write one; pass it to :class:`~viewgauge.CandidateOptions`, and give it a key in the
    inspection file by registering a section (:mod:`viewgauge.formats.inspection.region_section`).

    Attributes
    ----------
    key
        Its key in the section ``candidates`` of the inspection file.
    outside
        Where a camera is that this member does not allow, for messages, such as "outside the box".
    clears_part
        It keeps the camera out of the part, so that the camera need not keep out of the part's bounding box too.
    """

    key: ClassVar[str]
    outside: ClassVar[str]
    clears_part: ClassVar[bool] = False

    def region(self, workpiece: Workpiece) -> Region:
        """The poses that this member allows around a part."""
        ...


def eyes_of(T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 3)`` mm: the centres of projection of poses ``(n, 4, 4)``."""
    return T_part_camera[:, :3, 3]
