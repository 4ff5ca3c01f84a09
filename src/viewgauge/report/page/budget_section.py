"""The report's sections on refinement, error budgets and the capability figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ...evaluation.capability_figures import CapabilityFigures
from ...evaluation.error_budget import ErrorBudget
from ...planning.plan import Plan
from ..budget_parts import shares_of, shown_parts
from ..templating import Markup, render
from ..wording import DASH, length
from .ranking import ranked

__all__ = ["budget_section", "capability_section", "refinement_section"]

_STEPS = {
    "sampled": "Choosing among the candidates",
    "reach": "Measuring more",
    "raise": "Raising probabilities",
    "fewer": "Dropping viewpoints",
}
"""Words for the steps of :mod:`viewgauge.planning.refine.refinement`."""

_FIGURES = {
    "percent_p_to_t": "P/T / %",
    "cg": "Cg",
    "cgk": "Cgk",
    "test_uncertainty_ratio": "TUR",
    "consumer_risk": "Consumer's risk / %",
    "producer_risk": "Producer's risk / %",
}
_GROUPS_WITHOUT = ("camera", "translation", "rotation")


@dataclass(frozen=True)
class _BudgetRow:
    """A characteristic's budget as it is printed.

    Parameters
    ----------
    sources
        The share of each single source, in words.
    bar
        Widths of the stacked bar's parts, %; negative shares have none.
    shares
        The share of each part, in percent, as texts.
    probabilities
        With all errors, and without those of the camera, translation, and rotation.
    """

    id: str
    status: str
    uncertainty_mm: float
    sources: str
    bar: dict[str, float]
    shares: list[str]
    probabilities: list[float]


@dataclass(frozen=True)
class _FiguresRow:
    """A characteristic's capability figures as they are printed."""

    id: str
    status: str
    numbers: list[str]


def refinement_section(plan: Plan) -> Markup:
    """Before and after refining, step by step; nothing where nothing was refined."""
    if plan.refinement is None:
        return Markup()
    return render("refinement.html", steps=plan.refinement.steps, finished=plan.refinement.finished, names=_STEPS)


def budget_section(plan: Plan, budgets: Mapping[str, ErrorBudget]) -> Markup:
    """What causes the uncertainty of each characteristic, and its probability without each cause."""
    if not budgets:
        return Markup()
    parts = shown_parts(budgets.values())
    return render(
        "budget.html",
        rows=[_budget_row(d.id, d.status, budgets[d.id], parts) for d in ranked(plan) if d.id in budgets],
        parts=parts,
        words=parts,
        part_columns=[(words.capitalize(), "num") for words in parts.values()],
        pixels_alone=not {"edges", "calibration"} & set(parts),
    )


def _budget_row(name: str, status: str, budget: ErrorBudget, parts: Iterable[str]) -> _BudgetRow:
    of_all = shares_of(budget)
    shares = {part: of_all.get(part, 0.0) for part in parts}
    positive = sum(max(share, 0.0) for share in shares.values()) or 1.0
    without = budget.group_probability_without
    return _BudgetRow(
        name,
        status,
        float(budget.combined_uncertainty_mm),
        ", ".join(f"{source} {budget.share[k]:.1%}" for k, source in enumerate(c.name for c in budget.components)),
        {part: 100 * max(share, 0.0) / positive for part, share in shares.items()},
        [f"{share:.0%}".replace("-", "−") for share in shares.values()],
        [float(budget.probability), *(float(without[group]) for group in _GROUPS_WITHOUT)],
    )


def capability_section(plan: Plan, figures: Mapping[str, CapabilityFigures]) -> Markup:
    """U, %P/T, Cg, Cgk, TUR, and risks where a process is stated."""
    shown = [characteristic for characteristic in ranked(plan) if characteristic.id in figures]
    if not shown:
        return Markup()
    names = [name for name in _FIGURES if any(getattr(figures[d.id], name) is not None for d in shown)]
    rows = []
    for characteristic in shown:
        of = figures[characteristic.id]
        numbers = [length(of.expanded_uncertainty_mm), *(_figure(name, getattr(of, name)) for name in names)]
        rows.append(_FiguresRow(characteristic.id, characteristic.status, numbers))
    return render("capability.html", rows=rows, columns=[(_FIGURES[name], "num") for name in names])


def _figure(name: str, value: float | None) -> str:
    if value is None:
        return DASH
    return f"{100 * value:.3g}" if name.endswith("risk") else f"{value:.3g}"
