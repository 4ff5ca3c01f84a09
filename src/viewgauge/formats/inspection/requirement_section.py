"""The section ``requirement``, and the two sections below it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import ConfigDict, Field, JsonValue

from ...evaluation import CapabilityRequirement, ConformanceRequirement, Process, Requirement
from ...evaluation.requirement.decision_risks import Rule
from ...exceptions import InputError
from ..files.problems import Problems
from .validation import build, validate
from .values import AnyLength, Apart, Length, Ratio, Section

__all__ = ["RequirementSection", "read_requirement"]


def read_requirement(value: object, problems: Problems) -> Requirement | None:
    """The requirement that the section ``requirement`` states; None, and the reasons in ``problems``, if it cannot be.

    The sections below it are read apart, so that all their problems are reported.
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


_INDICES = ("percent_p_to_t", "cg", "cgk")
_OWN_KINDS, _KINDS_BELOW = ("accuracy", "error", "fraction_of_tolerance"), ("capability", "conformance")
_OWN_SCHEMAS: list[JsonValue] = [{"required": [name, "probability"]} for name in _OWN_KINDS]
_SCHEMAS_BELOW: list[JsonValue] = [{"required": [name], "properties": {"probability": False}} for name in _KINDS_BELOW]


class CapabilitySection(Section):
    """The capability that the measurement must have."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [name]} for name in _INDICES]})

    percent_p_to_t: Ratio | None = Field(
        default=None, description="the precision-to-tolerance ratio, at most this, such as 10 %"
    )
    cg: Ratio | None = Field(default=None, description="the capability index Cg, at least this, such as 1.33")
    cgk: Ratio | None = Field(default=None, description="the capability index Cgk, at least this, such as 1.33")
    sigmas: Ratio | None = Field(
        default=None, description="how many standard deviations the index takes as the measurement's spread, such as 6"
    )
    share: Ratio | None = Field(
        default=None, description="which share of the tolerance the index compares with, such as 20 %"
    )
    bias: AnyLength | None = Field(default=None, description="the measurement's bias, such as 0.002 mm; with cgk")

    def build(self) -> CapabilityRequirement:
        """The requirement; raises InputError."""
        kind, value = _only_one({name: getattr(self, name) for name in _INDICES}, "index")
        options = {"sigmas": self.sigmas, "share": self.share, "bias_mm": self.bias}
        return CapabilityRequirement(kind, value, **{k: v for k, v in options.items() if v is not None})


class ProcessSection(Section):
    """How the parts come out of manufacture."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["standard_deviation"]}, {"required": ["capability"]}]}
    )

    standard_deviation: Length | None = Field(
        default=None, description="the standard deviation of the parts' true sizes, such as 0.02 mm"
    )
    capability: Ratio | None = Field(
        default=None, description="the process's capability index Cp, such as 1.33, in place of standard_deviation"
    )
    offset: AnyLength = Field(
        default=0.0, description="from the middle of the tolerance zone to the mean of the parts, by default 0 mm"
    )

    def build(self) -> Process:
        """The process; raises InputError."""
        return Process(self.standard_deviation, self.capability, self.offset)


class ConformanceSection(Section):
    """Limits on wrong decisions; the process is read apart."""

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [{"required": ["consumer_risk"]}, {"required": ["producer_risk"]}],
            "if": {"properties": {"rule": {"const": "simple"}}},
            "then": {"properties": {"guard": False}},
        }
    )

    rule: Rule = Field(description="the decision rule: simple, guarded or guarded_rejection")
    guard: Ratio | None = Field(
        default=None, description="the guard band as a multiple of the expanded uncertainty, by default 1"
    )
    process: Annotated[Any, Apart(ProcessSection)] = Field(
        description="how the parts come out of manufacture: a section with standard_deviation or capability"
    )
    consumer_risk: Ratio | None = Field(
        default=None, description="the greatest probability of accepting a part that does not conform, such as 0.1 %"
    )
    producer_risk: Ratio | None = Field(
        default=None, description="the greatest probability of rejecting a part that conforms, such as 1 %"
    )

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
    """How accurately a characteristic must be measured, and with what probability; sections below are read apart."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [*_OWN_SCHEMAS, *_SCHEMAS_BELOW]})

    accuracy: Ratio | None = Field(
        default=None, description="1 minus the allowed error relative to the nominal value, such as 0.999"
    )
    error: Length | None = Field(default=None, description="the allowed error: a length, such as 0.05 mm")
    fraction_of_tolerance: Ratio | None = Field(
        default=None, description="the allowed error as a share of half the tolerance zone's width, such as 10 %"
    )
    capability: Annotated[Any, Apart(CapabilitySection)] = Field(
        default=None, description="a capability that the measurement must have, in place of an allowed error"
    )
    conformance: Annotated[Any, Apart(ConformanceSection)] = Field(
        default=None, description="limits on the risks of wrong decisions, in place of an allowed error"
    )
    probability: Ratio | None = Field(
        default=None, description="the probability of keeping to the allowed error: a ratio, such as 0.95"
    )

    def build(self, below: Mapping[str, Requirement]) -> Requirement:
        """The requirement, one of those built from the sections below if there is one; raises InputError.

        Parameters
        ----------
        below
            By the name of their section.
        """
        kind, value = _only_one({name: getattr(self, name) for name in (*_OWN_KINDS, *_KINDS_BELOW)}, "requirement")
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
