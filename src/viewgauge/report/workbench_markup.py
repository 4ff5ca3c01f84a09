"""The words and tables of the workbench, as pieces of HTML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..evaluation import Requirement
from ..part import NotMeasurable
from ..planning.improve.answers import Answers, CharacteristicAnswer
from .palette import NOT_MET_COLOUR, UNSEEN_COLOUR, Theme, probability_colour
from .pictures.view_picture import REASON_WORDS, ViewpointView, unseen_table, view_picture
from .templating import render
from .wording import DASH, length, probability, tolerance

__all__ = [
    "answer_table",
    "characteristic_facts",
    "legend",
    "message",
    "not_measurable_table",
    "verdict_markup",
    "viewpoint_markup",
    "workbench_style",
]

_RAMP_STEPS = 6


def _piece(template: str, **values: Any) -> str:
    """A template of the workbench as a plain string: viser sends no subclass of it."""
    return str(render(f"workbench/{template}", **values))


def workbench_style(theme: Theme) -> str:
    """The style of all pieces, to be put before the first."""
    return _piece("style.html", theme=theme)


def message(text: str, *, bad: bool = False) -> str:
    """A sentence on what is going on; ``bad`` for an error, which a screen reader tells at once."""
    return _piece("message.html", text=text, bad=bad)


def verdict_markup(answers: Answers, planned: Requirement) -> str:
    """How many characteristics the viewpoints meet, and the weakest.

    Parameters
    ----------
    planned
        The requirement of the inspection; the verdict says where a knob has changed it.
    """
    total, met, weakest = len(answers.characteristics), answers.met, answers.weakest
    if not answers.viewpoints:
        return message("No plan yet.")
    good = met == total
    cards = [("Viewpoints", str(len(answers.viewpoints)))]
    if weakest is not None:
        reached = probability(weakest.probability) if weakest.viewpoint is not None else "not seen"
        cards.append(("Weakest", f"{weakest.characteristic.id} {reached}"))
    requirement = answers.setup.requirement
    return _piece(
        "verdict.html",
        verdict=f"✓ All {total} characteristics are met"
        if good
        else f"✗ {total - met} of {total} characteristics are not met",
        good=good,
        cards=cards,
        requirement=requirement.text,
        turned=requirement != planned,
    )


def legend(required: float) -> str:
    """What the colours of measurands mean."""
    steps = [required * k / _RAMP_STEPS for k in range(_RAMP_STEPS)]
    steps += [required + (1 - required) * (1 - 10.0 ** (-k / 2)) for k in range(_RAMP_STEPS)]
    return _piece(
        "legend.html",
        ramp=[probability_colour(p, required) for p in steps],
        required=f"{required:g}",
        not_met_colour=NOT_MET_COLOUR,
        unseen_colour=UNSEEN_COLOUR,
    )


@dataclass(frozen=True)
class _AnswerRow:
    """A characteristic as it stands: how it is named, coloured and printed."""

    name: str
    colour: str
    nominal: str
    probability: float
    shown: str
    origin: str
    met: bool
    chosen: bool


def answer_table(answers: Answers, not_measurable: Sequence[NotMeasurable], chosen: str | None) -> str:
    """Every characteristic as it stands, the least probable first; what cannot be measured last."""
    answered = sorted(answers.characteristics, key=lambda answer: answer.probability)
    rows = [_answer_row(answer, answers.setup.requirement.probability, chosen) for answer in answered]
    return _piece("characteristics.html", rows=rows, not_measurable=not_measurable)


def not_measurable_table(not_measurable: Sequence[NotMeasurable]) -> str:
    """What cannot be measured, where nothing can."""
    return _piece("characteristics.html", rows=(), not_measurable=not_measurable)


def _answer_row(answer: CharacteristicAnswer, required: float, chosen: str | None) -> _AnswerRow:
    seen, characteristic = answer.viewpoint is not None, answer.characteristic
    return _AnswerRow(
        ("" if answer.met else "✗ ") + characteristic.id,
        probability_colour(answer.probability, required) if seen else UNSEEN_COLOUR,
        f"{length(characteristic.nominal_mm)} {tolerance(characteristic.tolerance_mm)}",
        answer.probability,
        probability(answer.probability) if seen else DASH,
        answer.viewpoint or REASON_WORDS.get(answer.reason, answer.reason),
        answer.met,
        characteristic.id == chosen,
    )


def characteristic_facts(answer: CharacteristicAnswer, independent: float | None, planned: Sequence[str] = ()) -> str:
    """The chosen characteristic in a few numbers: both models side by side.

    Parameters
    ----------
    planned
        What the plan says of it, in sentences.
    """
    characteristic = answer.characteristic
    rows = (
        ("Nominal", f"{length(characteristic.nominal_mm)} mm {tolerance(characteristic.tolerance_mm)}"),
        ("Allowed error", f"±{length(answer.allowed_error_mm)} mm"),
        ("Measured from", answer.viewpoint or f"nowhere: {REASON_WORDS.get(answer.reason, answer.reason)}"),
        ("Probability, joint model", probability(answer.probability) if answer.viewpoint else DASH),
        ("Probability, model of 1998", DASH if independent is None else probability(independent)),
    )
    return _piece("facts.html", rows=rows, warning=answer.warning, planned=planned)


def viewpoint_markup(view: ViewpointView, required: float, chosen: str | None) -> str:
    """What the camera sees from a viewpoint, and what it does not see and why."""
    picture = view_picture(view, required, chosen=chosen)
    return _piece("viewpoint.html", picture=picture, unseen=unseen_table(view.characteristics))
