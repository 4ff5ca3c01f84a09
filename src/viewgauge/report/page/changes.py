"""The least change of each thing that meets characteristics, as a table."""

from __future__ import annotations

from ...planning.improve.improvement import Change, Improvement
from ...planning.improve.knobs import knob_named
from ..wording import DASH, element, probability, rounded
from .tables import markup_table

__all__ = ["changes_table"]


def changes_table(improvement: Improvement) -> str:
    """A row for today, for each characteristic, and for the part; a column for each thing that can be changed."""
    knobs = list(improvement.today)
    pose_error = [("Characteristic", ""), ("Today", "num")]
    pose_error += [(f"{name.replace('_', ' ').capitalize()} / {knob_named(name).unit}", "num") for name in knobs]
    today = [element("th", "Today", scope="row"), element("td")]
    today += [element("td", rounded(improvement.today[name]), class_="num") for name in knobs]
    rows = [element("tr", markup="".join(today))]
    for d in improvement.characteristics:
        cells = [element("th", d.id, scope="row"), element("td", probability(d.probability), class_="num")]
        cells += [_change_cell(d.changes[name]) for name in knobs]
        rows.append(element("tr", markup="".join(cells), class_="met" if d.met else "not_met"))
    if improvement.part:
        cells = [element("th", "The part", scope="row"), element("td")]
        cells += [_change_cell(improvement.part[name]) for name in knobs]
        rows.append(element("tr", markup="".join(cells), class_="total"))
    return markup_table(pose_error, rows)


def _change_cell(change: Change) -> str:
    """A limit rounded to the side that keeps it; with what limits it for the pointer."""
    by = f"limited by {', '.join(change.limited_by)}" if change.limited_by else ""
    if change.interval is None:
        text = DASH if change.best_probability is None else f"({probability(change.best_probability)})"
        return element("td", text, class_="num hopeless", title=by)
    low, high = change.interval
    if change.unlimited:
        text = "any" if not low else f"> {rounded(low)}"
    elif low == 0 and high is not None:
        text = f"≤ {rounded(high)}"
    elif high is None:
        text = DASH if low is None else f"≥ {rounded(low, up=True)}"
    else:
        text = f"≤ {rounded(high)}" if low is None else f"{rounded(low, up=True)} to {rounded(high)}"
    return element("td", text, class_="num", title=by)
