"""The report's section with the laws of each characteristic, drawn when one is opened."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...evaluation import MeasurandLaws
from ...planning.plan import Plan, PlannedCharacteristic
from ..charts import Figure, accuracy_chart, laws_chart
from ..palette import NOT_MET_COLOUR
from ..templating import Markup, render
from ..wording import DASH, length, probability
from .ranking import ranked

__all__ = ["law_charts", "law_section"]


@dataclass(frozen=True)
class _LawRow:
    """A characteristic, the key of its charts, and its figures: pairs of a name and a text."""

    key: str
    characteristic: PlannedCharacteristic
    facts: tuple[tuple[str, str], ...]


def law_charts(
    plan: Plan, laws: Mapping[str, MeasurandLaws], required: float, most: int
) -> dict[str, tuple[Figure, Figure]]:
    """The two charts of each characteristic that is shown, by the key of its row in the section."""
    return {
        f"law-{k}": (
            laws_chart(d.id, laws[d.id], d.allowed_error_mm),
            accuracy_chart(d.id, laws[d.id], d.allowed_error_mm, required),
        )
        for k, d in enumerate(_shown(plan, laws, most))
    }


def law_section(plan: Plan, laws: Mapping[str, MeasurandLaws], most: int) -> Markup:
    """One line for each of at most so many characteristics, the least probable first; it opens to its charts."""
    rows = [_LawRow(f"law-{k}", d, _facts(d, laws[d.id])) for k, d in enumerate(_shown(plan, laws, most))]
    if not rows:
        return Markup()
    return render("laws.html", rows=rows, total=len(laws), not_met_colour=NOT_MET_COLOUR)


def _shown(plan: Plan, laws: Mapping[str, MeasurandLaws], most: int) -> list[PlannedCharacteristic]:
    return [characteristic for characteristic in ranked(plan) if characteristic.id in laws][:most]


def _facts(characteristic: PlannedCharacteristic, laws: MeasurandLaws) -> tuple[tuple[str, str], ...]:
    independent = laws.independent_probability(characteristic.allowed_error_mm)
    return (
        ("u", f"{length(laws.standard_uncertainty_mm)} mm"),
        ("allowed", f"±{length(characteristic.allowed_error_mm)} mm"),
        ("probability", probability(float(laws.probability(characteristic.allowed_error_mm)))),
        ("by the model of 1998", DASH if independent is None else probability(float(independent))),
    )
