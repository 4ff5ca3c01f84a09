"""The words and tables of the workbench, as pieces of HTML."""

from __future__ import annotations

from collections.abc import Sequence

from ..evaluation import Requirement
from ..part import NotMeasurable
from ..planning.improve.answers import Answers, CharacteristicAnswer
from .palette import NOT_MET_COLOUR, UNSEEN_COLOUR, Theme, probability_colour
from .pictures.view_picture import REASON_WORDS
from .wording import DASH, element, length, probability, requirement_text, tolerance

__all__ = [
    "answer_table",
    "characteristic_facts",
    "legend",
    "message",
    "not_measurable_table",
    "verdict_markup",
    "workbench_style",
]


def workbench_style(theme: Theme) -> str:
    """The style of all pieces, to be put before the first."""
    return f"""<style>
.vg {{ padding: 2px 14px 2px 8px; font-size: 13px; line-height: 1.45; color: {theme.ink}; }}
.vg p {{ margin: 4px 0; }}
.vg .soft {{ color: {theme.soft}; }}
.vg .verdict {{ font-size: 17px; font-weight: 650; padding: 8px 12px; border-radius: 6px; border-left: 5px solid;
  background: {theme.panel}; }}
.vg .good {{ color: {theme.good}; }}
.vg .bad {{ color: {theme.bad}; }}
.vg .cards {{ display: grid; grid-template-columns: 1fr 1fr; gap: 6px; margin: 6px 0; }}
.vg .card {{ background: {theme.panel}; border-radius: 6px; padding: 6px 10px; }}
.vg .card b {{ display: block; font-size: 16px; overflow-wrap: anywhere; }}
.vg table {{ border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }}
.vg th, .vg td {{ text-align: left; padding: 3px 6px; border-bottom: 1px solid {theme.line}; vertical-align: top; }}
.vg thead th {{ color: {theme.soft}; font-weight: 600; }}
.vg .num {{ text-align: right; white-space: nowrap; }}
.vg tr.chosen {{ background: {theme.panel}; outline: 2px solid {theme.soft}; outline-offset: -2px; }}
.vg .swatch {{ display: inline-block; width: 11px; height: 11px; border-radius: 2px; margin-right: 6px; }}
.vg .ramp {{ display: flex; height: 12px; border-radius: 3px; overflow: hidden; }}
.vg .ramp span {{ flex: 1; }}
.vg .ends {{ display: flex; justify-content: space-between; color: {theme.soft}; font-size: 12px; }}
.vg caption {{ text-align: left; color: {theme.soft}; padding: 6px 0 2px; }}
.vg .error {{ white-space: pre-wrap; overflow-wrap: anywhere; border-left: 5px solid {theme.bad}; padding: 6px 10px;
  background: {theme.panel}; border-radius: 6px; font-size: 12.5px; }}
</style>"""


def _piece(markup: str) -> str:
    return element("div", markup=markup, class_="vg")


def message(text: str, *, bad: bool = False) -> str:
    """A sentence on what is going on; ``bad`` for an error, which a screen reader tells at once."""
    if bad:
        return _piece(element("div", text, class_="error", role="alert"))
    return _piece(element("p", text, class_="soft", role="status"))


def verdict_markup(answers: Answers, planned: Requirement) -> str:
    """What an acquisition is enough for: how many characteristics are met, and the weakest.

    Parameters
    ----------
    planned
        The requirement of the inspection, which is told where it was turned.
    """
    total, met, weakest = len(answers.characteristics), answers.met, answers.weakest
    if not answers.viewpoints:
        return message("No plan yet.")
    good = met == total
    text = (
        f"✓ All {total} characteristics are met" if good else f"✗ {total - met} of {total} characteristics are not met"
    )
    cards = [("Viewpoints", str(len(answers.viewpoints)))]
    if weakest is not None:
        sure = probability(weakest.probability) if weakest.viewpoint is not None else "not seen"
        cards.append(("Weakest", f"{weakest.characteristic.id} {sure}"))
    shown = "".join(
        element("div", markup=element("span", name, class_="soft") + element("b", value), class_="card")
        for name, value in cards
    )
    changed = "" if answers.setup.requirement == planned else " (turned)"
    return _piece(
        element("div", text, class_=f"verdict {'good' if good else 'bad'}", role="status", aria_live="polite")
        + element("div", markup=shown, class_="cards")
        + element("p", f"Required: {requirement_text(answers.setup.requirement)}{changed}", class_="soft")
    )


def legend(required: float) -> str:
    """What the colours of measurands mean."""
    steps = [required * k / 6 for k in range(6)]
    steps += [required + (1 - required) * (1 - 10.0 ** (-k / 2)) for k in range(6)]
    ramp = "".join(element("span", style=f"background:{probability_colour(p, required)}") for p in steps)
    signs = (
        element("span", class_="swatch", style=f"background:{NOT_MET_COLOUR};transform:rotate(45deg)")
        + "not met: thick, with a diamond &ensp; "
        + element("span", class_="swatch", style=f"background:{UNSEEN_COLOUR}")
        + "not seen, with a red diamond"
    )
    ends = element("span", "0") + element("span", f"{required:g} required") + element("span", "1")
    return _piece(
        element("p", "Probability", class_="soft")
        + element("div", markup=ramp, class_="ramp", role="img", aria_label=f"Colours from 0 over {required:g} to 1")
        + element("div", markup=ends, class_="ends")
        + element("p", markup=signs)
    )


def answer_table(answers: Answers, refused: Sequence[NotMeasurable], chosen: str | None) -> str:
    """Every characteristic as it stands, the least sure first; what cannot be measured last."""
    pose_error = "".join(
        element("th", name, scope="col", class_=kind)
        for name, kind in (("Characteristic", ""), ("Nominal / mm", "num"), ("Probability", "num"), ("From", ""))
    )
    ranked = sorted(answers.characteristics, key=lambda answer: answer.probability)
    rows = "".join(_answer_row(answer, answers.setup.requirement.probability, chosen) for answer in ranked)
    rows += _not_measurable_rows(refused)
    return _piece(
        element(
            "table", markup=element("thead", markup=element("tr", markup=pose_error)) + element("tbody", markup=rows)
        )
    )


def not_measurable_table(refused: Sequence[NotMeasurable]) -> str:
    """What cannot be measured, where nothing can."""
    return _piece(element("table", markup=element("tbody", markup=_not_measurable_rows(refused))))


def _not_measurable_rows(refused: Sequence[NotMeasurable]) -> str:
    rows = []
    for not_measurable in refused:
        why = element("td", f"not measurable: {not_measurable.reason}", colspan="3")
        rows.append(element("tr", markup=element("th", not_measurable.id, scope="row") + why))
    return "".join(rows)


def _answer_row(answer: CharacteristicAnswer, required: float, chosen: str | None) -> str:
    characteristic = answer.characteristic
    seen = answer.viewpoint is not None
    colour = probability_colour(answer.probability, required) if seen else UNSEEN_COLOUR
    swatch = element("span", class_="swatch", style=f"background:{colour}")
    mark = "" if answer.met else "✗ "
    sure = probability(answer.probability) if seen else DASH
    cells = (
        element("th", markup=swatch + element("span", mark + characteristic.id), scope="row"),
        element("td", f"{length(characteristic.nominal_mm)} {tolerance(characteristic.tolerance_mm)}", class_="num"),
        element("td", sure, class_="num" + ("" if answer.met else " bad"), title=repr(answer.probability)),
        element("td", answer.viewpoint or REASON_WORDS.get(answer.reason, answer.reason)),
    )
    return element("tr", markup="".join(cells), class_="chosen" if characteristic.id == chosen else "")


def characteristic_facts(answer: CharacteristicAnswer, independent: float | None, planned: Sequence[str] = ()) -> str:
    """The chosen characteristic in a few numbers: both models side by side.

    Parameters
    ----------
    planned
        What the plan says of it, in sentences.
    """
    rows = (
        ("Nominal", f"{length(answer.characteristic.nominal_mm)} mm {tolerance(answer.characteristic.tolerance_mm)}"),
        ("Allowed error", f"±{length(answer.allowed_error_mm)} mm"),
        ("Measured from", answer.viewpoint or f"nowhere: {REASON_WORDS.get(answer.reason, answer.reason)}"),
        ("Probability, joint model", probability(answer.probability) if answer.viewpoint else DASH),
        ("Probability, model of 1998", DASH if independent is None else probability(independent)),
    )
    body = "".join(
        element("tr", markup=element("th", k, scope="row") + element("td", v, class_="num")) for k, v in rows
    )
    reported = element("table", markup=element("tbody", markup=body))
    if answer.warning:
        words = (
            f"The small-error model is doubtful here ({answer.warning}); plan again for the full camera model's word."
        )
        reported += element("p", words, class_="soft")
    for sentence in planned:
        reported += element("p", f"Plan: {sentence}.", class_="soft")
    return _piece(reported)
