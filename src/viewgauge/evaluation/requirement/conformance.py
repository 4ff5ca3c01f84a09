"""Limits on wrong decisions, as an allowed error and a probability."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import get_args

import numpy as np

from ...exceptions import InputError
from .allowed_error import Requirement
from .capability_indices import coverage
from .decision_risks import GlobalRisks, Rule, acceptance_limits, global_risks, guard_multiplier
from .target_uncertainty import largest_uncertainty

__all__ = ["COVERAGE_FACTOR", "ConformanceRequirement", "Process"]

COVERAGE_FACTOR = 2.0
"""k in U = k u."""

_MOST_GUARD = 10.0


@dataclass(frozen=True)
class Process:
    """The normal law of the true values of a characteristic: how the parts come out of manufacture.

    Parameters
    ----------
    standard_deviation_mm, capability
        One of them: s, or the process capability Cp = (USL - LSL) / (6 s).
    offset_mm
        Of the mean from the middle of the tolerance zone.
    """

    standard_deviation_mm: float | None = None
    capability: float | None = None
    offset_mm: float = 0.0

    def __post_init__(self) -> None:
        stated = {"standard_deviation": self.standard_deviation_mm, "capability": self.capability}
        given = {name: value for name, value in stated.items() if value is not None}
        if len(given) != 1:
            raise InputError(
                "the spread of the process is stated twice" if given else "the spread of the process is missing",
                key="capability" if given else None,
                expected="standard_deviation (a length) or capability (Cp)",
            )
        ((name, value),) = given.items()
        if not (np.isfinite(value) and value > 0):
            raise InputError("must be finite and positive", key=name, got=value)
        if not np.isfinite(self.offset_mm):
            raise InputError("must be finite", key="offset", got=self.offset_mm)

    def law_mm(self, tolerance_mm: tuple[float, float]) -> tuple[float, float]:
        """Mean, from the nominal value, and standard deviation, of a characteristic with this tolerance."""
        lower, upper = tolerance_mm
        spread = self.standard_deviation_mm
        if spread is None:
            assert self.capability is not None
            spread = (upper - lower) / (6 * self.capability)
        return (lower + upper) / 2 + self.offset_mm, spread


@dataclass(frozen=True)
class ConformanceRequirement(Requirement):
    """Global consumer's and producer's risk at most so large, by a decision rule (JCGM 106:2012).

    For each characteristic the largest standard uncertainty is found at which the risks are within their limits
    (:func:`~viewgauge.evaluation.requirement.target_uncertainty.largest_uncertainty`); the expanded uncertainty,
    U = 2 u, is the allowed error, and the probability that of a normal law within it, 0.9545. This is exact where the
    error of the measurement is normal. Where it is all quantization, its standard deviation may be up to
    4 % larger than that u.

    Parameters
    ----------
    rule, guard
        "simple", "guarded" or "guarded_rejection", with a guard band ``w = guard U``. ``value`` is r in ``w = r U``.
    process
        The law of the true values.
    consumer_risk, producer_risk
        Limits of R_C and R_P; None where there is none. One is needed.
    """

    kind: str = field(init=False, default="conformance")
    value: float = field(init=False)
    probability: float = field(init=False)
    rule: Rule
    process: Process
    guard: float = 1.0
    consumer_risk: float | None = None
    producer_risk: float | None = None

    def __post_init__(self) -> None:
        if self.rule not in get_args(Rule):
            raise InputError("unknown decision rule", key="rule", got=self.rule, expected=", ".join(get_args(Rule)))
        if not 0 < self.guard <= _MOST_GUARD:
            raise InputError(
                "no usual guard band",
                key="guard",
                got=self.guard,
                expected="a multiple of U, such as 1",
            )
        risks = {"consumer_risk": self.consumer_risk, "producer_risk": self.producer_risk}
        if all(limit is None for limit in risks.values()):
            raise InputError("no risk is limited", expected="consumer_risk, producer_risk, or both, such as 1 %")
        for name, limit in risks.items():
            if limit is not None and not 0 < limit < 1:
                raise InputError("a risk must lie between 0 and 1", key=name, got=limit, expected="such as 1 %")
        object.__setattr__(self, "value", guard_multiplier(self.rule, self.guard))
        object.__setattr__(self, "probability", coverage(2 * COVERAGE_FACTOR))

    def allowed_error_mm(
        self,
        nominal_mm: float,  # noqa: ARG002 - the base class's
        tolerance_mm: tuple[float, float] | None,
    ) -> float | None:
        """The largest expanded uncertainty, mm; None where :meth:`cannot_judge` says why there is none."""
        if tolerance_mm is None or not tolerance_mm[0] < tolerance_mm[1]:
            return None
        u = self._largest_uncertainty_mm(tolerance_mm)
        return COVERAGE_FACTOR * u if np.isfinite(u) else None

    def cannot_judge(self, tolerance_mm: tuple[float, float] | None) -> str | None:
        """No tolerance, or risks that any measurement keeps."""
        if tolerance_mm is None:
            return "it has no tolerance (a basic value), and the requirement is on conformance with a tolerance"
        if not tolerance_mm[0] < tolerance_mm[1]:
            return "its tolerance zone has no width"
        if np.isfinite(self._largest_uncertainty_mm(tolerance_mm)):
            return None
        hint = "; limit the producer's risk too" if self.producer_risk is None else ""
        return f"any measurement keeps the risks within their limits, by this process and decision rule{hint}"

    def risks(self, uncertainty_mm: float, tolerance_mm: tuple[float, float]) -> GlobalRisks:
        """The global risks of a characteristic measured with a standard uncertainty."""
        accept = acceptance_limits(*tolerance_mm, COVERAGE_FACTOR * uncertainty_mm, self.value)
        return global_risks(uncertainty_mm, *tolerance_mm, *accept, *self.process.law_mm(tolerance_mm))

    @property
    def text(self) -> str:
        """Such as: consumer's risk of at most 1 % by simple acceptance (...)."""
        risks = {"consumer's": self.consumer_risk, "producer's": self.producer_risk}
        limits = [f"{whose} risk of at most {100 * risk:.4g} %" for whose, risk in risks.items() if risk is not None]
        rule = {
            "simple": "simple acceptance (shared risk)",
            "guarded": f"guarded acceptance, w = {self.guard:g} U",
            "guarded_rejection": f"guarded rejection, w = {self.guard:g} U",
        }[self.rule]
        process = self.process
        if process.standard_deviation_mm is None:
            spread = f"process capability Cp {process.capability:g}"
        else:
            spread = f"process standard deviation {process.standard_deviation_mm:.6g} mm"
        offset = f", offset {process.offset_mm:.6g} mm".replace("-", "−") if process.offset_mm else ""
        return f"{' and '.join(limits)}, by {rule}; {spread}{offset} (JCGM 106)"

    @property
    def is_adjustable(self) -> bool:
        """Not: allowed error and probability follow from the risks."""
        return False

    @property
    def unit(self) -> str:
        """Risks are ratios."""
        return ""

    def _largest_uncertainty_mm(self, tolerance_mm: tuple[float, float]) -> float:
        lower, upper = tolerance_mm
        _, spread = self.process.law_mm(tolerance_mm)
        return largest_uncertainty(
            (upper - lower) / 2, self.process.offset_mm, spread, self.value, self.consumer_risk, self.producer_risk
        )
