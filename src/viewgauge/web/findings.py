"""The right side: all dimensions, the chosen dimension, the chosen setting."""

from __future__ import annotations

from typing import Any

import viser

from ..jobs.workbench.what_if import WhatIf
from ..planning.improve.answers import Answers
from ..report.charts import accuracy_chart, budget_chart, directions_chart, laws_chart
from ..report.palette import DARK, LIGHT
from ..report.pictures.view_picture import unseen_table, view_picture
from ..report.workbench import answer_table, bench_style, dimension_facts, message, refused_table

__all__ = ["Findings", "choose"]

_WIDTH_PX = 470
_QUIET = {"displayModeBar": False, "responsive": True}
_NONE = "–"


def choose(dropdown: Any, name: str) -> None:
    """Put a dropdown on a name (typed so loosely because viser's own types take a dropdown's value for fixed)."""
    dropdown.value = name


class Findings:
    """The visitor's tables, charts and views."""

    def __init__(self, client: viser.ClientHandle) -> None:
        from plotly.graph_objects import Figure

        gui = client.gui
        self._empty = Figure()
        panel = gui.add_panel()
        with panel.add_tab("Dimensions"):
            self._table = gui.add_html(message("Loading …"))
        with panel.add_tab("Dimension"):
            self.dimension = gui.add_dropdown("Dimension", (_NONE,))
            self._facts = gui.add_html(message("Choose a dimension, here or in the picture."))
            self._charts = {
                name: gui.add_plotly(self._empty, config=_QUIET, aspect=height, visible=False)
                for name, height in (("laws", 0.88), ("accuracy", 0.8), ("budget", 0.48), ("directions", 0.9))
            }
        with panel.add_tab("Setting"):
            self.setting = gui.add_dropdown("Setting", (_NONE,))
            self._view = gui.add_html(message("Choose a setting, here or in the picture."))
        panel.dock_right()
        panel.set_width(_WIDTH_PX)

    def offer(self, dimensions: list[str], settings: list[str]) -> None:
        """What can be chosen; what is chosen stays, if it still can be."""
        for dropdown, names in ((self.dimension, dimensions), (self.setting, settings)):
            options = tuple(names) or (_NONE,)
            if tuple(dropdown.options) != options:
                chosen = dropdown.value
                dropdown.options = options
                choose(dropdown, chosen if chosen in options else options[0])

    @property
    def chosen_dimension(self) -> str | None:
        """The id; None where there is none to choose."""
        return None if self.dimension.value == _NONE else self.dimension.value

    @property
    def chosen_setting(self) -> str | None:
        """The name; None where there is none to choose."""
        return None if self.setting.value == _NONE else self.setting.value

    def show_refused(self, what_if: WhatIf, *, dark: bool) -> None:
        """Where no dimension can be measured: which there are, and why not."""
        style = bench_style(DARK if dark else LIGHT)
        self._table.content = style + refused_table(what_if.refused)
        for place in (self._facts, self._view):
            place.content = message("No dimension can be measured.")
        for chart in self._charts.values():
            chart.visible = False

    def show_table(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """All dimensions."""
        style = bench_style(DARK if dark else LIGHT)
        self._table.content = style + answer_table(answers, what_if.refused, self.chosen_dimension)

    def show_dimension(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """The chosen dimension: its numbers by both models, laws, accuracy, budget and directions."""
        name = self.chosen_dimension
        if name is None:
            return
        style = bench_style(DARK if dark else LIGHT)
        answer, laws = answers.of(name), what_if.laws(answers, name)
        required, allowed = answers.requirement.probability, answer.allowed_error_mm
        independent = None if laws is None else laws.independent_probability(allowed)
        self._facts.content = style + dimension_facts(
            answer, None if independent is None else float(independent), what_if.said_by_plan(name)
        )
        distance = what_if.working_distance_mm(answers, name)
        found = what_if.directions(answers, name, distance)
        cameras = {setting: (T[:3, 3] - found.target_mm).tolist() for setting, T in answers.settings.items()}
        figures: dict[str, dict[str, Any] | None] = {
            "laws": None,
            "accuracy": None,
            "budget": None,
            "directions": directions_chart(found, required, cameras, dark=dark),
        }
        budget = what_if.budget(answers, name)
        if laws is not None and budget is not None:
            figures["laws"] = laws_chart(name, laws, allowed, dark=dark)
            figures["accuracy"] = accuracy_chart(name, laws, allowed, required, dark=dark)
            figures["budget"] = budget_chart({name: budget}, dark=dark)
        for chart, figure in figures.items():
            self._draw(chart, figure)

    def show_setting(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """What the camera sees from the chosen setting, and what it does not and why."""
        name = self.chosen_setting
        if name is None or name not in answers.settings:
            self._view.content = message("There is no setting yet.")
            return
        view = what_if.view(answers, name)
        picture = view_picture(view, answers.requirement.probability, chosen=self.chosen_dimension)
        style = bench_style(DARK if dark else LIGHT)
        self._view.content = f'{style}<div class="vg">{picture}{unseen_table(view.dimensions)}</div>'

    def _draw(self, name: str, figure: dict[str, Any] | None) -> None:
        from plotly.graph_objects import Figure

        chart = self._charts[name]
        chart.visible = figure is not None
        if figure is not None:
            chart.figure = Figure(figure)
