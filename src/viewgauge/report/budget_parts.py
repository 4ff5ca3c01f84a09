"""The sources of error in the parts in which people think of them."""

from __future__ import annotations

from collections.abc import Iterable

from ..evaluation.error_budget import ErrorBudget

__all__ = ["shares_of", "shown_parts"]

_ALWAYS = ("translation", "rotation")  # the others are shown where a budget has them


def shown_parts(budgets: Iterable[ErrorBudget]) -> dict[str, str]:
    """Words of the parts that any of some budgets has, by name, in their order."""
    some = list(budgets)
    words = {component.part: component.words for budget in some for component in budget.components}
    return {part: text for part, text in words.items() if part in _ALWAYS or any(_has(budget, part) for budget in some)}


def shares_of(budget: ErrorBudget) -> dict[str, float]:
    """The share of each part in the variance; they add to 1."""
    parts = dict.fromkeys(component.part for component in budget.components)
    return {part: float(budget.share[_places(budget, part)].sum()) for part in parts}


def _has(budget: ErrorBudget, part: str) -> bool:
    return bool(budget.share[_places(budget, part)].any())


def _places(budget: ErrorBudget, part: str) -> list[int]:
    return [place for place, component in enumerate(budget.components) if component.part == part]
