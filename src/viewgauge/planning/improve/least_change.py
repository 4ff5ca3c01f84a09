"""By how much an error must be less, or may be more, for characteristics to be met from some of given viewpoints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import Evaluator

__all__ = ["SHORT", "Interval", "Threshold", "largest_factor", "meeting", "met_interval"]

SHORT = 1e-3
"""Relative: so much short of an answer the requirement is not met."""

_PRECISION = SHORT / 4
_SMALLEST, _LARGEST = 2.0**-10, 2.0**10

EvaluatorAt = Callable[[float], Evaluator]
"""The evaluator with an error multiplied by a factor; with 0 it is not there."""


@dataclass(frozen=True)
class Threshold:
    """The largest factor of an error with which characteristics are met.

    Parameters
    ----------
    factor
        None where they are not met with any down to 1/1024; 1024 stands for all from there on.
    rows
        Viewpoints of those given that are worth asking just there.
    """

    factor: float | None
    rows: NDArray[np.int64]

    @property
    def unlimited(self) -> bool:
        """Met at the largest factor that is tried."""
        return self.factor == _LARGEST


@dataclass(frozen=True)
class Interval:
    """An interval of factors in which characteristics are met, that nearest to 1; an end is None where nothing ends
    it.
    """

    low: float | None
    high: float | None


def meeting(evaluator: Evaluator, T_part_camera: NDArray[np.float64]) -> NDArray[np.bool_]:
    """``(n, d)``: viewpoints ``(n, 4, 4)`` mm from which a characteristic is met, and the small-error model answers for
    it.
    """
    if not len(T_part_camera):
        return np.zeros((0, len(evaluator.characteristics)), dtype=bool)
    accepted = evaluator.accepted(T_part_camera)
    some = accepted.probability > 0
    met = some & accepted.certain
    rows = np.flatnonzero((some & ~met).any(axis=1))
    if len(rows):  # what is not beyond doubt is evaluated in full
        table = evaluator.table(T_part_camera[rows])
        met[rows] = table.visible & (table.probability >= evaluator.required) & (table.validity == 0)
    return met


def largest_factor(evaluator_at: EvaluatorAt, T_part_camera: NDArray[np.float64]) -> Threshold:
    """The largest factor with which all characteristics of the evaluator are met, each from some viewpoint.

    A viewpoint from which nothing is met with one factor is not asked about larger ones: less of an error is better.
    """
    every = np.arange(len(T_part_camera))

    def asked(factor: float, rows: NDArray[np.int64]) -> NDArray[np.int64] | None:
        met = meeting(evaluator_at(factor), T_part_camera[rows])
        return rows[met.any(axis=1)] if met.any(axis=0).all() else None

    low, rows, found = 1.0, every, asked(1.0, every)
    if found is not None:
        rows, high = found, 2.0
        while high <= _LARGEST and (found := asked(high, rows)) is not None:
            low, rows, high = high, found, 2 * high
        if high > _LARGEST:
            return Threshold(_LARGEST, rows)
    else:
        found = asked(0.0, every)
        if found is None:
            return Threshold(None, every)
        rows, high, low = found, 1.0, 0.5
        while low >= _SMALLEST and (found := asked(low, rows)) is None:
            low, high = low / 2, low
        if found is None:
            return Threshold(None, rows)
        rows = found
    while high > low * (1 + _PRECISION):
        middle = float(np.sqrt(low * high))
        found = asked(middle, rows)
        if found is None:
            high = middle
        else:
            low, rows = middle, found
    return Threshold(low, rows)


def met_interval(factors: Sequence[float], met: Sequence[bool], is_met: Callable[[float], bool]) -> Interval | None:
    """Around the factor nearest to 1 where ``met``, as far as it is met all along the factors; ends to a small part.

    Parameters
    ----------
    factors
        Ascending.
    is_met
        Whether it is met at a factor between these.
    """
    places = [k for k in range(len(factors)) if met[k]]
    if not places:
        return None
    first = last = min(places, key=lambda k: abs(np.log(factors[k])))
    while first > 0 and met[first - 1]:
        first -= 1
    while last < len(factors) - 1 and met[last + 1]:
        last += 1
    low = _end(factors[first], factors[first - 1], is_met) if first > 0 else None
    high = _end(factors[last], factors[last + 1], is_met) if last < len(factors) - 1 else None
    return Interval(low, high)


def _end(met: float, not_met: float, is_met: Callable[[float], bool]) -> float:
    """The last factor that is met between one that is and one that is not."""
    while abs(np.log(not_met / met)) > _PRECISION:
        middle = float(np.sqrt(met * not_met))
        met, not_met = (middle, not_met) if is_met(middle) else (met, middle)
    return met
