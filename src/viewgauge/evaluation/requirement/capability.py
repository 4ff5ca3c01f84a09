"""A required capability of the measurement, as an allowed error and a probability."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...exceptions import InputError
from .allowed_error import Requirement
from .capability_indices import SHARE, SIGMAS, coverage, spread_for_cgk, spread_for_percent_p_to_t

__all__ = ["CapabilityRequirement"]

_ROUNDING = 1e-12  # of what is left of the tolerance zone when a bias that uses it up is taken off
_INDICES = ("percent_p_to_t", "cg", "cgk")


@dataclass(frozen=True)
class CapabilityRequirement(Requirement):
    """P/T at most, or Cg or Cgk at least a value (:mod:`~viewgauge.evaluation.requirement.capability_indices`).

    The probability is implied: that of a normal law within ``sigmas`` standard deviations, 0.9973 of 6. The allowed
    error is half the spread at which the index has the value.

    Parameters
    ----------
    kind, value
        "percent_p_to_t" as a ratio (0.1 is 10 %), "cg" or "cgk".
    sigmas
        Standard deviations that stand for the spread: 6, or 5.15.
    share
        Of the tolerance zone, of Cg and Cgk.
    bias_mm
        Systematic error that the measurand is known to have, of Cgk.
    """

    probability: float = field(init=False)
    sigmas: float = SIGMAS
    share: float = SHARE
    bias_mm: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in _INDICES:
            raise InputError("unknown index of capability", key="kind", got=self.kind, expected=", ".join(_INDICES))
        if not (np.isfinite(self.value) and self.value > 0):
            raise InputError("must be finite and positive", key=self.kind, got=self.value)
        if not 1 <= self.sigmas <= 12:
            raise InputError(
                "no usual number of standard deviations", key="sigmas", got=self.sigmas, expected="such as 6 or 5.15"
            )
        if not 0 < self.share <= 1:
            raise InputError("no share of the tolerance zone", key="share", got=self.share, expected="such as 20 %")
        if not np.isfinite(self.bias_mm):
            raise InputError("must be finite", key="bias", got=self.bias_mm)
        if self.kind != "cgk" and self.bias_mm:
            raise InputError(
                "only Cgk takes a bias into account",
                key="bias",
                got=f"{self.bias_mm:g} mm",
                hint="require cgk",
            )
        if self.kind == "percent_p_to_t" and self.share != SHARE:
            raise InputError("P/T refers to the whole tolerance zone", key="share", got=self.share, hint="remove share")
        object.__setattr__(self, "probability", coverage(self.sigmas))

    def allowed_error_mm(
        self,
        nominal_mm: float,  # noqa: ARG002 - the base class's
        tolerance_mm: tuple[float, float] | None,
    ) -> float | None:
        """Half the spread that is allowed, mm; None where :meth:`cannot_judge` says why there is none."""
        return self._half_spread_mm(tolerance_mm)

    def cannot_judge(self, tolerance_mm: tuple[float, float] | None) -> str | None:
        """No tolerance, or one whose share the bias uses up."""
        if tolerance_mm is None:
            return "it has no tolerance (a basic value), and the requirement is on the capability for a tolerance"
        if self._half_spread_mm(tolerance_mm) is not None:
            return None
        width = tolerance_mm[1] - tolerance_mm[0]
        if not width:
            return "its tolerance zone has no width"
        part = f"{50 * self.share:.3g} % of the tolerance zone of {width:.6g} mm"
        return f"the bias of {abs(self.bias_mm):g} mm is no less than {part}: no measurement has the required Cgk"

    @property
    def text(self) -> str:
        """Such as: Cg of at least 1.33 (20 % of the tolerance zone over 6 standard deviations)."""
        spread = f"{self.sigmas:g} standard deviations"
        zone = f"{100 * self.share:.4g} % of the tolerance zone"
        if self.kind == "percent_p_to_t":
            return f"P/T of at most {100 * self.value:.4g} % ({spread} over the tolerance zone)"
        if self.kind == "cg":
            return f"Cg of at least {self.value:g} ({zone} over {spread})"
        bias = f"{abs(self.bias_mm):.6g} mm" if self.bias_mm else "none"
        return f"Cgk of at least {self.value:g} ({zone} over {spread}; bias: {bias})"

    @property
    def is_adjustable(self) -> bool:
        """Not: allowed error and probability follow from the index."""
        return False

    @property
    def unit(self) -> str:
        """Indices are ratios."""
        return ""

    @property
    def sigmas_share_bias(self) -> tuple[float, float, float]:
        """As required."""
        return self.sigmas, self.share, self.bias_mm

    def _half_spread_mm(self, tolerance_mm: tuple[float, float] | None) -> float | None:
        if tolerance_mm is None:
            return None
        if self.kind == "percent_p_to_t":
            allowed = float(spread_for_percent_p_to_t(100 * self.value, *tolerance_mm))
        else:
            allowed = float(spread_for_cgk(self.value, *tolerance_mm, bias=self.bias_mm, share=self.share))
        nothing = _ROUNDING * (tolerance_mm[1] - tolerance_mm[0]) / self.value
        return allowed if allowed > nothing else None
