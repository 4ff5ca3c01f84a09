"""The length between two edge points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from .point_pair import PointPair

__all__ = ["LengthBetweenPoints"]


@dataclass(frozen=True)
class LengthBetweenPoints(PointPair):
    """The distance between two edge points, located each by itself."""

    kind: ClassVar[str] = "length"
