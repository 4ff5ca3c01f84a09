"""All features of a part with their ids.

Ids follow the place of the features: x, then y, then z of their middles, then their directions, each to a micrometre.
So they are the same for every file of the same geometry, whatever the order of its records.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...exceptions import InputError
from ..brep import Brep
from ..features.outline import Outline
from .part_feature import FeatureKind, PartFeature
from .planes import Planes
from .round_features import Bosses, Holes
from .slots import Slots
from .straight_edges import StraightEdges

__all__ = ["FEATURE_KINDS", "Catalogue", "catalogue_of"]

FEATURE_KINDS: list[FeatureKind] = [Planes(), StraightEdges(), Holes(), Bosses(), Slots()]
"""A further kind is a class like :class:`FeatureKind` in a file of its own, and its place here."""

_ORDER_DECIMALS = 3  # mm
_NEAREST = 8  # ids in a message


@dataclass(frozen=True)
class Catalogue:
    """The features of a part.

    Parameters
    ----------
    outline
        The part.
    features
        All of them, by kind, then by place.
    """

    outline: Outline
    features: tuple[PartFeature, ...]

    @cached_property
    def _by_id(self) -> dict[str, PartFeature]:
        return {feature.id: feature for feature in self.features}

    def of_kind(self, kind: str) -> list[PartFeature]:
        """The features of one kind, in the order of their ids."""
        return [feature for feature in self.features if feature.kind == kind]

    def feature(self, name: str) -> PartFeature:
        """The feature with this id.

        Raises
        ------
        InputError
            If there is none.
        """
        if name in self._by_id:
            return self._by_id[name]
        ranges = [
            f"{kind.letter}1 to {kind.letter}{n}" for kind in FEATURE_KINDS if (n := len(self.of_kind(kind.name)))
        ]
        raise InputError(
            "the part has no feature of this id",
            got=name,
            expected=", ".join(ranges) or "no id: the part has no features",
            hint="`viewgauge features` with the part's file lists them",
        )


def catalogue_of(brep: Brep) -> Catalogue:
    """The features of a B-rep."""
    outline = Outline(brep)
    features: list[PartFeature] = []
    for kind in FEATURE_KINDS:
        found = sorted(kind.find(outline), key=_place)
        features += [replace(feature, id=f"{kind.letter}{k}") for k, feature in enumerate(found, start=1)]
    return Catalogue(outline, tuple(features))


def _place(feature: PartFeature) -> tuple[float, ...]:
    sizes = tuple(feature.sizes_mm.values())
    return tuple((np.round([*feature.position, *feature.direction, *sizes], _ORDER_DECIMALS) + 0.0).tolist())
