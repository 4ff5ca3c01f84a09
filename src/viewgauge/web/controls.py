"""The left side: the verdict, the knobs, planning again, what is shown, files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import viser

from ..planning.improve.knob_values import KnobValues
from ..planning.inspection import Inspection
from .uploads import INSPECTION_SUFFIXES, OTHER_SUFFIXES

__all__ = ["LOOK_AT", "Controls"]

LOOK_AT = ("the part", "everything", "from the viewpoint")

_STEPS = 50  # of a slider, for today's value


@dataclass(frozen=True)
class _Dial:
    """How a knob is shown: its words, and the number for a value and back."""

    label: str
    hint: str
    field: str
    unit: float = 1.0


_DIALS = (
    _Dial("Pixel pitch / µm", "The sensor keeps its size: smaller pixels are more pixels.", "pixel_pitch_mm", 1e3),
    _Dial("Edge location / px", "The step of the edge detector, or its noise: 1 is a whole pixel.", "edge_px"),
    _Dial("Focal length / mm", "The cameras stay where they are.", "focal_length_mm"),
    _Dial("Distance / % of the planned", "This moves all cameras along their optical axes.", "distance", 100.0),
    _Dial(
        "Pose: translation / mm",
        "The pose uncertainty: the largest of its three standard deviations.",
        "translation_mm",
    ),
    _Dial(
        "Pose: rotation / deg",
        "The pose uncertainty: the largest of its three standard deviations.",
        "rotation_rad",
        180 / math.pi,
    ),
)


class Controls:
    """The visitor's knobs and buttons.

    Parameters
    ----------
    turned
        Called after a knob was turned by the visitor.
    reset
        Called after all were put back.
    """

    def __init__(self, client: viser.ClientHandle, turned: Callable[[], None], reset: Callable[[], None]) -> None:
        self._gui = client.gui
        self._turned, self._put_back = turned, reset
        self._dials: dict[str, Any] = {}
        self._holds = True  # while values are set, nobody has turned anything
        gui = self._gui
        gui.set_panel_label("viewgauge workbench")
        self.style = gui.add_html("")
        self.verdict = gui.add_html("")
        self.legend = gui.add_html("")
        self.replan = gui.add_button("Plan again", hint="Looks for the fewest viewpoints with the knobs as they are.")
        self.cancel = gui.add_button("Cancel planning", color="red", visible=False)
        self.bar = gui.add_progress_bar(0.0, visible=False, animated=True)
        self.stage = gui.add_html("", visible=False)
        self.knobs_folder = gui.add_folder("What if …")
        with gui.add_folder("Show", expand_by_default=False):
            self.look = gui.add_button_group("View", LOOK_AT)
            self.see_through = gui.add_checkbox("See through the part", False)
            self.names = gui.add_checkbox("Names of the characteristics", False)
            self.candidates = gui.add_checkbox("Candidate viewpoints", False)
            self.directions = gui.add_checkbox("Directions of the chosen characteristic", False)
            self.drag = gui.add_checkbox("Drag the chosen viewpoint", False)
            self.dark = gui.add_checkbox("Dark page", False)
        with gui.add_folder("Files", expand_by_default=False):
            self.upload_other = gui.add_upload_button(
                "Send a part or another named file",
                mime_type=",".join(OTHER_SUFFIXES),
                hint="Send it before the inspection file that names it.",
            )
            self.upload = gui.add_upload_button("Load an inspection file", mime_type=",".join(INSPECTION_SUFFIXES))
            self.save_inspection = gui.add_button(
                "Save the inspection (YAML)", hint="Saves the inspection with the knobs as they are."
            )
            self.save_report = gui.add_button(
                "Save the report (HTML)", hint="Saves the report of the plan as it was made."
            )
            self.save_plan = gui.add_button(
                "Save the plan (ZIP)", hint="Saves plan.json, the viewpoints, the assignments and the report."
            )
            self.save_viewpoints = gui.add_button(
                "Save the viewpoints (CSV)", hint="Saves the poses of the cameras as they stand now."
            )
            self.file_message = gui.add_html("")

    def show_knobs(self, inspection: Inspection, knobs: KnobValues) -> None:
        """Dials around the values of an inspection, in place of those that are there."""
        self._holds = True
        for handle in self._dials.values():
            handle.remove()
        self._dials.clear()
        with self.knobs_folder:
            for dial in _DIALS:
                self._dials[dial.field] = self._dial(dial, getattr(knobs, dial.field))
            self._dials["required"] = self._required(inspection, knobs)
            self._dials["probability"] = self._gui.add_slider(
                "Probability Th",
                min=min(0.5, knobs.probability),
                max=max(0.9999, knobs.probability),
                step=0.0005,
                initial_value=knobs.probability,
                disabled=knobs.required is None,
                hint="The probability that every characteristic must reach.",
            )
            reset = self._gui.add_button(
                "Reset", hint="Puts all knobs back to the inspection's values, and all cameras where they were planned."
            )
        self._dials["reset"] = reset
        reset.on_click(lambda _: self._reset(knobs))
        for field, handle in self._dials.items():
            if field != "reset":
                handle.on_update(lambda _: None if self._holds else self._turned())
        self._holds = False

    def values(self, today: KnobValues) -> KnobValues:
        """Where the knobs stand; today's own value where a dial shows it."""
        changes: dict[str, float] = {}
        for dial in _DIALS:
            shown, was = float(self._dials[dial.field].value), dial.unit * getattr(today, dial.field)
            if not math.isclose(shown, was, rel_tol=1e-6):
                changes[dial.field] = shown / dial.unit
        if today.required is not None:
            for field, scale in (("required", self._required_scale), ("probability", 1.0)):
                shown = float(self._dials[field].value) / scale
                if not math.isclose(shown, getattr(today, field), rel_tol=1e-9):
                    changes[field] = shown
        return replace(today, **changes)

    def set_distance(self, distance: float) -> None:
        """Put the dial of the distance somewhere, without anybody having turned it."""
        self._holds = True
        self._dials["distance"].value = 100.0 * distance
        self._holds = False

    def _reset(self, knobs: KnobValues) -> None:
        self._holds = True
        for dial in _DIALS:
            self._dials[dial.field].value = _shown(dial.unit * getattr(knobs, dial.field))
        if knobs.required is not None:
            self._dials["required"].value = _shown(self._required_scale * knobs.required)
            self._dials["probability"].value = knobs.probability
        self._holds = False
        self._put_back()

    def _dial(self, dial: _Dial, value: float) -> Any:
        shown = _shown(dial.unit * value)
        step = _nice(shown / _STEPS) if shown else 1.0
        high = step * math.ceil(4 * shown / step) if shown else 1.0
        return self._gui.add_slider(
            dial.label,
            min=step if shown else 0.0,
            max=max(high, shown),
            step=step,
            initial_value=shown,
            disabled=not shown,
            hint=dial.hint if shown else f"{dial.hint} It is zero in this inspection.",
        )

    def _required(self, inspection: Inspection, knobs: KnobValues) -> Any:
        requirement = inspection.requirement
        self._required_scale = 1.0 if requirement.unit else 100.0
        if knobs.required is None:
            return self._gui.add_slider(
                "Requirement",
                min=0,
                max=1,
                step=1,
                initial_value=0,
                disabled=True,
                hint="This kind of requirement has no single number to turn.",
            )
        shown = _shown(self._required_scale * knobs.required)
        if requirement.kind == "accuracy":
            left = 100 - shown
            step = _nice(left / 20)
            low = max(100 - 20 * left, 0.0)
            return self._gui.add_slider(
                "Accuracy 1 − T / %",
                min=low,
                max=100 - step,
                step=step,
                initial_value=min(shown, 100 - step),
                hint="The accuracy, relative to the length, that every characteristic must reach.",
            )
        label = "Allowed error / mm" if requirement.unit else "Allowed share of the tolerance / %"
        step = _nice(shown / _STEPS)
        return self._gui.add_slider(label, min=step, max=4 * shown, step=step, initial_value=shown)


def _shown(value: float) -> float:
    """Without the digits that a change of units has made."""
    return float(f"{value:.10g}")


def _nice(value: float) -> float:
    """The next 1, 2 or 5 times a power of ten below."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(k for k in (1, 2, 5) if k * power <= value * (1 + 1e-9)) * power
