"""The report's section with what the camera sees from each viewpoint."""

from __future__ import annotations

from collections.abc import Sequence

from ..pictures.view_picture import ViewpointView, unseen_table, view_picture
from ..wording import element

__all__ = ["view_section"]


def view_section(views: Sequence[ViewpointView], required: float, most: int) -> str:
    """A simulated picture with its measurands for each of at most so many viewpoints, and what cannot be measured
    there.
    """
    if not views[:most]:
        return ""
    hint = (
        "Simulated. Full lines are measured from here, broken ones could be; a diamond: less sure than required. "
        "A line's pointer text has its probability."
    )
    if len(views) > most:
        hint += f" The first {most} of {len(views)} viewpoints are here."
    cards = "".join(
        element(
            "article",
            markup=element("h3", view.viewpoint) + view_picture(view, required) + unseen_table(view.characteristics),
            class_="shot",
        )
        for view in views[:most]
    )
    heading = element("h2", "What the camera sees", id="views") + element("p", hint, class_="hint")
    return element("section", markup=heading + element("div", markup=cards, class_="shots"))
