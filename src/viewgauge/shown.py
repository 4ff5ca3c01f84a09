"""What results that can be shown have in common: they know no picture, and ask for one by name when they are shown.

So a law or a plan computes without any drawing, and stands below the layer that draws it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

__all__ = ["Shown"]

_DRAWN_BY = "viewgauge.report.notebook"


class Shown:
    """Something with a picture, and words for a notebook."""

    def plot(self, *arguments: Any, **options: Any) -> Figure:
        """The picture as a Plotly figure; what it takes is said in :mod:`viewgauge.report.notebook`."""
        figure: Figure = import_module(_DRAWN_BY).plot(self, *arguments, **options)
        return figure

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return str(import_module(_DRAWN_BY).described(self))
