"""Dimensions with gauges from the semantic PMI of a B-rep."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from ..brep import Brep, Callout
from ..characteristic import Dimension, Unusable
from ..features.outline import Outline
from .diameters import diameters
from .distances import distance
from .lengths import lengths
from .outcome import Measured, Outcome, Unmeasured

__all__ = ["derive_dimensions"]


def derive_dimensions(brep: Brep) -> tuple[tuple[Dimension, ...], tuple[Unusable, ...]]:
    """Every callout as dimensions that can be measured, or with the reason why it cannot.

    A callout on one feature keeps its name. A callout on a pattern is one dimension per feature: ``NAME/1``,
    ``NAME/2``, ... ordered by the features' positions x, then y, then z for diameters, by their first
    references otherwise. A callout without a nominal value takes it from the geometry; one without a tolerance
    (a basic value) keeps ``tolerance_mm=None``.

    Returns
    -------
    The measurable dimensions, each with at least one gauge, and what is unusable. Together they have each
    callout at least once, in the order of the callouts.
    """
    outline = Outline(brep)
    named = [entry for callout in brep.callouts for entry in _named(callout, _outcomes(outline, callout))]
    dimensions = tuple(entry for entry in named if isinstance(entry, Dimension))
    return dimensions, tuple(entry for entry in named if isinstance(entry, Unusable))


def _outcomes(outline: Outline, callout: Callout) -> list[Outcome]:
    if reason := _unsupported(callout):
        return [Unmeasured(reason)]
    if callout.second:
        return [distance(outline, callout)]
    if callout.kind == "diameter":
        return diameters(outline, callout)
    return lengths(outline, callout)


def _unsupported(callout: Callout) -> str:
    """Why the callout cannot be measured whatever the geometry; empty where it may be."""
    if callout.problem:
        return callout.problem
    if callout.kind == "radius":
        return "a radius has no pair of opposite edge points"
    if callout.kind in ("angle", "other"):
        return f"a callout of kind {callout.kind} ({callout.label}) is not a distance between two points"
    if not callout.first:
        return "the callout refers to no face or edge"
    if callout.kind == "distance" and not callout.second:
        return "the callout refers to only one of the two features of a distance"
    return ""


def _named(callout: Callout, outcomes: list[Outcome]) -> Iterator[Dimension | Unusable]:
    for number, outcome in enumerate(outcomes, start=1):
        name = callout.name if len(outcomes) == 1 else f"{callout.name}/{number}"
        if isinstance(outcome, Measured):
            nominal = outcome.value_mm if isnan(callout.nominal_mm) else callout.nominal_mm
            yield Dimension(name, callout.kind, nominal, callout.tolerance_mm, outcome.gauges)
        else:
            yield Unusable(name, callout.kind, outcome.reason, callout.nominal_mm, callout.tolerance_mm)
