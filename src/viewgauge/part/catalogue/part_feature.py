"""A feature of the part as a person would point at it, and the protocol of what finds one kind of features."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..brep import Reference
from ..features.outline import Outline

__all__ = ["FeatureKind", "PartFeature"]


@dataclass(frozen=True)
class PartFeature:
    """A feature with its sizes and its place.

    Parameters
    ----------
    kind
        Name of its kind, such as "hole".
    references
        The faces and edges that it consists of.
    position
        ``(3,)`` mm, part frame: the middle of it.
    direction
        ``(3,)`` unit vector: outward normal of a plane, direction of an edge, axis of a hole, across a slot.
    sizes_mm
        Its sizes by their names, such as ``{"diameter": 9.0, "depth": 16.0}``.
    id
        Such as "H1"; empty as long as it has no place in a catalogue.
    """

    kind: str
    references: tuple[Reference, ...]
    position: NDArray[np.float64]
    direction: NDArray[np.float64]
    sizes_mm: Mapping[str, float] = field(default_factory=dict)
    id: str = ""


class FeatureKind(Protocol):
    """Finds the features of one kind."""

    @property
    def name(self) -> str:
        """The kind, as messages call it: "hole"."""
        ...

    @property
    def letter(self) -> str:
        """With which the ids of this kind begin."""
        ...

    def find(self, outline: Outline) -> list[PartFeature]:
        """All features of the kind, in any order, without ids."""
        ...
