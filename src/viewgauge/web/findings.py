"""The right side: all characteristics, the chosen characteristic, the chosen viewpoint."""

from __future__ import annotations

from typing import Any

import viser

from ..jobs.workbench.what_if import WhatIf
from ..planning.improve.answers import Answers
from ..report.charts import accuracy_chart, budget_chart, directions_chart, laws_chart
from ..report.palette import DARK, LIGHT
from ..report.workbench_markup import (
    answer_table,
    characteristic_facts,
    message,
    not_measurable_table,
    viewpoint_markup,
    workbench_style,
)

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
        with panel.add_tab("Characteristics"):
            self._table = gui.add_html(message("Loading …"))
        with panel.add_tab("Characteristic"):
            self.characteristic = gui.add_dropdown("Characteristic", (_NONE,))
            self._facts = gui.add_html(message("Choose a characteristic, here or in the picture."))
            self._charts = {
                name: gui.add_plotly(self._empty, config=_QUIET, aspect=height, visible=False)
                for name, height in (("laws", 0.88), ("accuracy", 0.8), ("budget", 0.48), ("directions", 0.9))
            }
        with panel.add_tab("Viewpoint"):
            self.viewpoint = gui.add_dropdown("Viewpoint", (_NONE,))
            self._view = gui.add_html(message("Choose a viewpoint, here or in the picture."))
        panel.dock_right()
        panel.set_width(_WIDTH_PX)

    def offer(self, characteristics: list[str], viewpoints: list[str]) -> None:
        """What can be chosen; what is chosen stays, if it still can be."""
        for dropdown, names in ((self.characteristic, characteristics), (self.viewpoint, viewpoints)):
            options = tuple(names) or (_NONE,)
            if tuple(dropdown.options) != options:
                chosen = dropdown.value
                dropdown.options = options
                choose(dropdown, chosen if chosen in options else options[0])

    @property
    def chosen_characteristic(self) -> str | None:
        """The id; None where there is none to choose."""
        return None if self.characteristic.value == _NONE else self.characteristic.value

    @property
    def chosen_viewpoint(self) -> str | None:
        """The name; None where there is none to choose."""
        return None if self.viewpoint.value == _NONE else self.viewpoint.value

    def show_not_measurable(self, what_if: WhatIf, *, dark: bool) -> None:
        """Where no characteristic can be measured: which there are, and why not."""
        style = workbench_style(DARK if dark else LIGHT)
        self._table.content = style + not_measurable_table(what_if.refused)
        for place in (self._facts, self._view):
            place.content = message("No characteristic can be measured.")
        for chart in self._charts.values():
            chart.visible = False

    def show_table(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """All characteristics."""
        style = workbench_style(DARK if dark else LIGHT)
        self._table.content = style + answer_table(answers, what_if.refused, self.chosen_characteristic)

    def show_characteristic(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """The chosen characteristic: its numbers by both models, laws, accuracy, budget and directions."""
        name = self.chosen_characteristic
        if name is None:
            return
        style = workbench_style(DARK if dark else LIGHT)
        answer, laws = answers.of(name), what_if.laws(answers, name)
        required, allowed = answers.setup.requirement.probability, answer.allowed_error_mm
        independent = None if laws is None else laws.independent_probability(allowed)
        self._facts.content = style + characteristic_facts(
            answer, None if independent is None else float(independent), what_if.said_by_plan(name)
        )
        distance = what_if.working_distance_mm(answers, name)
        found = what_if.directions(answers, name, distance)
        cameras = {viewpoint: (T[:3, 3] - found.target_mm).tolist() for viewpoint, T in answers.viewpoints.items()}
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

    def show_viewpoint(self, what_if: WhatIf, answers: Answers, *, dark: bool) -> None:
        """What the camera sees from the chosen viewpoint, and what it does not and why."""
        name = self.chosen_viewpoint
        if name is None or name not in answers.viewpoints:
            self._view.content = message("There is no viewpoint yet.")
            return
        view = what_if.view(answers, name)
        style = workbench_style(DARK if dark else LIGHT)
        required = answers.setup.requirement.probability
        self._view.content = style + viewpoint_markup(view, required, self.chosen_characteristic)

    def _draw(self, name: str, figure: dict[str, Any] | None) -> None:
        from plotly.graph_objects import Figure

        chart = self._charts[name]
        chart.visible = figure is not None
        if figure is not None:
            chart.figure = Figure(figure)
