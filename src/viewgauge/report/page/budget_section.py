"""The report's sections on refinement, error budgets and the capability figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...evaluation.capability_figures import CapabilityFigures
from ...evaluation.error_budget import ErrorBudget
from ...planning.plan import Plan, PlannedCharacteristic
from ..budget_parts import shares_of, shown_parts
from ..wording import DASH, element, length, probability
from .tables import STATUS_WORDS, markup_table

__all__ = ["budget_section", "figures_section", "refinement_section"]

_STEPS = {"sampled": "Candidates", "reach": "Reaching more", "surer": "Surer", "fewer": "Fewer"}


def _section(name: str, heading: str, hint: str, content: str) -> str:
    return element("section", markup=element("h2", heading, id=name) + element("p", hint, class_="hint") + content)


def refinement_section(plan: Plan) -> str:
    """Before and after refining, step by step; nothing where nothing was refined."""
    if plan.refinement is None:
        return ""
    pose_error = [("After", ""), ("Viewpoints", "num"), ("Characteristics met", "num"), ("Weakest probability", "num")]
    rows = []
    for step in plan.refinement.steps:
        numbers = (str(step.count), str(step.met), probability(step.weakest) if step.met else DASH)
        cells = element("th", _STEPS.get(step.name, step.name), scope="row")
        rows.append(element("tr", markup=cells + "".join(element("td", number, class_="num") for number in numbers)))
    hint = "Viewpoints moved and replaced over all poses that the region allows."
    if not plan.refinement.finished:
        hint += " It was stopped: more time may find better."
    return _section("refinement", "Refinement", hint, markup_table(pose_error, rows))


def budget_section(plan: Plan, budgets: Mapping[str, ErrorBudget]) -> str:
    """What causes the uncertainty of each characteristic, and how sure it would be without."""
    if not budgets:
        return ""
    names = shown_parts(budgets.values())
    rows = [_budget_row(d, budgets[d.id], names) for d in _least_sure_first(plan) if d.id in budgets]
    pixels_alone = not {"edges", "calibration"} & set(names)
    pose_error = [
        ("Characteristic", ""),
        ("u / mm", "num"),
        ("Shares of the variance", "share"),
        *((words.capitalize(), "num") for words in names.values()),
        ("Probability", "num"),
        ("without pixels" if pixels_alone else "without camera errors", "num"),
        ("without translation", "num"),
        ("without rotation", "num"),
    ]
    hint = (
        "First order, at the viewpoint that measures the characteristic (at the best one tried where none "
        "does). A negative "
        "share: errors that offset others. A cell's pointer text has the single sources."
    )
    return _section("budget", "Error budget", hint, _legend(names) + markup_table(pose_error, rows))


def _legend(names: Mapping[str, str]) -> str:
    entries = (element("span", class_=f"swatch part-{name}") + element("span", words) for name, words in names.items())
    return element("p", markup=" &ensp; ".join(entries), class_="hint")


def _budget_row(characteristic: PlannedCharacteristic, budget: ErrorBudget, names: Iterable[str]) -> str:
    of_all = shares_of(budget)
    shares = {name: of_all.get(name, 0.0) for name in names}
    single = ", ".join(f"{name} {budget.share[k]:.1%}" for k, name in enumerate(c.name for c in budget.components))
    without = budget.group_probability_without
    cells = [
        element("th", characteristic.id, scope="row"),
        element("td", f"{float(budget.combined_uncertainty_mm):.4f}", class_="num"),
        element("td", markup=_bar(shares), title=single),
        *(element("td", f"{share:.0%}".replace("-", "−"), class_="num", title=single) for share in shares.values()),
        element("td", probability(float(budget.probability)), class_="num"),
        *(element("td", probability(float(without[g])), class_="num") for g in ("camera", "translation", "rotation")),
    ]
    return element("tr", markup="".join(cells), class_=characteristic.status)


def _bar(shares: Mapping[str, float]) -> str:
    """Stacked, of the positive shares."""
    total = sum(max(share, 0.0) for share in shares.values()) or 1.0
    parts = (
        element("span", class_=f"part-{name}", style=f"width:{100 * max(share, 0.0) / total:.2f}%")
        for name, share in shares.items()
    )
    return element("div", markup="".join(parts), class_="bar")


def figures_section(plan: Plan, figures: Mapping[str, CapabilityFigures]) -> str:
    """U, %P/T, Cg, Cgk, TUR, and risks where a process is stated."""
    shown = [d for d in _least_sure_first(plan) if d.id in figures]
    if not shown:
        return ""
    columns = ["percent_p_to_t", "cg", "cgk", "test_uncertainty_ratio", "consumer_risk", "producer_risk"]
    columns = [name for name in columns if any(getattr(figures[d.id], name) is not None for d in shown)]
    words = {
        "percent_p_to_t": "P/T / %",
        "cg": "Cg",
        "cgk": "Cgk",
        "test_uncertainty_ratio": "TUR",
        "consumer_risk": "Consumer's risk / %",
        "producer_risk": "Producer's risk / %",
    }
    pose_error = [("Characteristic", ""), ("U (k = 2) / mm", "num"), *((words[name], "num") for name in columns)]
    rows = []
    for characteristic in shown:
        of = figures[characteristic.id]
        cells = [
            element("th", characteristic.id, scope="row"),
            element("td", length(of.expanded_uncertainty_mm), class_="num"),
            *(element("td", _figure(name, getattr(of, name)), class_="num") for name in columns),
        ]
        rows.append(element("tr", markup="".join(cells), class_=characteristic.status))
    hint = "Predicted from the law of the measuring error: its spread over the tolerance zone, and what follows."
    return _section("measurand", "Capability", hint, markup_table(pose_error, rows))


def _figure(name: str, value: float | None) -> str:
    if value is None:
        return DASH
    return f"{100 * value:.3g}" if name.endswith("risk") else f"{value:.3g}"


def _least_sure_first(plan: Plan) -> list[PlannedCharacteristic]:
    order = list(STATUS_WORDS)
    return sorted(
        plan.characteristics,
        key=lambda characteristic: (order.index(characteristic.status), characteristic.probability),
    )
