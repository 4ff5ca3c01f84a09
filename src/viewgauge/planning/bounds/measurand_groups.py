"""Measurands of one length and one allowed error: a bound of one is a bound of all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["MeasurandGroup", "measurand_groups"]

_SAME = 1e-6  # relative: closer lengths are bounded together

MeasurandGroup = tuple[NDArray[np.int64], tuple[float, float], float]
"""Indices of the measurands, their least and largest length in mm, and their largest relative tolerance."""


def measurand_groups(length_mm: NDArray[np.float64], allowed_error_mm: NDArray[np.float64]) -> list[MeasurandGroup]:
    """Part measurands ``(g,)`` into groups of about equal length and about equal allowed error."""
    order = np.lexsort((length_mm, allowed_error_mm))
    groups: list[MeasurandGroup] = []
    first = 0
    for last in range(1, len(order) + 1):
        if (
            last < len(order)
            and all(
                values[order[last]] <= values[order[first]] * (1 + _SAME) for values in (length_mm, allowed_error_mm)
            )
            and length_mm[order[last]] * (1 + _SAME) >= length_mm[order[first]]
        ):
            continue
        members = order[first:last]
        lengths = length_mm[members]
        tolerance = float((allowed_error_mm[members] / lengths).max())
        groups.append((np.sort(members), (float(lengths.min()), float(lengths.max())), tolerance))
        first = last
    return groups
