"""Characteristics that are stated on features by their ids: the same derivers as for PMI make their measurands."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan

from ...exceptions import InputError
from ..brep import PmiRecord
from ..characteristics.derivers import deriver_of
from ..characteristics.outcome import NotDerived, Outcome
from .catalogue import Catalogue
from .part_feature import PartFeature

__all__ = ["outcome_on_features"]

_ROUND = ("hole", "boss")


def outcome_on_features(catalogue: Catalogue, kind: str, ids: Sequence[str]) -> Outcome:
    """What can be measured of a distance between two features, or of the diameter of one.

    Parameters
    ----------
    kind
        "distance" or "diameter".
    ids
        Two ids for a distance, one for a diameter.

    Raises
    ------
    InputError
        If there is no feature of an id, if the two are the same, or if a diameter is of no hole or boss.
    """
    features = [catalogue.feature(name) for name in ids]
    if kind == "diameter" and features[0].kind not in _ROUND:
        raise InputError(
            "only a hole or a boss has a diameter", got=f"{ids[0]}, a {features[0].kind}", expected="an H or a B"
        )
    if len(features) == 2 and ids[0] == ids[1]:
        raise InputError("the two features are the same", got=f"{ids[0]} twice", expected="two different features")
    if kind == "distance" and any(feature.kind == "slot" for feature in features):
        raise InputError(
            "a slot is two planes already",
            got=", ".join(ids),
            expected="planes, edges, holes or bosses",
            hint="state its width as the distance of its two planes, which `viewgauge features` names",
        )
    deriver = deriver_of(kind)
    if deriver is None:
        return NotDerived(f"nothing measures a {kind}")
    outcomes = deriver(catalogue.outline, _record(kind, features))
    return outcomes[0] if len(outcomes) == 1 else NotDerived(f"{', '.join(ids)} is not one feature but {len(outcomes)}")


def _record(kind: str, features: Sequence[PartFeature]) -> PmiRecord:
    """The PMI record that would say the same; its value is the geometry's."""
    second = features[1].references if len(features) > 1 else ()
    return PmiRecord("", kind, kind, nan, None, features[0].references, second)
