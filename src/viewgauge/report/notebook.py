"""Plans, laws and tables in notebooks: their pictures as Plotly figures, and themselves in a few words.

``plan.plot()``, ``law.plot()``, ``measurand_laws.plot()`` and ``table.viewgauge.plot()`` come here.
"""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors.law import Law
from ..evaluation import MeasurandLaws
from ..part import Part
from ..planning import Plan
from ..sensors import Camera
from .charts import Figure, accuracy_chart, laws_chart, table_chart
from .charts.style import axis, figure, theme_of
from .page.ranking import STATUS_WORDS, ranked
from .page.summary import verdict
from .palette import NOT_MET_COLOUR, VIEWPOINT_COLOURS
from .pictures.part_scene import build_scene, measurand_scene
from .templating import Markup, render
from .wording import DASH, length, probability

if TYPE_CHECKING:
    import xarray as xr
    from plotly.graph_objects import Figure as PlotlyFigure

__all__ = ["described", "plot", "table_figure"]

_POINTS = 401
_INSIDE = 0.998  # of a law's probability is within its picture


class _Inspected(Protocol):
    @property
    def part(self) -> Part: ...
    @property
    def camera(self) -> Camera: ...


def _drawn(chart: Figure) -> PlotlyFigure:
    from plotly.graph_objects import Figure as PlotlyFigure

    return PlotlyFigure(chart)


@singledispatch
def plot(shown: object, *_: Any, **__: Any) -> PlotlyFigure:
    """The picture of something.

    Raises
    ------
    TypeError
        If it has none.
    """
    raise TypeError(f"a {type(shown).__name__} has no picture")


@plot.register(Plan)
def _plot_plan(plan: Plan, inspection: _Inspected | None = None) -> PlotlyFigure:
    """Measurands and cameras in three dimensions, with the part where its inspection is given."""
    scene = measurand_scene(plan) if inspection is None else build_scene(plan, inspection.part, inspection.camera)[0]
    return _drawn({"data": [*scene["part"], *scene["cameras"]], "layout": {**scene["layout"], "height": 560}})


@plot.register(Law)
def _plot_law(law: Law, *, name: str = "", dark: bool = False) -> PlotlyFigure:
    """The density, of each law where the parameters are arrays, in the unit of the parameters."""
    low, high = (np.asarray(end, dtype=float).ravel() for end in law.interval(_INSIDE))
    x = np.linspace(low.min(), high.max(), _POINTS)
    theme = theme_of(dark)
    shape = np.broadcast_shapes(law.mean().shape)
    densities = law.pdf(x.reshape(-1, *([1] * len(shape)))).reshape(_POINTS, -1)
    data = [
        {
            "type": "scatter",
            "mode": "lines",
            "x": x.tolist(),
            "y": column.tolist(),
            "name": f"{k}" if densities.shape[1] > 1 else "density",
            "line": {"width": 2.5, "color": VIEWPOINT_COLOURS[k % len(VIEWPOINT_COLOURS)]},
            "showlegend": densities.shape[1] > 1,
        }
        for k, column in enumerate(densities.T)
    ]
    title = name or type(law).__name__
    axes = {"xaxis": axis("error", theme), "yaxis": axis("density", theme, rangemode="tozero")}
    return _drawn(figure(data, theme, title, **axes))


@plot.register(MeasurandLaws)
def _plot_measurand_laws(
    laws: MeasurandLaws,
    allowed_error_mm: float | None = None,
    required: float | None = None,
    *,
    name: str = "the characteristic",
    dark: bool = False,
) -> PlotlyFigure:
    """Densities of the parts of the error; with a required probability, that of each accuracy."""
    allowed = 2 * laws.standard_uncertainty_mm if allowed_error_mm is None else allowed_error_mm
    if required is None:
        return _drawn(laws_chart(name, laws, allowed, dark=dark))
    return _drawn(accuracy_chart(name, laws, allowed, required, dark=dark))


def table_figure(table: xr.Dataset, *, dark: bool = False) -> PlotlyFigure:
    """The table viewpoint x characteristic of :func:`viewgauge.evaluate` as a map of probabilities."""
    return _drawn(
        table_chart(
            [str(name) for name in table.viewpoint.values],
            [str(name) for name in table.characteristic.values],
            table.probability.values,
            table.reason.values.astype(str),
            float(table.attrs["required_probability"]),
            dark=dark,
        )
    )


@singledispatch
def described(shown: object) -> str:
    """Something in a few words, as HTML that brings its own style and takes the inks of its surroundings."""
    return str(Markup("<pre>{}</pre>").format(repr(shown)))


@described.register(Plan)
def _described_plan(plan: Plan) -> str:
    text, good = verdict(plan)
    rows = [
        (
            d.id,
            f"{length(d.nominal_mm)} mm" if d.kind != "angle" else DASH,
            ("" if d.status == "met" else "✗ ") + STATUS_WORDS[d.status],
            probability(d.probability) if d.status.is_judged else DASH,
            ", ".join(acquisition.viewpoint for acquisition in d.acquisitions) or d.viewpoint or DASH,
        )
        for d in ranked(plan)
    ]
    return _words(
        "notebook_plan.html",
        verdict=text,
        good=good,
        viewpoints="1 viewpoint" if plan.count == 1 else f"{plan.count} viewpoints",
        rows=rows,
        not_met_colour=NOT_MET_COLOUR,
    )


@described.register(Law)
def _described_law(law: Law) -> str:
    low, high = law.interval(0.95)
    facts = (("mean", law.mean()), ("standard deviation", law.std()), ("95 % from", low), ("to", high))
    return _facts(type(law).__name__, [(name, _number(value)) for name, value in facts])


@described.register(MeasurandLaws)
def _described_measurand_laws(laws: MeasurandLaws) -> str:
    facts = [
        ("measurand", f"{length(laws.length_mm)} mm"),
        ("u of the error", f"{laws.standard_uncertainty_mm:.3g} mm"),
        ("from the camera pose", f"{float(laws.displacement.std()):.3g} mm"),
        ("from the camera", f"{float(laws.camera.std()):.3g} mm"),
    ]
    return _facts("Laws of the error of a characteristic", facts)


def _words(template: str, **values: Any) -> str:
    return str(render(template, **values))


def _facts(title: str, facts: list[tuple[str, str]]) -> str:
    return _words("notebook_facts.html", title=title, facts=facts)


def _number(value: NDArray[np.float64]) -> str:
    flat = np.asarray(value, dtype=float).ravel()
    reported = ", ".join(f"{number:.4g}" for number in flat[:4])
    return reported + (f", … ({flat.size})" if flat.size > 4 else "")
