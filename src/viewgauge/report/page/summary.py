"""What a reader takes away in ten seconds."""

from __future__ import annotations

from collections import Counter

from ...planning.plan import Plan, Status
from ..templating import Markup, render
from ..wording import DASH, probability
from .ranking import STATUS_WORDS

__all__ = ["summary_section", "verdict"]

NAMES_SHOWN = 6


def verdict(plan: Plan) -> tuple[str, bool]:
    """The outcome in one sentence, and whether it is good."""
    count: Counter[str] = Counter(characteristic.status for characteristic in plan.characteristics)
    total = len(plan.characteristics)
    if total == 0:
        return "No characteristic to measure", False
    if plan.all_met:
        return ("The characteristic is met" if total == 1 else f"All {total} characteristics are met"), True
    parts = []
    if count["not_met"]:
        parts.append(f"not met: {count['not_met']} of {total} characteristics")
    for status in (Status.PARTIAL, Status.NOT_MEASURABLE, Status.OUT_OF_SCOPE):
        if count[status]:
            of_all = "" if parts else f" of {total} characteristics"
            parts.append(f"{STATUS_WORDS[status]}: {count[status]}{of_all}")
    text = ", ".join(parts)
    return text[0].upper() + text[1:], False


def _missing(plan: Plan) -> str:
    """The names of what is missing, as many as fit."""
    names = [characteristic.id for characteristic in plan.characteristics if characteristic.status != "met"]
    if not names:
        return "each with the required accuracy and probability"
    more = len(names) - NAMES_SHOWN
    return "missing: " + ", ".join(names[:NAMES_SHOWN]) + (f" and {more} more" if more > 0 else "")


def _optimality(plan: Plan) -> str:
    if plan.count == 0:
        return "no candidate meets any characteristic"
    if plan.proven_anywhere:
        return "proven the fewest anywhere in the region"
    known = "the candidates" if plan.refinement is None else "the viewpoints known"
    anywhere = "" if plan.anywhere is None else f"; anywhere at least {plan.anywhere.count}"
    if plan.proven:
        return f"proven the fewest among {known}{anywhere}"
    return f"at least {plan.lower_bound} needed; gap {plan.gap:.0%}{anywhere}"


def _unfinished(plan: Plan) -> str:
    return "; interrupted: the best so far" if plan.interrupted else ""


def summary_section(plan: Plan) -> Markup:
    """The verdict and four figures: characteristics met, viewpoints, weakest characteristic, candidates."""
    text, good = verdict(plan)
    met = [characteristic for characteristic in plan.characteristics if characteristic.status == "met"]
    weakest = min(met, key=lambda characteristic: characteristic.probability, default=None)
    lowest = (DASH, "none met") if weakest is None else (weakest.id, f"probability {probability(weakest.probability)}")
    cards = (
        ("Characteristics met", f"{len(met)} of {len(plan.characteristics)}", _missing(plan)),
        ("Camera viewpoints", str(plan.count), _optimality(plan)),
        ("Least probable of those met", *lowest),
        ("Candidates tried", f"{plan.candidate_count:,}", f"seed {plan.seed}{_unfinished(plan)}"),
    )
    return render("summary.html", verdict=text, good=good, cards=cards)
