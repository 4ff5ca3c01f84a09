"""How accurately, and how surely, a dimension has to be measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..exceptions import InputError

__all__ = ["Requirement"]

_Kind = Literal["accuracy", "error", "fraction_of_tolerance"]


@dataclass(frozen=True)
class Requirement:
    """Pr{|measured - nominal| <= allowed error} >= probability.

    Parameters
    ----------
    kind, value
        How the allowed error is stated: "accuracy" (relative; T = 1 - value), "error" (mm), or
        "fraction_of_tolerance" (of half the width of the tolerance zone: of T for +/-T).
    probability
        Required probability (the paper's Th).
    """

    kind: _Kind
    value: float
    probability: float

    def __post_init__(self) -> None:
        if self.kind not in get_args(_Kind):
            raise InputError(
                "unknown kind of requirement", key="kind", got=self.kind, expected=", ".join(get_args(_Kind))
            )
        if not (np.isfinite(self.value) and self.value > 0):
            raise InputError(f"the required {self.kind} must be finite and positive", got=self.value)
        if self.kind == "accuracy" and self.value >= 1:
            raise InputError("the required accuracy must lie between 0 and 1", key="accuracy", got=self.value)
        if not 0 < self.probability < 1:
            raise InputError(
                "the required probability must lie between 0 and 1", key="probability", got=self.probability
            )

    def allowed_error_mm(self, nominal_mm: float, tolerance_mm: tuple[float, float] | None) -> float | None:
        """Largest allowed error of a dimension, mm; None where the requirement needs a tolerance and there is none."""
        if self.kind == "accuracy":
            return (1 - self.value) * nominal_mm
        if self.kind == "error":
            return self.value
        if tolerance_mm is None:
            return None
        return self.value * (tolerance_mm[1] - tolerance_mm[0]) / 2
