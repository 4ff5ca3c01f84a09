"""The least change of each thing that meets characteristics, as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...planning.improve.improvement import Change, Improvement
from ...planning.improve.knobs import knob_named
from ..wording import DASH, probability, rounded

__all__ = ["ChangesTable", "changes_table"]


@dataclass(frozen=True)
class ChangeCell:
    """A limit as it is printed, what limits it, and whether any change will do at all."""

    text: str
    limited_by: str = ""
    possible: bool = True


@dataclass(frozen=True)
class ChangesRow:
    """Today, a characteristic, or the part: its state today, and a cell for each thing that can be changed."""

    name: str
    kind: str
    today: str
    cells: Sequence[ChangeCell]


@dataclass(frozen=True)
class ChangesTable:
    """The rows, the columns of what can be changed with their class, and the characteristics that are not seen."""

    columns: Sequence[tuple[str, str]]
    rows: Sequence[ChangesRow]
    left_out: Sequence[str]


def changes_table(improvement: Improvement) -> ChangesTable:
    """A row for today, for each characteristic, and for the part; a column for each thing that can be changed."""
    knobs = list(improvement.today)

    def cells(changes: Mapping[str, Change]) -> list[ChangeCell]:
        return [_cell(changes[name]) for name in knobs]

    rows = [ChangesRow("Today", "", "", [ChangeCell(rounded(improvement.today[name])) for name in knobs])]
    rows += [
        ChangesRow(d.id, "met" if d.met else "not_met", probability(d.probability), cells(d.changes))
        for d in improvement.characteristics
    ]
    if improvement.part:
        rows.append(ChangesRow("The part", "total", "", cells(improvement.part)))
    columns = [(f"{name.replace('_', ' ').capitalize()} / {knob_named(name).unit}", "num") for name in knobs]
    return ChangesTable(columns, rows, improvement.left_out)


def _cell(change: Change) -> ChangeCell:
    """A limit rounded to the side that keeps it; where no change will do, the best probability in brackets."""
    by = f"limited by {', '.join(change.limited_by)}" if change.limited_by else ""
    if change.interval is None:
        best = DASH if change.best_probability is None else f"({probability(change.best_probability)})"
        return ChangeCell(best, by, possible=False)
    low, high = change.interval
    if change.unlimited:
        text = "any" if not low else f"> {rounded(low)}"
    elif low == 0 and high is not None:
        text = f"≤ {rounded(high)}"
    elif high is None:
        text = DASH if low is None else f"≥ {rounded(low, up=True)}"
    else:
        text = f"≤ {rounded(high)}" if low is None else f"{rounded(low, up=True)} to {rounded(high)}"
    return ChangeCell(text, by)
