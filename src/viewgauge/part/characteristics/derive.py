"""Characteristics with measurands from the semantic PMI of a B-rep."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from ..brep import Brep, PmiRecord
from ..characteristic import Characteristic, NotMeasurable
from ..features.outline import Outline
from .diameters import diameters
from .distances import distance
from .lengths import lengths
from .outcome import Measured, Outcome, Unmeasured

__all__ = ["derive_characteristics"]


def derive_characteristics(brep: Brep) -> tuple[tuple[Characteristic, ...], tuple[NotMeasurable, ...]]:
    """Every PMI record as characteristics that can be measured, or with the reason why it cannot.

    A PMI record on one feature keeps its name. A PMI record on a pattern is one characteristic per feature: ``NAME/1``,
    ``NAME/2``, ... ordered by the features' positions x, then y, then z for diameters, by their first
    references otherwise. A PMI record without a nominal value takes it from the geometry; one without a tolerance
    (a basic value) keeps ``tolerance_mm=None``.

    Returns
    -------
    The measurable characteristics, each with at least one measurand, and what is unusable. Together they have each
    PMI record at least once, in the order of the PMI records.
    """
    outline = Outline(brep)
    named = [entry for pmi_record in brep.pmi_records for entry in _named(pmi_record, _outcomes(outline, pmi_record))]
    characteristics = tuple(entry for entry in named if isinstance(entry, Characteristic))
    return characteristics, tuple(entry for entry in named if isinstance(entry, NotMeasurable))


def _outcomes(outline: Outline, pmi_record: PmiRecord) -> list[Outcome]:
    if reason := _unsupported(pmi_record):
        return [Unmeasured(reason)]
    if pmi_record.second:
        return [distance(outline, pmi_record)]
    if pmi_record.kind == "diameter":
        return diameters(outline, pmi_record)
    return lengths(outline, pmi_record)


def _unsupported(pmi_record: PmiRecord) -> str:
    """Why the PMI record cannot be measured whatever the geometry; empty where it may be."""
    if pmi_record.problem:
        return pmi_record.problem
    if pmi_record.kind == "radius":
        return "a radius has no pair of opposite edge points"
    if pmi_record.kind in ("angle", "other"):
        return f"a PMI record of kind {pmi_record.kind} ({pmi_record.label}) is not a distance between two points"
    if not pmi_record.first:
        return "the PMI record refers to no face or edge"
    if pmi_record.kind == "distance" and not pmi_record.second:
        return "the PMI record refers to only one of the two features of a distance"
    return ""


def _named(pmi_record: PmiRecord, outcomes: list[Outcome]) -> Iterator[Characteristic | NotMeasurable]:
    for number, outcome in enumerate(outcomes, start=1):
        name = pmi_record.name if len(outcomes) == 1 else f"{pmi_record.name}/{number}"
        if isinstance(outcome, Measured):
            nominal = outcome.value_mm if isnan(pmi_record.nominal_mm) else pmi_record.nominal_mm
            yield Characteristic(name, pmi_record.kind, nominal, pmi_record.tolerance_mm, outcome.measurands)
        else:
            yield NotMeasurable(name, pmi_record.kind, outcome.reason, pmi_record.nominal_mm, pmi_record.tolerance_mm)
