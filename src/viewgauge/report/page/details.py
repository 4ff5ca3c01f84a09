"""What a report shows beside the plan itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from ...evaluation import CapabilityFigures, MeasurandLaws
from ...evaluation.error_budget import ErrorBudget
from ...planning.improve.improvement import Improvement
from ..pictures.view_picture import ViewpointView

__all__ = ["MOST_VIEWS", "PlanDetails"]

MOST_VIEWS = 40


@dataclass(frozen=True)
class PlanDetails:
    """Everything that follows from a plan; what is left out is not shown.

    Parameters
    ----------
    budgets, figures, laws
        By id, for the characteristics that have them.
    views
        The view of each viewpoint.
    improvement
        What to improve with the viewpoints as they stand.
    most_views, most_laws
        The largest number of viewpoints whose views are shown, and of characteristics, the least probable first, whose
        laws are.
    """

    budgets: Mapping[str, ErrorBudget] = field(default_factory=dict)
    figures: Mapping[str, CapabilityFigures] = field(default_factory=dict)
    laws: Mapping[str, MeasurandLaws] = field(default_factory=dict)
    views: Sequence[ViewpointView] = ()
    improvement: Improvement | None = None
    most_views: int = MOST_VIEWS
    most_laws: int = 300

    def fewer(self) -> PlanDetails:
        """With half as many views and laws, for a smaller report."""
        return replace(
            self,
            most_views=min(self.most_views, len(self.views)) // 2,
            most_laws=min(self.most_laws, len(self.laws)) // 2,
        )
