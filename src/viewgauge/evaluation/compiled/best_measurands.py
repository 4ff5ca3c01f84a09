"""Which measurand of each characteristic a viewpoint measures it by."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from ...geometry import VIEWS
from ...visibility import OCCLUDED, VISIBLE, SightLines

__all__ = ["best_measurands"]


def best_measurands(
    views: NDArray[np.float64],
    count: int,
    reason: NDArray[np.int8],
    probability: NDArray[np.float64],
    margin: NDArray[np.float64],
    first: NDArray[np.int64],
    lines: SightLines,
    threshold: float,
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """For each characteristic and viewpoint the most probable measurand that is not hidden, or the one that fails last.

    Rays are cast only where they matter: for the most probable measurand first, and for the next one only if that is
    hidden; for none whose probability is under the threshold. Measurands of equal probability rank by their margin.

    Parameters
    ----------
    views, count
        The block of viewpoints (:func:`~viewgauge.geometry.view_block`).
    reason
        ``(g, 256)`` from the culling; it is completed by what is found to be hidden.
    probability, margin
        ``(g, 256)`` from the kernel.
    first
        ``(d + 1,)``: first measurand of each characteristic, and the number of measurands.

    Returns
    -------
    ``(d, 256)`` index of the measurand, and whether it is visible with at least the threshold. Where it is not the
    measurand is the one that fails at the latest condition tested.
    """
    characteristics = len(first) - 1
    best, seen = np.zeros((characteristics, VIEWS), np.int64), np.zeros((characteristics, VIEWS), np.bool_)
    place = np.empty(characteristics * VIEWS, np.int64)
    n = _best_of_all(probability, margin, reason, first, count, threshold, best, place)
    while n:
        undecided = place[:n]
        characteristic, viewpoint = np.divmod(undecided, VIEWS)
        measurand = best[characteristic, viewpoint]
        hidden = lines.hidden(views, viewpoint, measurand)
        seen.reshape(-1)[undecided[~hidden]] = True
        reason[measurand[hidden], viewpoint[hidden]] = OCCLUDED
        left = undecided[hidden]
        n = _best_of(left, probability, margin, reason, first, threshold, best, place)
    return best, seen


@numba.njit(error_model="numpy", forceinline=True)
def _score(probability, margin, reason, threshold):  # type: ignore[no-untyped-def]
    """What measurands rank by: the probability; if that is equal to the kernel's accuracy, the margin."""
    counts = (reason == VISIBLE) & (probability >= threshold)
    return probability + 1e-9 * margin / (1.0 + margin) if counts else -1.0


@numba.njit(
    "int64(float64[:,::1], float64[:,::1], int8[:,::1], int64[::1], int64, float64, int64[:,::1], int64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _best_of_all(probability, margin, reason, first, count, threshold, best, place):  # type: ignore[no-untyped-def]
    """The most probable visible measurand of each characteristic, else the one that fails last; lists the places of the
    former.
    """
    top, latest = np.empty(VIEWS), np.empty(VIEWS)
    chosen, last = np.empty(VIEWS), np.empty(VIEWS)  # measurands, as floats: loops over one type are compiled best
    n = 0
    for d in range(len(first) - 1):
        top[:], latest[:] = -1.0, -1.0
        for g in range(first[d], first[d + 1]):
            for s in range(count):
                score = _score(probability[g, s], margin[g, s], reason[g, s], threshold)
                chosen[s] = g if score > top[s] else chosen[s]
                top[s] = max(score, top[s])
                code = float(reason[g, s])
                last[s] = g if code > latest[s] else last[s]
                latest[s] = max(code, latest[s])
        for s in range(count):
            best[d, s] = int(chosen[s]) if top[s] >= 0.0 else int(last[s])
            place[n] = d * VIEWS + s
            n += top[s] >= 0.0
    return n


@numba.njit(
    "int64(int64[::1], float64[:,::1], float64[:,::1], int8[:,::1], int64[::1], float64, int64[:,::1], int64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _best_of(left, probability, margin, reason, first, threshold, best, place):  # type: ignore[no-untyped-def]
    """The same for some places only."""
    n = 0
    for k in left:
        d, s = k // VIEWS, k % VIEWS
        top, latest, chosen = -1.0, -1, -1
        for g in range(first[d], first[d + 1]):
            score = _score(probability[g, s], margin[g, s], reason[g, s], threshold)
            if score > top:
                top, chosen = score, g
            if latest < 0 or reason[g, s] > reason[latest, s]:
                latest = g
        if chosen >= 0:
            best[d, s], place[n] = chosen, k
            n += 1
        else:
            best[d, s] = latest
    return n
