"""The choice among many possible measurands of one characteristic: robust ones first, visible from different sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .point_pair import PointPair

__all__ = ["LIMIT", "Candidate", "select"]

LIMIT = 12
_SAME_SIDE = 0.95  # cosine: views within 18 degrees are from one side
_SAME_NORMAL = 1 - 1e-3  # within 2.6 degrees
_OPPOSED = -1 + 1e-6


@dataclass(frozen=True)
class Candidate:
    """A possible measurand.

    Parameters
    ----------
    measurand
        The measurand.
    common_face
        Both its edges bound one further face.
    concave
        One of its edges is an inner corner, which is hidden from more directions than an outer one.
    straight
        Both its edges are straight.
    at_corner
        Its ends are corners of the part, located less sharply than places along an edge.
    place
        0 for the best place of an edge pair, 1, 2, ... for further ones.
    edge_length_mm
        Length of the shorter of the two edges, mm.
    """

    measurand: PointPair
    common_face: bool
    concave: bool
    straight: bool
    at_corner: bool
    place: int
    edge_length_mm: float


def select(candidates: list[Candidate], limit: int = LIMIT) -> tuple[PointPair, ...]:
    """At most ``limit`` measurands: in turn one of each side from which both ends are seen, as long as it has any.

    Within a side: ends with a common normal first, then outer corners, a common face, straight edges, and
    places along an edge rather than its end; among equals the one farthest from those already chosen; the first
    is the best place of the longest edges. Measurands whose ends face in opposite directions cannot be seen at once
    and are left out.
    """
    ranked = sorted((candidate for candidate in candidates if _can_be_seen(candidate.measurand)), key=_rank)
    classes = [_class(candidate) for candidate in ranked]
    sides = _by_side([candidate.measurand for candidate in ranked])
    ends = np.array([(candidate.measurand.start, candidate.measurand.end) for candidate in ranked]).reshape(-1, 2, 3)
    apart_mm = np.full(len(ranked), np.inf)
    chosen: list[int] = []
    while len(chosen) < limit and any(sides):
        for side in sides:
            if not side or len(chosen) == limit:
                continue
            equals = [index for index in side if classes[index] == classes[side[0]]]
            best = equals[int(np.argmax(np.round(apart_mm[equals], 3)))]
            side.remove(best)
            chosen.append(best)
            apart_mm = np.minimum(apart_mm, _distance(ends, ends[best]))
    return tuple(ranked[index].measurand for index in chosen)


def _can_be_seen(measurand: PointPair) -> bool:
    """Whether both ends have a normal, and not only opposite ones."""
    return len(measurand.start_normals) > 0 < len(measurand.end_normals) and _common_view(measurand)[0] > _OPPOSED


def _by_side(measurands: list[PointPair]) -> list[list[int]]:
    """Indices of the measurands that are seen from one side, for each side, in the order of the measurands."""
    sides: list[tuple[NDArray[np.float64], list[int]]] = []
    for index, measurand in enumerate(measurands):
        _, view = _common_view(measurand)
        for direction, members in sides:
            if float(direction @ view) > _SAME_SIDE:
                members.append(index)
                break
        else:
            sides.append((view, [index]))
    return [members for _, members in sides]


def _class(candidate: Candidate) -> tuple[bool, bool, bool, bool, bool]:
    """What makes a measurand less robust, the worst first."""
    same_normal = _common_view(candidate.measurand)[0] > _SAME_NORMAL
    return (
        not same_normal,
        candidate.concave,
        not candidate.common_face,
        not candidate.straight,
        candidate.at_corner,
    )


def _rank(candidate: Candidate) -> tuple[tuple[bool, ...], int, float]:
    return (_class(candidate), candidate.place, round(-candidate.edge_length_mm, 3))


def _distance(ends: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far measurands ``(n, 2, 3)`` are from another ``(2, 3)``, mm: the sum at both ends, either way round."""
    same, swapped = (np.linalg.norm(ends - turned, axis=2).sum(axis=1) for turned in (other, other[::-1]))
    return np.asarray(np.minimum(same, swapped))


def _common_view(measurand: PointPair) -> tuple[float, NDArray[np.float64]]:
    """Of all pairs of a normal at the start and one at the end, the largest cosine, and the bisector ``(3,)``."""
    cosines = measurand.start_normals @ measurand.end_normals.T
    i, j = np.unravel_index(np.argmax(np.round(cosines, 9)), cosines.shape)
    bisector = measurand.start_normals[i] + measurand.end_normals[j]
    return float(cosines[i, j]), bisector / max(float(np.linalg.norm(bisector)), np.finfo(float).tiny)
