"""The report's section with the laws of each characteristic, drawn when one is opened."""

from __future__ import annotations

from collections.abc import Mapping

from ...evaluation import MeasurandLaws
from ...planning.plan import Plan, PlannedCharacteristic
from ..charts import Figure, accuracy_chart, laws_chart
from ..palette import NOT_MET_COLOUR
from ..wording import DASH, element, length, probability
from .tables import STATUS_WORDS

__all__ = ["law_charts", "law_section"]


def law_charts(
    plan: Plan, laws: Mapping[str, MeasurandLaws], required: float, most: int
) -> dict[str, tuple[Figure, Figure]]:
    """The two charts of each characteristic that is shown, by the place of its row in the section."""
    return {
        f"law-{k}": (
            laws_chart(d.id, laws[d.id], d.allowed_error_mm),
            accuracy_chart(d.id, laws[d.id], d.allowed_error_mm, required),
        )
        for k, d in enumerate(_shown(plan, laws, most))
    }


def law_section(plan: Plan, laws: Mapping[str, MeasurandLaws], most: int) -> str:
    """One line for each of at most so many characteristics, the least sure first; it opens to its charts."""
    shown = _shown(plan, laws, most)
    if not shown:
        return ""
    hint = (
        "The error of each characteristic as a law: what pixels and pose do to it, together and apart, and "
        "how surely which "
        "accuracy is reached. Dotted: the model of 1998, which takes the two ends as independent. Open one to see it."
    )
    if len(shown) < len(laws):
        hint += f" The {len(shown)} least sure of {len(laws)} characteristics are here."
    rows = "".join(_row(k, d, laws[d.id]) for k, d in enumerate(shown))
    heading = element("h2", "Laws of the error", id="laws")
    return element("section", markup=heading + element("p", hint, class_="hint") + rows)


def _shown(plan: Plan, laws: Mapping[str, MeasurandLaws], most: int) -> list[PlannedCharacteristic]:
    order = list(STATUS_WORDS)
    ranked = sorted(
        plan.characteristics,
        key=lambda characteristic: (order.index(characteristic.status), characteristic.probability),
    )
    return [characteristic for characteristic in ranked if characteristic.id in laws][:most]


def _row(k: int, characteristic: PlannedCharacteristic, laws: MeasurandLaws) -> str:
    independent = laws.independent_probability(characteristic.allowed_error_mm)
    facts = (
        ("u", f"{length(laws.standard_uncertainty_mm)} mm"),
        ("allowed", f"±{length(characteristic.allowed_error_mm)} mm"),
        ("probability", probability(float(laws.probability(characteristic.allowed_error_mm)))),
        ("by the model of 1998", DASH if independent is None else probability(float(independent))),
    )
    reported = "".join(element("span", f"{name} {value}", class_="fact") for name, value in facts)
    mark = "" if characteristic.status == "met" else element("span", "✗ ", style=f"color:{NOT_MET_COLOUR}")
    warned = ""
    if characteristic.warning:
        words = (
            f"The small-error model is doubtful here ({characteristic.warning}); the table has the full camera "
            "model's word."
        )
        warned = element("p", words, class_="hint")
    summary = element("summary", markup=mark + element("b", characteristic.id) + reported)
    charts = "".join(f'<div class="chart" id="law-{k}-{half}"></div>' for half in (0, 1))
    return f'<details class="law" data-law="law-{k}">{summary}{warned}<div class="charts">{charts}</div></details>'
