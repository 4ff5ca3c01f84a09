"""Which gauge of each dimension a setting measures it by."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from ..geometry import VIEWS
from ..visibility import OCCLUDED, VISIBLE, SightLines

__all__ = ["best_gauges"]


def best_gauges(
    views: NDArray[np.float64],
    count: int,
    reason: NDArray[np.int8],
    probability: NDArray[np.float64],
    margin: NDArray[np.float64],
    first: NDArray[np.int64],
    lines: SightLines,
    threshold: float,
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """For each dimension and setting the surest gauge that is not hidden, or the one that fails last.

    Rays are cast only where they matter: for the surest gauge first, and for the next one only if that is hidden;
    for none whose probability is under the threshold. Gauges of equal probability rank by their margin.

    Parameters
    ----------
    views, count
        The block of settings (:func:`~viewgauge.geometry.view_block`).
    reason
        ``(g, 256)`` from the culling; it is completed by what is found to be hidden.
    probability, margin
        ``(g, 256)`` from the kernel.
    first
        ``(d + 1,)``: first gauge of each dimension, and the number of gauges.

    Returns
    -------
    ``(d, 256)`` index of the gauge, and whether it is visible with at least the threshold. Where it is not the gauge
    is the one that fails at the latest condition tested.
    """
    dimensions = len(first) - 1
    best = np.zeros((dimensions, VIEWS), np.int64)
    seen = np.zeros((dimensions, VIEWS), np.bool_)
    undecided = np.zeros((dimensions, VIEWS), np.bool_)
    undecided[:, :count] = True
    place, setting, gauge = (np.empty(dimensions * VIEWS, np.int64) for _ in range(3))
    while n := _surest(probability, margin, reason, first, count, threshold, undecided, best, place, setting, gauge):
        hidden = lines.hidden(views, setting[:n], gauge[:n])
        at = place[:n]
        seen.reshape(-1)[at[~hidden]] = True
        undecided.reshape(-1)[at[~hidden]] = False
        reason[gauge[:n][hidden], setting[:n][hidden]] = OCCLUDED
    return best, seen


@numba.njit(
    "int64(float64[:,::1], float64[:,::1], int8[:,::1], int64[::1], int64, float64, boolean[:,::1], int64[:,::1], "
    "int64[::1], int64[::1], int64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _surest(  # type: ignore[no-untyped-def]
    probability, margin, reason, first, count, threshold, undecided, best, place, setting, gauge
):
    """List the surest visible gauge of undecided pairs; decide those that have none."""
    n = 0
    for d in range(len(first) - 1):
        for s in range(count):
            if not undecided[d, s]:
                continue
            top, chosen, latest = -1.0, -1, first[d]
            for g in range(first[d], first[d + 1]):
                if reason[g, s] == VISIBLE and probability[g, s] >= threshold:
                    # probabilities that are equal to the kernel's accuracy rank by the margin
                    score = probability[g, s] + 1e-9 * margin[g, s] / (1.0 + margin[g, s])
                    if score > top:
                        top, chosen = score, g
                if reason[g, s] > reason[latest, s]:
                    latest = g
            if chosen < 0:
                best[d, s], undecided[d, s] = latest, False
            else:
                best[d, s], place[n], setting[n], gauge[n] = chosen, d * VIEWS + s, s, chosen
                n += 1
    return n
