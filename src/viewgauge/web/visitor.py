"""One visitor of the workbench: what is loaded, turned, dragged and chosen, unseen by other visitors."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
import threading
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import viser
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation
from viser._messages import RunJavascriptMessage

from ..exceptions import InputError, JobCancelledError, ViewgaugeError
from ..execution.child_process import Job, Stage
from ..jobs.workbench.child_jobs import load_uploaded, plan_again
from ..jobs.workbench.downloads import plan_archive, viewpoints_text
from ..jobs.workbench.saved_inspection import changed_inspection_text
from ..jobs.workbench.what_if import WhatIf
from ..jobs.write_report import plan_report
from ..planning.improve.answers import Answers
from ..planning.inspection import Inspection
from ..report.palette import DARK, LIGHT
from ..report.workbench_markup import legend, message, verdict_markup, workbench_style
from .controls import LOOK_AT, Controls
from .findings import Findings, choose
from .refresher import Refresher
from .scene import Scene
from .uploads import INSPECTION_SUFFIXES, OTHER_SUFFIXES, limit_uploads, stored

if TYPE_CHECKING:
    from ..planning import Plan
    from .project import Project

__all__ = ["Visitor"]

_CANDIDATES = 1500
_LOAD_S, _LOAD_BYTES = 300.0, 8 * 2**30


def _name_controls(client: viser.ClientHandle) -> None:
    """What viser's page lacks for keyboards and screen readers; by the way on which viser itself sends plotly.js."""
    script = files(__package__).joinpath("page.js").read_text(encoding="utf-8")
    client._websock_connection.queue_message(RunJavascriptMessage(source=script))


class Visitor:
    """The state and the page of one visitor.

    Parameters
    ----------
    client
        The visitor's browser.
    project
        What all visitors begin with.
    """

    def __init__(self, client: viser.ClientHandle, project: Project) -> None:
        self._client, self._project = client, project
        self._lock = threading.RLock()
        self._folder = Path(tempfile.mkdtemp(prefix="viewgauge-visitor-"))
        self._job: Job[Any] | None = None
        self._working, self._ended = False, threading.Event()
        self._closed = False
        self._dragged: dict[str, NDArray[np.float64]] = {}
        self._held: str | None = None
        self._answers: Answers | None = None
        limit_uploads(client)
        _name_controls(client)
        self._scene, self._findings = Scene(client), Findings(client)
        self._controls = Controls(client, self._turned, self._reset)
        client.gui.main_panel.dock_left()
        client.gui.main_panel.set_width(370)
        self._refresher = Refresher(
            {
                "answers": self._answer,
                "scene": self._show_scene,
                "viewpoint": self._show_viewpoint,
                "characteristic": self._show_characteristic,
                "candidates": self._show_candidates,
            },
            frozenset({"viewpoint", "characteristic", "candidates"}),
            self._failed,
        )
        self._theme()
        self._listen()
        self._take(project.inspection, project.text, project.plan, project.inspection)
        project.follow_plan(self._first_plan)

    def close(self) -> None:
        """The visitor has gone."""
        self._closed = True
        self._project.leave_plan(self._first_plan)
        self._refresher.close()
        self._cancel()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _listen(self) -> None:
        controls, findings, ask = self._controls, self._findings, self._refresher.ask
        controls.names.on_update(lambda _: ask("answers"))
        controls.see_through.on_update(lambda _: self._scene.see_through(controls.see_through.value))
        controls.candidates.on_update(lambda _: ask("candidates"))
        controls.directions.on_update(lambda _: ask("characteristic"))
        controls.drag.on_update(lambda _: self._hold())
        controls.dark.on_update(lambda _: self._theme())
        controls.look.on_click(lambda event: self._look(event.target.value))
        findings.characteristic.on_update(lambda _: ask("answers", "viewpoint", "characteristic"))
        findings.viewpoint.on_update(lambda _: self._chose_viewpoint())
        controls.replan.on_click(lambda _: self._plan())
        controls.cancel.on_click(lambda _: self._cancel())
        controls.upload.on_upload(lambda event: self._load(event.target.value))
        controls.upload_other.on_upload(lambda event: self._receive_other(event.target.value))
        controls.save_inspection.on_click(lambda _: self._give(self._inspection_file))
        controls.save_report.on_click(lambda _: self._give(self._report_file))
        controls.save_plan.on_click(lambda _: self._give(self._plan_file))
        controls.save_viewpoints.on_click(lambda _: self._give(self._viewpoints_file))
        self._client.scene.on_click()(self._clicked)

    # what is loaded

    def _take(self, inspection: Inspection, text: str, plan: Plan | None, planned_for: Inspection) -> None:
        """Begin with an inspection and, if there is one, a plan that was made for it or for a turned one."""
        with self._lock:
            self._inspection, self._text, self._plan_made, self._planned_for = inspection, text, plan, planned_for
            self._what_if, self._answers = WhatIf(inspection, plan), None
            self._dragged.clear()
            self._today = self._what_if.today
            self._controls.show_knobs(inspection, self._today)
            self._scene.show_part(inspection)
            self._scene.see_through(self._controls.see_through.value)
            self._scene.look_at_all(self._what_if.viewpoints(self._today))
            self._offer()
            self._hold()
        self._refresher.ask("answers", "viewpoint", "characteristic", "candidates")

    def _offer(self) -> None:
        viewpoints = [] if self._plan_made is None else [viewpoint.id for viewpoint in self._plan_made.viewpoints]
        self._findings.offer([characteristic.id for characteristic in self._what_if.characteristics], viewpoints)

    def _planned(self, plan: Plan, planned_for: Inspection) -> None:
        """Go on with another plan of the same inspection; the knobs stay as they are."""
        with self._lock:
            self._plan_made, self._planned_for = plan, planned_for
            self._what_if = WhatIf(self._inspection, plan)
            self._dragged.clear()
            self._controls.set_distance(1.0)
            self._scene.look_at_all(self._what_if.viewpoints(self._today))
            self._offer()
            self._hold()
        self._refresher.ask("answers", "viewpoint", "characteristic")

    def _first_plan(self, outcome: Plan | Stage | ViewgaugeError) -> None:
        """Show how far the plan is that all visitors begin with, or what became of it."""
        if self._closed or self._plan_made is not None or self._inspection is not self._project.inspection:
            return
        if isinstance(outcome, Stage):
            self._show_stage(outcome)
        else:
            self._end_of_work()
            if isinstance(outcome, ViewgaugeError):
                self._controls.verdict.content = message(str(outcome), bad=True)
            else:
                self._planned(outcome, self._project.inspection)

    # what is shown

    def _answer(self) -> None:
        with self._lock:
            if not self._what_if.characteristics:
                self._findings.show_not_measurable(self._what_if, dark=self._controls.dark.value)
                self._controls.verdict.content = message("No characteristic can be measured.", bad=True)
                return
            try:
                answers = self._answers = self._what_if.answers(self._knobs(), self._dragged)
            except InputError as error:
                self._controls.verdict.content = message(str(error), bad=True)
                return
            if answers.viewpoints or not self._working:
                self._controls.verdict.content = verdict_markup(answers, self._inspection.requirement)
            self._controls.legend.content = legend(answers.setup.requirement.probability)
            self._findings.show_table(self._what_if, answers, dark=self._controls.dark.value)
            self._client.flush()  # the numbers before the picture, which takes a browser longer
        self._refresher.ask("scene")

    def _show_scene(self) -> None:
        answers = self._now()
        if answers is not None:
            chosen, viewpoint = self._findings.chosen_characteristic, self._findings.chosen_viewpoint
            self._scene.show_answers(answers, chosen, names=self._controls.names.value)
            self._scene.show_viewpoints(answers, viewpoint)

    def _show_characteristic(self) -> None:
        answers, chosen = self._now(), self._findings.chosen_characteristic
        if answers is None or chosen is None:
            return
        self._findings.show_characteristic(self._what_if, answers, dark=self._controls.dark.value)
        found = None
        if self._controls.directions.value:
            distance = self._what_if.working_distance_mm(answers, chosen)
            found = self._what_if.directions(answers, chosen, distance)
        self._scene.show_directions(found, answers.setup.requirement.probability)

    def _show_viewpoint(self) -> None:
        answers = self._now()
        if answers is not None:
            self._findings.show_viewpoint(self._what_if, answers, dark=self._controls.dark.value)

    def _show_candidates(self) -> None:
        answers = self._now()
        if answers is None:
            return
        if self._controls.candidates.value:
            self._scene.show_candidates(*self._what_if.candidates(answers, _CANDIDATES))
        else:
            self._scene.show_candidates(None, np.zeros(0))

    def _now(self) -> Answers | None:
        """The answers of the part that is loaded; None where nothing can be measured."""
        with self._lock:
            return self._answers

    def _theme(self) -> None:
        dark = self._controls.dark.value
        self._client.gui.configure_theme(
            dark_mode=dark,
            show_logo=False,
            show_share_button=False,
            brand_color=(80, 165, 235) if dark else (0, 82, 145),
        )
        self._controls.style.content = workbench_style(DARK if dark else LIGHT)
        if hasattr(self, "_inspection"):
            self._refresher.ask("answers", "viewpoint", "characteristic")

    def _failed(self, error: Exception) -> None:
        if not self._closed:
            self._client.add_notification("Something went wrong", str(error) or type(error).__name__, color="red")

    # what the visitor does

    def _turned(self) -> None:
        if self._held is not None:
            self._hold()  # the handle goes with its camera
        self._refresher.ask("answers", "viewpoint", "characteristic", "candidates")

    def _reset(self) -> None:
        """All cameras stand where they were planned."""
        with self._lock:
            self._dragged.clear()
        self._turned()

    def _knobs(self) -> Any:
        return self._controls.values(self._today)

    def _clicked(self, event: viser.SceneClickEvent) -> None:
        answers = self._now()
        if answers is None:
            return
        found = self._scene.picked(answers, np.array(event.ray_origin), np.array(event.ray_direction))
        if found is not None:
            kind, name = found
            choose(self._findings.characteristic if kind == "characteristic" else self._findings.viewpoint, name)

    def _look(self, where: str) -> None:
        with self._lock:
            viewpoints = self._what_if.viewpoints(self._knobs(), self._dragged)
        chosen = self._findings.chosen_viewpoint
        if where == LOOK_AT[2] and chosen in viewpoints:
            self._scene.look_through(viewpoints[chosen])
        elif where == LOOK_AT[1]:
            self._scene.look_at_all(viewpoints)
        else:
            self._scene.look_at_part()

    def _chose_viewpoint(self) -> None:
        self._hold()
        self._refresher.ask("answers", "viewpoint")

    def _hold(self) -> None:
        """A handle at the chosen viewpoint where dragging is on."""
        with self._lock:
            name = self._findings.chosen_viewpoint
            viewpoints = self._what_if.viewpoints(self._knobs(), self._dragged)
            wanted = name if self._controls.drag.value and name in viewpoints else None
            self._held = wanted
            handle = self._scene.drag_handle(None if wanted is None else viewpoints[wanted])
        if handle is not None:
            handle.on_update(lambda event: self._moved(wanted, event.target))

    def _moved(self, name: str | None, handle: Any) -> None:
        with self._lock:
            if name is None or name != self._held:
                return
            rotation = Rotation.from_quat(handle.wxyz, scalar_first=True)
            pose = np.asarray(RigidTransform.from_components(handle.position, rotation).as_matrix())
            self._dragged[name] = self._what_if.placed(self._knobs(), name, pose)
        self._refresher.ask("answers", "viewpoint", "characteristic")

    # planning

    def _plan(self) -> None:
        try:
            inspection = self._what_if.turned(self._knobs())
        except InputError as error:
            self._controls.verdict.content = message(str(error), bad=True)
            return
        plan = self._result(plan_again, inspection)
        if plan is not None:
            self._planned(plan, inspection)

    def _result(self, work: Callable[..., Any], *arguments: Any, **limits: Any) -> Any:
        """What comes of work in a child process; None, and a message, where nothing does, or other work goes on."""
        with self._lock:
            if self._working:
                return None
            self._working = True
            self._ended.clear()
        try:
            self._show_stage(Stage("Waiting until other visitors' plans are made"))
            with self._project.turn(self._ended):
                self._job = Job(work, *arguments, watcher=self._show_stage, **limits)
                if self._ended.is_set():  # meanwhile
                    self._job.cancel()
                self._show_stage(Stage("Starting"))
                return self._job.result()
        except JobCancelledError:
            if not self._closed:
                self._client.add_notification("Cancelled", "All is as it was.", auto_close_seconds=4)
        except ViewgaugeError as error:
            if not self._closed:
                self._controls.file_message.content = message(self._reported(error), bad=True)
                self._client.add_notification("It did not work", self._reported(error), color="red")
        finally:
            self._job, self._working = None, False
            if not self._closed:
                self._end_of_work()
        return None

    def _cancel(self) -> None:
        self._ended.set()
        job = self._job
        if job is not None:
            job.cancel()

    def _show_stage(self, stage: Stage) -> None:
        if self._closed:
            return
        controls: Any = self._controls  # viser's types take values for fixed
        controls.replan.disabled, controls.cancel.visible = True, self._working
        controls.bar.visible, controls.stage.visible = True, True
        controls.bar.value = 100.0 * (stage.share if stage.share is not None else 1.0)
        controls.stage.content = message(f"{stage.name} …")

    def _end_of_work(self) -> None:
        controls = self._controls
        controls.replan.disabled = False
        controls.cancel.visible = controls.bar.visible = controls.stage.visible = False

    # files

    def _receive(self, file: viser.UploadedFile, suffixes: tuple[str, ...]) -> Path | None:
        try:
            path = stored(self._folder, file.name, file.content, suffixes)
        except InputError as error:
            self._controls.file_message.content = message(self._reported(error), bad=True)
            return None
        self._controls.file_message.content = message(f"{path.name} was received.")
        return path

    def _receive_other(self, file: viser.UploadedFile) -> None:
        self._receive(file, OTHER_SUFFIXES)

    def _load(self, file: viser.UploadedFile) -> None:
        """Read an inspection file that was sent, in a child process, and begin with it."""
        path = self._receive(file, INSPECTION_SUFFIXES)
        if path is None:
            return
        if self._working:
            self._controls.file_message.content = message("Wait until the plan is made, or cancel it first.", bad=True)
            return
        self._project.lend_files(self._folder)
        inspection = self._result(load_uploaded, path, timeout_s=_LOAD_S, memory_bytes=_LOAD_BYTES)
        if inspection is not None:
            self._controls.file_message.content = message(f"{path.name} is loaded; plan it with “Plan again”.")
            self._take(inspection, path.read_text(encoding="utf-8"), None, inspection)

    def _give(self, make: Callable[[], tuple[str, bytes]]) -> None:
        """Send a file to the browser, or say why there is none."""
        try:
            name, content = make()
        except ViewgaugeError as error:
            self._controls.file_message.content = message(self._reported(error), bad=True)
            return
        self._client.send_file_download(name, content, save_immediately=True)

    def _inspection_file(self) -> tuple[str, bytes]:
        text, unsaved = changed_inspection_text(self._text, self._inspection, self._knobs())
        reported = f"Saved without {', '.join(unsaved)}: the file has no place for it." if unsaved else ""
        self._controls.file_message.content = message(reported) if reported else ""
        return f"{self._file_stem()}.yaml", text.encode()

    def _report_file(self) -> tuple[str, bytes]:
        return f"{self._file_stem()}_report.html", plan_report(self._made(), self._planned_for).encode()

    def _plan_file(self) -> tuple[str, bytes]:
        return f"{self._file_stem()}_plan.zip", plan_archive(self._made(), self._planned_for)

    def _viewpoints_file(self) -> tuple[str, bytes]:
        self._made()
        with self._lock:
            viewpoints = self._what_if.viewpoints(self._knobs(), self._dragged)
        return "viewpoints.csv", viewpoints_text(viewpoints).encode()

    def _reported(self, error: Exception) -> str:
        """An error's text without the folder in which visitors' files lie, which it does not tell."""
        return str(error).replace(f"{self._folder}{os.sep}", "")

    def _made(self) -> Plan:
        if self._plan_made is None:
            raise InputError("there is no plan yet", hint="plan first, with “Plan again”")
        return self._plan_made

    def _file_stem(self) -> str:
        return re.sub(r"[^\w.-]", "_", self._inspection.name) or "inspection"
