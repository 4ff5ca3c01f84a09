"""The keys of the inspection file's section ``requirement``, and of the two sections below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from ...evaluation import CapabilityRequirement, ConformanceRequirement, Process, Requirement
from ...evaluation.requirement.decision_risks import Rule
from ...exceptions import InputError
from ..files.problems import Problems
from .sections import AnyLength, Length, Ratio, Section
from .validation import build, validate

__all__ = ["read_requirement"]


def read_requirement(value: object, problems: Problems) -> Requirement | None:
    """The requirement that the section ``requirement`` states; None, and the reasons in ``problems``, if it cannot be.

    The sections below it are read apart, so that all their problems are told.
    """
    where = ("requirement",)
    section = validate(RequirementSection, value, where, problems)
    keys = value if isinstance(value, dict) else {}
    below: dict[str, Requirement | None] = {}
    if "capability" in keys:
        capability = validate(CapabilitySection, keys["capability"], (*where, "capability"), problems)
        below["capability"] = build(capability.build, (*where, "capability"), problems) if capability else None
    if "conformance" in keys:
        below["conformance"] = _read_conformance(keys["conformance"], problems)
    if section is None or None in below.values():
        return None
    return build(section.build, where, problems, below)


def _read_conformance(value: object, problems: Problems) -> Requirement | None:
    where = ("requirement", "conformance")
    section = validate(ConformanceSection, value, where, problems)
    if not isinstance(value, dict) or "process" not in value:
        return None
    place = (*where, "process")
    stated = validate(ProcessSection, value["process"], place, problems)
    process = build(stated.build, place, problems) if stated else None
    return build(section.build, where, problems, process) if section and process else None


class CapabilitySection(Section):
    """The capability that the measurand must have."""

    percent_p_to_t: Ratio | None = None
    cg: Ratio | None = None
    cgk: Ratio | None = None
    sigmas: Ratio | None = None
    share: Ratio | None = None
    bias: AnyLength | None = None

    def build(self) -> CapabilityRequirement:
        """The requirement; raises InputError."""
        kind, value = _only_one({name: getattr(self, name) for name in ("percent_p_to_t", "cg", "cgk")}, "index")
        options = {"sigmas": self.sigmas, "share": self.share, "bias_mm": self.bias}
        return CapabilityRequirement(kind, value, **{k: v for k, v in options.items() if v is not None})


class ProcessSection(Section):
    """How the parts come out of manufacture."""

    standard_deviation: Length | None = None
    capability: Ratio | None = None
    offset: AnyLength = 0.0

    def build(self) -> Process:
        """The process; raises InputError."""
        return Process(self.standard_deviation, self.capability, self.offset)


class ConformanceSection(Section):
    """Limits on wrong decisions; the process is read apart."""

    rule: Rule = Field(description="simple, guarded or guarded_rejection")
    guard: Ratio | None = None
    process: Any = Field(description="a section with standard_deviation or capability")
    consumer_risk: Ratio | None = None
    producer_risk: Ratio | None = None

    def build(self, process: Process) -> ConformanceRequirement:
        """The requirement; raises InputError."""
        if self.rule == "simple" and self.guard is not None:
            raise InputError(
                "simple acceptance has no guard band",
                key="guard",
                got=f"{self.guard:g}",
                hint="remove it",
            )
        guard = 1.0 if self.guard is None else self.guard
        return ConformanceRequirement(self.rule, process, guard, self.consumer_risk, self.producer_risk)


class RequirementSection(Section):
    """How accurately and how surely a characteristic has to be measured; the sections below are read apart."""

    accuracy: Ratio | None = None
    error: Length | None = None
    fraction_of_tolerance: Ratio | None = None
    capability: Any = None
    conformance: Any = None
    probability: Ratio | None = None

    def build(self, below: Mapping[str, Requirement]) -> Requirement:
        """The requirement, one of those built from the sections below if there is one; raises InputError.

        Parameters
        ----------
        below
            By the name of their section.
        """
        names = ("accuracy", "error", "fraction_of_tolerance", "capability", "conformance")
        kind, value = _only_one({name: getattr(self, name) for name in names}, "requirement")
        if kind in below:
            if self.probability is not None:
                raise InputError(
                    f"the probability follows from the {kind}",
                    key="probability",
                    got=f"{self.probability:g}",
                    expected=f"{kind} alone",
                    hint=f"remove probability: {below[kind].probability:.6g} is implied",
                )
            return below[kind]
        if self.probability is None:
            raise InputError("required key missing", key="probability", expected="a ratio, such as 0.95")
        if kind == "fraction_of_tolerance" and value > 1:
            raise InputError(
                "the fraction of the tolerance is more than all of it",
                key="fraction_of_tolerance",
                got=f"{value:.6g}",
                expected="at most 1 (100 %)",
            )
        return Requirement(kind, value, self.probability)


def _only_one(stated: Mapping[str, Any], what: str) -> tuple[str, Any]:
    """The one of several keys that is given."""
    given = {name: value for name, value in stated.items() if value is not None}
    if len(given) != 1:
        raise InputError(
            f"more than one {what}" if given else f"the {what} itself is missing",
            key=list(given)[1] if given else None,
            got=" and ".join(given) or None,
            expected=f"exactly one of {', '.join(stated)}",
        )
    return next(iter(given.items()))
