"""Colours of the settings, told apart by colour-blind readers too."""

from __future__ import annotations

from ..planning.result import Plan

__all__ = ["UNMET_COLOUR", "setting_colours", "setting_markers"]

# Okabe and Ito, "Color Universal Design", 2008, without black, yellow (invisible on white) and vermilion.
SETTING_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#7A5195")
MARKERS = ("circle", "square", "circle-open", "square-open")  # the diamond is kept for what is not met
UNMET_COLOUR = "#D00000"


def setting_colours(plan: Plan) -> dict[str, str]:
    """A colour per setting id; with more settings than colours they repeat with another marker."""
    return {setting.id: SETTING_COLOURS[k % len(SETTING_COLOURS)] for k, setting in enumerate(plan.settings)}


def setting_markers(plan: Plan) -> dict[str, str]:
    """A marker per setting id."""
    return {setting.id: MARKERS[k // len(SETTING_COLOURS) % len(MARKERS)] for k, setting in enumerate(plan.settings)}
