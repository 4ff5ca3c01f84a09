"""The report's section with what the camera sees from each viewpoint."""

from __future__ import annotations

from collections.abc import Sequence

from ..pictures.view_picture import ViewpointView, unseen_table, view_picture
from ..templating import Markup, render

__all__ = ["view_section"]


def view_section(views: Sequence[ViewpointView], required: float, most: int) -> Markup:
    """A simulated picture with its measurands for each of at most so many viewpoints, and what cannot be measured
    there.
    """
    shown = [(v.viewpoint, view_picture(v, required), unseen_table(v.characteristics)) for v in views[:most]]
    if not shown:
        return Markup()
    return render("views.html", views=shown, left_out=len(views) - len(shown))
