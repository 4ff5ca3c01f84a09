"""Characteristics with measurands from the semantic PMI of a B-rep."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from ..brep import Brep, PmiRecord
from ..characteristic import Characteristic, NotMeasurable
from ..features.outline import Outline
from .derivers import deriver_of
from .outcome import Derived, NotDerived, Outcome

__all__ = ["derive_characteristics"]


def derive_characteristics(brep: Brep) -> tuple[tuple[Characteristic, ...], tuple[NotMeasurable, ...]]:
    """Every PMI record as characteristics that can be measured, or with the reason why it cannot.

    A PMI record on one feature keeps its name. A PMI record on a pattern is one characteristic per feature: ``NAME/1``,
    ``NAME/2``, ... ordered by the features' positions x, then y, then z for diameters, by their first
    references otherwise. A PMI record without a nominal value takes it from the geometry; one without a tolerance
    (a basic value) keeps ``tolerance_mm=None``.

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
    if pmi_record.problem:
        return [NotDerived(pmi_record.problem)]
    deriver = deriver_of(pmi_record.kind)
    if deriver is None:
        words = f"a PMI record of kind {pmi_record.kind} ({pmi_record.label})"
        return [NotDerived(f"{words} is not a distance between two points")]
    return deriver(outline, pmi_record)


def _named(pmi_record: PmiRecord, outcomes: list[Outcome]) -> Iterator[Characteristic | NotMeasurable]:
    for number, outcome in enumerate(outcomes, start=1):
        name = pmi_record.name if len(outcomes) == 1 else f"{pmi_record.name}/{number}"
        if isinstance(outcome, Derived):
            nominal = outcome.value_mm if isnan(pmi_record.nominal_mm) else pmi_record.nominal_mm
            yield Characteristic(name, pmi_record.kind, nominal, pmi_record.tolerance_mm, outcome.measurands)
        else:
            value = pmi_record.nominal_mm, pmi_record.tolerance_mm, pmi_record.unit
            yield NotMeasurable(name, pmi_record.kind, outcome.reason, *value)
