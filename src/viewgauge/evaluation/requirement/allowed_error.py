"""An allowed error and the probability of keeping it: the form that every requirement is put in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...exceptions import InputError
from .capability_indices import SHARE, SIGMAS
from .decision_risks import GlobalRisks

__all__ = ["Requirement"]

_KINDS = ("accuracy", "error", "fraction_of_tolerance")


@dataclass(frozen=True)
class Requirement:
    """Pr{|measured - nominal| <= allowed error} >= probability.

    Whatever is required is put in this form, for each characteristic. Another kind of requirement is a subclass in a
    file of its own, such as :class:`CapabilityRequirement` and :class:`ConformanceRequirement`: it overrides
    :meth:`allowed_error_mm`, :meth:`cannot_judge` and :attr:`text`, and what else it states. Its keys in the inspection
    file are registered in :mod:`viewgauge.formats.inspection.requirement_section`.

    Parameters
    ----------
    kind, value
        How the allowed error is stated: "accuracy" (relative; T = 1 - value), "error" (mm), or
        "fraction_of_tolerance" (of half the width of the tolerance zone: of T for +/-T).
    probability
        Required probability (the paper's Th).
    """

    kind: str
    value: float
    probability: float

    def __post_init__(self) -> None:
        if self.kind not in _KINDS:
            raise InputError("unknown kind of requirement", key="kind", got=self.kind, expected=", ".join(_KINDS))
        if not (np.isfinite(self.value) and self.value > 0):
            raise InputError(f"the required {self.kind} must be finite and positive", got=self.value)
        if self.kind == "accuracy" and self.value >= 1:
            raise InputError("the required accuracy must lie between 0 and 1", key="accuracy", got=self.value)
        if not 0 < self.probability < 1:
            raise InputError(
                "the required probability must lie between 0 and 1", key="probability", got=self.probability
            )

    def allowed_error_mm(self, nominal_mm: float, tolerance_mm: tuple[float, float] | None) -> float | None:
        """Largest allowed error of a characteristic, mm; None where :meth:`cannot_judge` says why there is none."""
        if self.kind == "accuracy":
            return (1 - self.value) * nominal_mm
        if self.kind == "error":
            return self.value
        if tolerance_mm is None:
            return None
        return self.value * (tolerance_mm[1] - tolerance_mm[0]) / 2

    def cannot_judge(self, tolerance_mm: tuple[float, float] | None) -> str | None:
        """Why the requirement says nothing about a characteristic; None where it does."""
        if self.kind == "fraction_of_tolerance" and tolerance_mm is None:
            return "it has no tolerance (a basic value), and the requirement is a fraction of the tolerance"
        if self.kind == "fraction_of_tolerance" and tolerance_mm is not None and tolerance_mm[0] == tolerance_mm[1]:
            return "its tolerance zone has no width"
        return None

    @property
    def text(self) -> str:
        """The requirement in words, as pages print it."""
        stated = {
            "accuracy": f"accuracy of at least {self.value:g}",
            "error": f"error of at most {self.value:.6g} mm",
            "fraction_of_tolerance": f"error of at most {self.value:.4g} of the tolerance",
        }
        return f"{stated[self.kind]}, with a probability of at least {self.probability:g}"

    @property
    def is_adjustable(self) -> bool:
        """Whether value and probability may be changed alone: not where they follow from other figures."""
        return True

    @property
    def unit(self) -> str:
        """Unit of the value: "mm", or empty for a ratio."""
        return "mm" if self.kind == "error" else ""

    @property
    def sigmas_share_bias(self) -> tuple[float, float, float]:
        """Standard deviations, share of the tolerance zone and bias, mm, by which capability indices are found."""
        return SIGMAS, SHARE, 0.0

    def risks(self, uncertainty_mm: float, tolerance_mm: tuple[float, float]) -> GlobalRisks | None:  # noqa: ARG002
        """The global risks of wrong decisions with a standard uncertainty; None where no process is stated."""
        return None
