"""What a report shows beside the plan itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..evaluation import GaugeFigures, GaugeLaws
from ..evaluation.budget import ErrorBudget
from ..planning.improvement import Improvement
from .view_picture import SettingView

__all__ = ["PlanDetails"]


@dataclass(frozen=True)
class PlanDetails:
    """Everything that follows from a plan; what is left out is not shown.

    Parameters
    ----------
    budgets, figures, laws
        Of dimensions, by id, as far as they have some.
    views
        Of settings.
    improvement
        What to improve with the settings as they stand.
    """

    budgets: Mapping[str, ErrorBudget] = field(default_factory=dict)
    figures: Mapping[str, GaugeFigures] = field(default_factory=dict)
    laws: Mapping[str, GaugeLaws] = field(default_factory=dict)
    views: Sequence[SettingView] = ()
    improvement: Improvement | None = None
