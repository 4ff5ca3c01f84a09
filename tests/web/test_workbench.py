"""The workbench as a visitor meets it, in a browser: what it shows is what the API computes."""

from __future__ import annotations

import io
import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import viewgauge as vg
from inspections import POSE_UNCERTAINTY, WHOLE_PIXELS, sections, write_box
from viewgauge.geometry import quaternion_from_pose
from viewgauge.jobs.workbench.what_if import WhatIf

pytest.importorskip("viser")

from viewgauge.web import open_workbench

playwright = pytest.importorskip("playwright.sync_api")
expect = playwright.expect
MOST_BYTES = 64 * 2**20

WAIT_MS = 60_000  # beside a busy machine


class Visit:
    """A page, and what it said and asked for."""

    def __init__(self, browser, workbench, **context):
        # the picture between the panels is narrow: it is drawn without a GPU
        self.context = browser.new_context(viewport={"width": 1180, "height": 800}, accept_downloads=True, **context)
        self.page = self.context.new_page()
        self.page.set_default_timeout(WAIT_MS)
        self.errors, self.requests, self.sockets = [], [], []
        self.page.on("console", lambda m: self.errors.append(m.text) if m.type == "error" else None)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.sockets.append(socket.url))
        self.page.goto(workbench.address)
        expect(self.verdict).to_be_visible(timeout=WAIT_MS)
        self.close_notifications()  # such as that the browser has no GPU

    def close_notifications(self):
        """They lie over the page."""
        close = "for (const b of document.querySelectorAll('.mantine-Notification-closeButton')) b.click()"
        self.page.evaluate(close)

    def assert_clean(self):
        """Whatever was done: nothing went to another machine, and the page did not complain."""
        hosts = {re.match(r"(?:blob:|data:)?(?:\w+://([^/:]+))?", url)[1] for url in self.requests + self.sockets}
        assert hosts <= {"127.0.0.1", None}
        assert self.errors == []

    @property
    def verdict(self):
        return self.page.locator(".verdict")

    def tab(self, name):
        self.page.get_by_role("tab", name=name, exact=True).click()

    def rows(self):
        """Of the table of characteristics: id, probability, from."""
        found = self.page.locator("table tbody tr").all()
        cells = [[cell.inner_text() for cell in row.locator("th,td").all()] for row in found]
        return {row[0].removeprefix("✗ ").strip(): (row[2], row[3]) for row in cells if len(row) == 4}

    def expect_rows(self, answers):
        """The table comes to show these answers."""
        for answer in answers.characteristics:
            cells = self.page.locator("tr", has=self.page.get_by_role("rowheader", name=row_name(answer), exact=True))
            expect(cells.first).to_contain_text(floor4(answer.probability) if answer.viewpoint else "–")
        assert_rows(self.rows(), answers)

    def turn(self, label, value):
        """Type a knob's number, as with the keyboard."""
        box = self.page.get_by_role("textbox", name=re.compile(label))
        box.fill(str(value))
        box.press("Enter")

    def choose(self, dropdown, name):
        self.page.get_by_role("combobox", name=dropdown).or_(self.page.get_by_label(dropdown, exact=True)).first.click()
        self.page.get_by_role("option", name=name, exact=True).click()

    def open(self, folder):
        title = self.page.get_by_role("button", name=folder, exact=True)
        if title.get_attribute("aria-expanded") != "true":
            title.press("Enter")
            self.page.wait_for_timeout(1000)  # it unfolds: a click meanwhile would miss

    def download(self, button):
        """What a button saves; clicked again if nothing comes, as what is above it may just have moved it."""
        for attempt in range(3):
            try:
                with self.page.expect_download(timeout=WAIT_MS / 2) as coming:
                    self.page.get_by_role("button", name=button).click()
                return coming.value.suggested_filename, Path(coming.value.path()).read_bytes()
            except playwright.TimeoutError:
                if attempt == 2:
                    raise
        raise AssertionError("not reached")

    def close(self):
        self.context.close()


@pytest.fixture(scope="module")
def regular(browser, workbench):
    """One visit for all tests that leave the page as they found it: loading it takes seconds."""
    visit = Visit(browser, workbench)
    yield visit
    visit.close()


@pytest.fixture
def visit(regular):
    """The regular visit with all knobs as the inspection has them."""
    regular.close_notifications()
    regular.page.get_by_role("button", name="Reset").click()
    regular.tab("Characteristics")
    yield regular
    regular.assert_clean()


@pytest.fixture
def first_visit(browser, workbench):
    """For tests that plan, or load another inspection."""
    visit = Visit(browser, workbench)
    yield visit
    visit.assert_clean()
    visit.close()


def row_name(answer):
    return ("" if answer.met else "✗ ") + answer.characteristic.id


def floor4(probability):
    return "> 0.9999" if probability > 0.9999 else f"{int(probability * 1e4 + 1e-6) / 1e4:.4f}"


def assert_rows(rows, answers):
    assert set(rows) == {answer.characteristic.id for answer in answers.characteristics}
    for answer in answers.characteristics:
        shown, origin = rows[answer.characteristic.id]
        if answer.viewpoint is None:
            assert shown == "–"
        else:
            assert (shown, origin) == (floor4(answer.probability), answer.viewpoint)


def answers_of(inspection, plan, **knobs):
    what_if = WhatIf(inspection, plan)
    return what_if.answers(replace(what_if.today, **knobs))


def test_the_page_shows_the_plan(visit, inspection, plan):
    answers = answers_of(inspection, plan)
    total = len(answers.characteristics)
    said = (
        f"All {total} characteristics are met"
        if answers.met == total
        else f"{total - answers.met} of {total} characteristics"
    )
    expect(visit.verdict).to_contain_text(said)
    visit.expect_rows(answers)
    expect(visit.page.get_by_role("img", name=re.compile("Colours from 0"))).to_be_visible()
    assert visit.page.locator("canvas").count() >= 1


def test_a_chosen_characteristic_shows_its_laws_by_both_models(visit, inspection, plan):
    visit.tab("Characteristic")
    name = inspection.part.characteristics[4].id
    visit.choose("Characteristic", name)
    facts = visit.page.locator(".vg table", has_text="joint model")
    (answer,) = [a for a in answers_of(inspection, plan).characteristics if a.characteristic.id == name]
    expect(facts).to_contain_text(answer.viewpoint)
    row = visit.page.locator("tr", has_text="Probability, joint model")
    expect(row).to_contain_text(floor4(answer.probability))
    laws = vg.measurand_laws(inspection, plan)[name]
    independent = float(laws.independent_probability(answer.allowed_error_mm))
    expect(visit.page.locator("tr", has_text="model of 1998")).to_contain_text(floor4(independent))
    for heading in (
        f"Error of {name}",
        f"Probability of each accuracy of {name}",
        f"uncertainty of {name}",
        f"{name} from all directions",
    ):
        expect(visit.page.locator(".gtitle", has_text=heading)).to_be_attached()


def test_a_chosen_viewpoint_shows_its_view_and_what_it_does_not_see(visit, inspection, plan):
    visit.tab("Viewpoint")
    name = plan.viewpoints[-1].id
    if plan.count > 1:
        visit.choose("Viewpoint", name)
    table = vg.evaluate(inspection, np.array([s.T_part_camera for s in plan.viewpoints]))
    visible = table.visible.values[-1]
    view = visit.page.get_by_role("img", name=re.compile(f"Simulated view of {name}"))
    expect(view).to_have_attribute("aria-label", re.compile(f"{visible.sum()} characteristics visible"))
    assert view.locator("line").count() == 2 * visible.sum()
    reported = visit.page.locator("table", has_text="Not visible from here")
    for characteristic in table.characteristic.values[~visible]:
        expect(reported).to_contain_text(str(characteristic))


def test_a_turned_knob_changes_the_numbers_and_back(visit, inspection, plan):
    before = answers_of(inspection, plan)
    after = answers_of(inspection, plan, translation_mm=0.3)
    assert after.met < before.met
    visit.turn("translation", 0.3)
    expect(visit.verdict).to_contain_text(
        f"{len(after.characteristics) - after.met} of {len(after.characteristics)} characteristics"
    )
    visit.expect_rows(after)
    visit.page.get_by_role("button", name="Reset").click()
    visit.expect_rows(before)


def test_a_slider_is_turned_by_the_keyboard(visit, inspection, plan):
    """Tab reaches it, arrow keys turn it."""
    weakest = floor4(answers_of(inspection, plan).weakest.probability)
    slider = visit.page.get_by_role("slider", name="Edge location / px")
    slider.focus()
    for _ in range(12):
        visit.page.keyboard.press("ArrowRight")
    expect(visit.page.locator(".card", has_text="Weakest")).not_to_contain_text(weakest)


def test_planning_again_can_be_ended_and_then_done(first_visit, inspection):
    visit = first_visit
    knobs = {"translation_mm": 0.12, "required": 0.997}  # an easy one, which is planned in a moment
    replan, cancel = (visit.page.get_by_role("button", name=name) for name in ("Plan again", "Cancel planning"))
    visit.turn("translation", 0.12)
    visit.turn("Accuracy", 99.7)
    replan.click()
    cancel.click()
    expect(visit.page.get_by_text("All is as it was.")).to_be_visible()
    expect(replan).to_be_enabled()
    replan.click()
    expect(cancel).to_be_visible()
    expect(cancel).to_be_hidden(timeout=4 * WAIT_MS)
    what_if = WhatIf(inspection, None)
    again = vg.plan(what_if.turned(replace(what_if.today, **knobs)))
    expect(visit.page.locator(".card", has_text="Viewpoints")).to_contain_text(str(again.count))
    visit.expect_rows(answers_of(inspection, again, **knobs))


def test_files_that_are_saved_are_the_apis(visit, inspection, plan, tmp_path):
    visit.open("Files")
    name, content = visit.download("Save the viewpoints (CSV)")
    assert name == "viewpoints.csv"
    (tmp_path / name).write_bytes(content)
    table = vg.evaluate(inspection, tmp_path / name)
    assert list(table.viewpoint.values) == [viewpoint.id for viewpoint in plan.viewpoints]

    name, content = visit.download("Save the plan (ZIP)")
    vg.write_plan(plan, inspection, tmp_path / "plan")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert archive.namelist() == ["assignments.csv", "plan.json", "report.html", "viewpoints.csv"]
        for file in archive.namelist():
            assert archive.read(file) == (tmp_path / "plan" / file).read_bytes()

    name, content = visit.download("Save the report (HTML)")
    assert content == (tmp_path / "plan" / "report.html").read_bytes()

    visit.turn("Focal", 20)
    name, content = visit.download("Save the inspection (YAML)")
    assert "focal_length: 20 mm" in content.decode()


def test_an_inspection_is_loaded_and_planned(first_visit, project, tmp_path):
    """Its part is the project's, which it names; its plan is for its own requirement."""
    visit = first_visit
    text = (project / "inspection.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(text.replace("accuracy: 0.999 ", "accuracy: 0.997 "), encoding="utf-8")
    visit.open("Files")
    with visit.page.expect_file_chooser() as chooser:
        visit.page.get_by_role("button", name="Load an inspection file").click()
    chooser.value.set_files(tmp_path / "mine.yaml")
    expect(visit.page.get_by_text("mine.yaml is loaded")).to_be_visible(timeout=2 * WAIT_MS)
    visit.page.get_by_role("button", name="Plan again").click()
    expect(visit.verdict).to_contain_text("All 15 characteristics are met", timeout=4 * WAIT_MS)
    expect(visit.page.get_by_text("accuracy of at least 0.997")).to_be_visible()


def test_files_that_cannot_be_used_are_refused_with_words(visit, tmp_path):
    secret = tmp_path / "secret.yaml"
    secret.write_text("covariance: hidden words\n")
    visit.open("Files")
    for name, content, reported in (
        ("evil.yaml", f"part:\n  file: {secret}\ncamera: {{}}\n", "outside the project's folder"),
        ("broken.yaml", "camera: [", "not valid YAML"),
        ("page.html", "<script>alert(1)</script>", "this kind of file is not taken"),
    ):
        (tmp_path / name).write_text(content)
        with visit.page.expect_file_chooser() as chooser:
            visit.page.get_by_role("button", name="Load an inspection file").click()
        chooser.value.set_files(tmp_path / name)
        expect(visit.page.get_by_role("alert").filter(has_text=reported).first).to_be_visible(timeout=2 * WAIT_MS)
    shown = visit.page.content()
    assert "hidden words" not in shown
    assert "viewgauge-visitor" not in shown  # nor where the files of visitors lie


def test_visitors_do_not_see_each_other(browser, workbench, visit, inspection, plan):
    other = Visit(browser, workbench)
    try:
        visit.turn("translation", 0.35)
        mine = answers_of(inspection, plan, translation_mm=0.35)
        visit.expect_rows(mine)
        other.tab("Viewpoint")
        other.tab("Characteristics")
        other.expect_rows(answers_of(inspection, plan))
    finally:
        other.close()


def test_a_dragged_camera_takes_everything_with_it(visit, workbench, inspection, plan):
    """The handle in the picture is moved as viser moves it when it is dragged with the mouse."""
    visit.open("Show")
    visit.page.get_by_label("Drag the chosen viewpoint").check()
    (visitor,) = workbench._visitors.values()
    for _ in range(100):
        if visitor._held is not None:
            break
        visit.page.wait_for_timeout(50)
    name = visitor._held
    planned = {viewpoint.id: viewpoint.T_part_camera for viewpoint in plan.viewpoints}[name]
    pose = planned.copy()
    pose[:3, 3] += [14.0, 11.0, -16.0]
    what_if = WhatIf(inspection, plan)
    moved, still = what_if.answers(what_if.today, {name: pose}), what_if.answers(what_if.today)
    assert [a.probability for a in moved.characteristics] != [a.probability for a in still.characteristics]
    visitor._moved(name, SimpleNamespace(**pose_parts(pose)))
    visit.expect_rows(moved)
    visit.page.get_by_role("button", name="Reset").click()
    visit.expect_rows(still)
    visit.page.get_by_label("Drag the chosen viewpoint").uncheck()


def pose_parts(pose):
    return {"position": pose[:3, 3], "wxyz": quaternion_from_pose(pose)}


def test_a_file_that_is_too_large_is_not_taken(visit, tmp_path):
    large = tmp_path / "large.stl"
    with large.open("wb") as stream:
        stream.truncate(MOST_BYTES + 1)
    visit.open("Files")
    with visit.page.expect_file_chooser() as chooser:
        visit.page.get_by_role("button", name="Send a part or another named file").click()
    chooser.value.set_files(large)
    expect(visit.page.get_by_text("large.stl is larger than 64 MB")).to_be_visible()


def test_the_dark_page_is_dark(visit):
    visit.open("Show")
    visit.page.get_by_label("Dark page").check()
    visit.tab("Characteristic")
    chart = visit.page.locator(".js-plotly-plot .main-svg").first
    expect(chart).to_have_css("background-color", "rgb(18, 24, 31)")
    visit.page.get_by_label("Dark page").uncheck()
    expect(chart).to_have_css("background-color", "rgb(255, 255, 255)")


def test_every_control_has_a_name(visit):
    """For a screen reader: by the accessibility tree, not by how it looks."""
    visit.open("Show")
    visit.open("Files")
    for role in ("button", "checkbox", "tab", "slider", "textbox"):
        controls = visit.page.get_by_role(role).all()
        assert controls
        for control in controls:
            assert re.search(rf'{role} "[^"]+"', control.aria_snapshot()), control.aria_snapshot()


def test_a_page_that_lost_nothing_is_still_there_after_reloading(first_visit, inspection, plan):
    visit = first_visit
    visit.page.reload()
    expect(visit.verdict).to_be_visible(timeout=WAIT_MS)
    visit.expect_rows(answers_of(inspection, plan))


def test_the_first_visitor_sees_the_part_while_it_is_planned(browser, project, inspection):
    easy = replace(inspection, requirement=vg.Requirement("accuracy", 0.997, 0.95))
    served = open_workbench(project / "inspection.yaml", easy, None, port=0)
    try:
        context = browser.new_context()
        page = context.new_page()
        page.goto(served.address)
        expect(page.locator("tr", has_text="no viewpoint yet").first.or_(page.locator(".verdict"))).to_be_visible(
            timeout=WAIT_MS
        )
        expect(page.locator(".verdict")).to_be_visible(timeout=4 * WAIT_MS)
        context.close()
    finally:
        served.close()


def test_a_part_without_a_characteristic_to_measure_says_so(browser, tmp_path):
    write_box(tmp_path)
    text = sections(
        part="\n  file: box.stl\n  characteristics: [{id: width, points: [[0, 0, 40], [80, 0, 40]], unit: mm}]",
        camera=WHOLE_PIXELS,
        pose_uncertainty=POSE_UNCERTAINTY,
        requirement="{fraction_of_tolerance: 10 %, probability: 0.95}",
    )
    (tmp_path / "inspection.yaml").write_text(text)
    inspection = vg.load(tmp_path / "inspection.yaml")
    served = open_workbench(tmp_path / "inspection.yaml", inspection, port=0)
    context = browser.new_context()
    try:
        page = context.new_page()
        page.goto(served.address)
        expect(page.get_by_role("alert").filter(has_text="No characteristic").first).to_be_visible(timeout=WAIT_MS)
        expect(page.get_by_text("it has no tolerance")).to_be_visible()
    finally:
        context.close()
        served.close()


def test_data_of_the_page_is_json_without_nan(inspection, plan):
    """What viser sends as charts must be readable by any browser."""
    chart = vg.plan_chart(inspection, plan, "directions")
    assert json.loads(json.dumps(chart, allow_nan=False))
