"""Widths and thicknesses: distances between parallel flat faces of one PMI record, one characteristic per feature."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ..brep import PmiRecord, Reference
from ..features.grouping import connected_groups
from ..features.outline import Outline
from ..features.parallel_planes import measurands_between, side_of
from ..measurands import PointPair
from .outcome import Derived, NotDerived, Outcome, agrees, closest, disagreement

__all__ = ["widths"]

_Pair = tuple[int, int]


def widths(outline: Outline, pmi_record: PmiRecord, faces: Sequence[int]) -> list[Outcome]:
    """One outcome per group of parallel flat faces that are the nominal distance apart and face each other.

    Pairs that share a face are one feature (a plate whose underside is divided), others are features of their
    own (a pattern of slots).
    """
    pairs = _parallel_pairs(outline, faces)
    if not pairs:
        return [NotDerived("no two of the faces are parallel planes")]
    if np.isnan(pmi_record.nominal_mm) and len(pairs) > 1:
        return [NotDerived("the file gives no nominal value, and the faces have several distances")]
    best = closest(list(pairs.values()), pmi_record)
    if not agrees(best, pmi_record):
        return [NotDerived(disagreement(best, pmi_record))]
    near = [pair for pair, value in pairs.items() if abs(value - best) <= outline.tolerance_mm]
    facing = _ribs_or_slots(outline, [pair for pair in near if _measurands(outline, [pair], best)])
    if not facing:
        return [NotDerived("no two visible edges of the faces lie opposite each other along their normal")]
    used = [face for pair in facing for face in pair]
    groups = connected_groups(used, lambda a, b: (a, b) in facing or (b, a) in facing)
    return [Derived(best, _measurands(outline, [p for p in facing if p[0] in group], best)) for group in groups]


def _parallel_pairs(outline: Outline, faces: Sequence[int]) -> dict[_Pair, float]:
    """Distances, mm, of the pairs of parallel planes in different places."""
    pairs = {}
    for a, b in combinations(faces, 2):
        origin, normal = outline.brep.faces[a].origin, outline.brep.faces[a].axis
        side = side_of(outline, Reference("face", b), normal)
        value = abs(float((side.point - origin) @ normal)) if side else 0.0
        if value > outline.tolerance_mm:
            pairs[a, b] = value
    return pairs


def _measurands(outline: Outline, pairs: Sequence[_Pair], value_mm: float) -> tuple[PointPair, ...]:
    normal = outline.brep.faces[pairs[0][0]].axis
    first, second = (
        [side for face in dict.fromkeys(faces) if (side := side_of(outline, Reference("face", face), normal))]
        for faces in zip(*pairs, strict=True)
    )
    return measurands_between(outline, first, second, normal, value_mm)


def _ribs_or_slots(outline: Outline, pairs: Sequence[_Pair]) -> list[_Pair]:
    """Only the ribs (material between the faces) or only the slots (air), where equal ribs and slots alternate.

    The kind is kept that uses more of the faces; ribs where both use all. Faces that look the same way (a step)
    belong to either.
    """
    kinds = {pair: _material_between(outline, pair) for pair in pairs}
    ribs, slots = ([pair for pair in pairs if kinds[pair] != unwanted] for unwanted in (-1, 1))
    ribs_use, slots_use = (len({face for pair in kind for face in pair}) for kind in (ribs, slots))
    return slots if slots_use > ribs_use else ribs


def _material_between(outline: Outline, pair: _Pair) -> int:
    """1 for two faces that look away from each other, -1 for two that look at each other, 0 for a step."""
    a, b = (outline.brep.faces[face] for face in pair)
    if float(a.axis @ b.axis) > 0:
        return 0
    return -1 if float((b.origin - a.origin) @ a.axis) > 0 else 1
