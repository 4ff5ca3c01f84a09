"""The report's section with what the camera sees from each setting."""

from __future__ import annotations

from collections.abc import Sequence

from .view_picture import SettingView, unseen_table, view_picture
from .wording import element

__all__ = ["SHOWN", "view_section"]

SHOWN = 40
"""Most settings that are shown, so that the report stays below 10 MB."""


def view_section(views: Sequence[SettingView], required: float) -> str:
    """A simulated picture for each setting with its gauges, and what cannot be measured from there."""
    if not views:
        return ""
    hint = (
        "Simulated. Full lines are measured from here, broken ones could be; a diamond: less sure than required. "
        "A line's pointer text has its probability."
    )
    if len(views) > SHOWN:
        hint += f" The first {SHOWN} of {len(views)} settings are here."
    cards = "".join(
        element(
            "article",
            markup=element("h3", view.setting) + view_picture(view, required) + unseen_table(view.dimensions),
            class_="shot",
        )
        for view in views[:SHOWN]
    )
    heading = element("h2", "What the camera sees", id="views") + element("p", hint, class_="hint")
    return element("section", markup=heading + element("div", markup=cards, class_="shots"))
