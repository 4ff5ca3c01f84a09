"""The sources of error in the groups in which people think of them."""

from __future__ import annotations

from collections.abc import Iterable

from ..evaluation.error_budget import GROUPS, ErrorBudget

__all__ = ["PARTS", "WORDS", "shares_of", "shown_parts"]

PARTS = {
    "translation": GROUPS["translation"],
    "rotation": GROUPS["rotation"],
    "u": (6,),
    "v": (7,),
    "edges": (8, 9),
    "calibration": (10,),
}
"""Indices into the sources of an error budget."""

WORDS = {
    "translation": "translation",
    "rotation": "rotation",
    "u": "pixels along u",
    "v": "pixels along v",
    "edges": "edge location",
    "calibration": "calibration",
}

_OPTIONAL = ("u", "v", "edges", "calibration")  # shown where the camera has them


def shown_parts(budgets: Iterable[ErrorBudget]) -> list[str]:
    """Names of those that any of some budgets has."""
    some = list(budgets)
    return [n for n in PARTS if n not in _OPTIONAL or any(b.share[list(PARTS[n])].any() for b in some)]


def shares_of(budget: ErrorBudget) -> dict[str, float]:
    """The share of each in the variance; they add to 1."""
    return {name: float(budget.share[list(sources)].sum()) for name, sources in PARTS.items()}
