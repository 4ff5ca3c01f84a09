"""The choice among many possible gauges of one dimension: robust ones first, visible from different sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..dimension import Gauge

__all__ = ["Candidate", "select"]

LIMIT = 12
_SAME_SIDE = 0.95  # cosine: views within 18 degrees are from one side
_OPPOSED = -1 + 1e-6


@dataclass(frozen=True)
class Candidate:
    """A possible gauge.

    Parameters
    ----------
    gauge
        The gauge.
    common_face
        Both its edges bound one further face.
    concave
        One of its edges is an inner corner, which is hidden from more directions than an outer one.
    straight
        Both its edges are straight.
    place
        0 for the best place of an edge pair, 1, 2, ... for further ones.
    edge_length_mm
        Length of the shorter of the two edges, mm.
    """

    gauge: Gauge
    common_face: bool
    concave: bool
    straight: bool
    place: int
    edge_length_mm: float


def select(candidates: list[Candidate], limit: int = LIMIT) -> tuple[Gauge, ...]:
    """At most ``limit`` gauges: in turn the best one left of each side from which both ends are seen.

    Within a side: ends with a common normal first, then outer corners, a common face, straight edges, the best
    place of each edge pair, and longer edges. Gauges whose ends face in opposite directions cannot be seen at
    once and are left out.
    """
    sides: list[tuple[NDArray[np.float64], list[Gauge]]] = []
    for candidate in sorted(candidates, key=_rank):
        cosine, view = _common_view(candidate.gauge)
        if cosine <= _OPPOSED:
            continue
        for direction, gauges in sides:
            if float(direction @ view) > _SAME_SIDE:
                gauges.append(candidate.gauge)
                break
        else:
            sides.append((view, [candidate.gauge]))
    chosen: list[Gauge] = []
    for turn in range(max((len(gauges) for _, gauges in sides), default=0)):
        chosen += [gauges[turn] for _, gauges in sides if turn < len(gauges)]
    return tuple(chosen[:limit])


def _rank(candidate: Candidate) -> tuple[bool, bool, bool, bool, int, float]:
    same_side = _common_view(candidate.gauge)[0] > 1 - 1e-3
    length = round(-candidate.edge_length_mm, 3)
    corner, curved = candidate.concave, not candidate.straight
    return (not same_side, corner, not candidate.common_face, curved, candidate.place, length)


def _common_view(gauge: Gauge) -> tuple[float, NDArray[np.float64]]:
    """Of all pairs of a normal at the start and one at the end, the largest cosine, and the bisector ``(3,)``."""
    cosines = gauge.start_normals @ gauge.end_normals.T
    i, j = np.unravel_index(np.argmax(np.round(cosines, 9)), cosines.shape)
    bisector = gauge.start_normals[i] + gauge.end_normals[j]
    return float(cosines[i, j]), bisector / max(float(np.linalg.norm(bisector)), np.finfo(float).tiny)
