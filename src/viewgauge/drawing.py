"""Results that can be drawn: they know no picture, and what draws them is registered here.

So a law or a plan is computed without anything that draws, and stands below the layer that draws it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import xarray as xr
    from plotly.graph_objects import Figure

__all__ = ["Drawable", "Drawing", "draw_with", "drawing"]


class Drawing(Protocol):
    """What draws results in notebooks: :mod:`viewgauge.report.notebook`."""

    def plot(self, result: object, *arguments: Any, **options: Any) -> Figure:
        """The picture of a result as a Plotly figure."""
        ...

    def table_figure(self, table: xr.Dataset, *, dark: bool = False) -> Figure:
        """The table viewpoint x characteristic as a map of probabilities."""
        ...

    def described(self, result: object) -> str:
        """A result in a few words of HTML."""
        ...


_loaders: list[Callable[[], Drawing]] = []
"""At most one."""


def draw_with(loader: Callable[[], Drawing]) -> None:
    """Register what draws results; the loader is called when a picture is first asked for."""
    _loaders[:] = [loader]


def drawing() -> Drawing:
    """What draws results.

    Raises
    ------
    RuntimeError
        If nothing is registered; importing :mod:`viewgauge` registers :mod:`viewgauge.report.notebook`.
    """
    if not _loaders:
        raise RuntimeError(
            "nothing that draws results is registered: draw_with(...) registers it, as importing viewgauge does"
        )
    return _loaders[0]()


class Drawable:
    """A result with a picture, and words for a notebook."""

    def plot(self, *arguments: Any, **options: Any) -> Figure:
        """The picture as a Plotly figure; :mod:`viewgauge.report.notebook` says which options each result has."""
        return drawing().plot(self, *arguments, **options)

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        return drawing().described(self)
