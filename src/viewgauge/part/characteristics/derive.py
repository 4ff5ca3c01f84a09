"""Characteristics with measurands from the semantic PMI of a B-rep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isnan

from ..brep import Brep, PmiRecord, Reference
from ..characteristic import Characteristic, NotMeasurable
from ..features.feature_groups import feature_groups
from ..features.outline import Outline
from .derivers import deriver_of
from .outcome import Derived, NotDerived, Outcome

__all__ = ["derive_characteristics"]


def derive_characteristics(brep: Brep) -> tuple[tuple[Characteristic, ...], tuple[NotMeasurable, ...]]:
    """Every PMI record as characteristics that can be measured, or with the reason why it cannot.

    A PMI record on one feature keeps its name. A PMI record on a pattern is one characteristic per feature: ``NAME/1``,
    ``NAME/2``, ... ordered by the features' positions x, then y, then z, lengths of edges and widths by their first
    references. In an assembly those of its first instance come first, then those of the second, and so on. A PMI record
    without a nominal value takes it from the geometry; one without a tolerance (a basic value) keeps
    ``tolerance_mm=None``.

    Returns
    -------
    The measurable characteristics, each with at least one measurand, and what is not measurable. Together they have
    each PMI record at least once, in the order of the PMI records.
    """
    outline = Outline(brep)
    named = [entry for pmi_record in brep.pmi_records for entry in _named(pmi_record, _outcomes(outline, pmi_record))]
    characteristics = tuple(entry for entry in named if isinstance(entry, Characteristic))
    return characteristics, tuple(entry for entry in named if isinstance(entry, NotMeasurable))


def _outcomes(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    """One outcome for each feature of each instance."""
    return [outcome for one in _by_instance(outline.brep, pmi_record) for outcome in _of_one(outline, one)]


def _of_one(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    if pmi_record.problem:
        return _not_derived(outline, pmi_record, NotDerived(pmi_record.problem, pmi_record.status))
    deriver = deriver_of(pmi_record.kind)
    if deriver is None:
        words = f"a PMI record of kind {pmi_record.kind} ({pmi_record.label or pmi_record.kind})"
        return _not_derived(outline, pmi_record, NotDerived(f"{words} is not a distance between two points"))
    return deriver(outline, pmi_record)


def _not_derived(outline: Outline, pmi_record: PmiRecord, reason: NotDerived) -> list[Outcome]:
    """The reason once for each feature."""
    features = max(len(feature_groups(outline, side)) for side in (pmi_record.first, pmi_record.second))
    return [reason] * max(features, 1)


def _by_instance(brep: Brep, pmi_record: PmiRecord) -> list[PmiRecord]:
    """The PMI record on each instance of its part in an assembly; itself where it spans different ones."""

    def instance(reference: Reference) -> int:
        return (brep.faces if reference.kind == "face" else brep.edges)[reference.index].instance

    first, second = ({instance(r) for r in side} for side in (pmi_record.first, pmi_record.second))
    if len(first) < 2 or (second and first != second):
        return [pmi_record]
    return [
        replace(
            pmi_record,
            first=tuple(r for r in pmi_record.first if instance(r) == number),
            second=tuple(r for r in pmi_record.second if instance(r) == number),
        )
        for number in sorted(first)
    ]


def _named(pmi_record: PmiRecord, outcomes: list[Outcome]) -> Iterator[Characteristic | NotMeasurable]:
    indication = replace(pmi_record.indication, features=len(outcomes))
    for number, outcome in enumerate(outcomes, start=1):
        name = pmi_record.name if len(outcomes) == 1 else f"{pmi_record.name}/{number}"
        if isinstance(outcome, Derived):
            nominal = outcome.value_mm if isnan(pmi_record.nominal_mm) else pmi_record.nominal_mm
            yield Characteristic(
                name, pmi_record.kind, nominal, pmi_record.tolerance_mm, outcome.measurands, indication=indication
            )
        else:
            value = pmi_record.nominal_mm, pmi_record.tolerance_mm, pmi_record.unit
            yield NotMeasurable(name, pmi_record.kind, outcome.reason, *value, outcome.status, indication)
