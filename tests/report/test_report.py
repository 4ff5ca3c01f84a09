"""The report shows what the plan says, whatever the ids hold, and needs nothing from outside."""

from __future__ import annotations

import base64
import dataclasses
import json
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest
import trimesh

from viewgauge.evaluation.requirement.allowed_error import Requirement
from viewgauge.part import Mesh, Part
from viewgauge.planning.compose import Plan, PlannedCharacteristic, PlannedViewpoint
from viewgauge.report import render_report
from viewgauge.report.pictures.part_scene import TRIANGLE_LIMIT
from viewgauge.sensors.camera import Camera

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), 0.1)
REQUIREMENT = Requirement("accuracy", 0.998, 0.95)
HOSTILE = "</script><img src=x onerror=alert(1)>&amp;\u2028"
VOID = {"meta", "br", "link", "img", "input"}


class Page(HTMLParser):
    """The page as a browser would take it apart: elements, table rows, scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.titles: list[list[str]] = []
        self.scripts: list[str] = []
        self.text = ""
        self._open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        self.elements.append((tag, attributes))
        if tag not in VOID:
            self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
            self.titles.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
            if attributes.get("title"):
                self.titles[-1].append(attributes["title"])
        elif tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag, "elements are nested properly"

    def handle_data(self, data: str) -> None:
        if "script" in self._open:
            self.scripts[-1] += data
            return
        self.text += data
        if {"td", "th"} & set(self._open):
            self.rows[-1][-1] += data

    def row(self, name: str) -> list[str]:
        (found,) = [row for row in self.rows if row and row[0] == name]
        return found

    @property
    def scene(self) -> dict[str, Any]:
        return json.loads(self.scripts[0])


def pose(centre: tuple[float, float, float]) -> np.ndarray:
    """A camera at a point that looks at the origin, rolled arbitrarily."""
    forward = -np.array(centre) / np.linalg.norm(centre)
    right = np.cross(forward, [0.3, 0.2, 0.9])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    T[:3, 3] = centre
    return T


def characteristic(
    name: str, status: str, probability: float, viewpoint: str | None, **changes: Any
) -> PlannedCharacteristic:
    measurand = None if status == "not_measurable" else np.array([[-20.0, 0, 10], [20, 0, 10]])
    planned = PlannedCharacteristic(
        id=name, kind="distance", nominal_mm=40.0, tolerance_mm=(-0.05, 0.1), allowed_error_mm=0.08, status=status,
        probability=probability, expected_accuracy=0.99912, viewpoint=viewpoint, measurand=measurand,
        limit="" if status == "met" else f"limit of {name}",
    )  # fmt: skip
    return dataclasses.replace(planned, **changes)


def make_plan(first_id: str = "E1", viewpoint_id: str = "S1") -> Plan:
    characteristics = (
        characteristic(first_id, "met", 0.987654321, viewpoint_id),
        characteristic("E2", "met", 0.99996, "S2", tolerance_mm=None),
        characteristic("E3", "met", 0.9512, "S2"),
        characteristic("E4", "not_measurable", 0.0, None, expected_accuracy=0.0),
        characteristic("E5", "not_met", 0.94999, None),
        characteristic("E6", "not_met", 0.0, None, measurand=None, expected_accuracy=0.0),
    )
    viewpoints = (
        PlannedViewpoint(viewpoint_id, pose((0, -300, 120)), (first_id,)),
        PlannedViewpoint("S2", pose((250, 30, 200)), ("E2", "E3")),
    )
    return Plan(seed=7, viewpoints=viewpoints, characteristics=characteristics, lower_bound=1, candidate_count=1600)


def make_part(mesh: trimesh.Trimesh | None = None, notes: tuple[str, ...] = ()) -> Part:
    solid = mesh or trimesh.creation.box((40, 30, 20))
    line = np.array([[-20.0, -15, 10], [20, -15, 10]])
    return Part("block", Mesh(solid.vertices, solid.faces), (), notes=notes, feature_lines=(line,))


def report(plan: Plan, part: Part | None = None, title: str = "block", **inputs: str) -> str:
    return render_report(plan, part or make_part(), CAMERA, REQUIREMENT, title=title, inputs=inputs)


@pytest.fixture(scope="module")
def page() -> Page:
    return Page(report(make_plan(), block="sha256 0123abcd"))


def unpacked(values: dict[str, str]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(values["bdata"]), f"<{values['dtype']}")


def points(trace: dict[str, Any]) -> np.ndarray:
    return np.column_stack([unpacked(trace[axis]) for axis in "xyz"])


def test_numbers_are_the_plans(page: Page) -> None:
    assert page.row("E1") == [
        "E1", "distance", "40", "+0.1 / −0.05", "0.08", "met", "0.9876", "0.9991", "S1", "",
    ]  # fmt: skip
    for planned in make_plan().characteristics:
        row, titles = page.row(planned.id), page.titles[page.rows.index(page.row(planned.id))]
        assert planned.limit == row[-1]
        assert (planned.viewpoint or "–") == row[-2]
        if planned.status != "not_measurable":
            assert float(titles[0]) == planned.probability


def test_close_calls_do_not_read_as_met_or_certain(page: Page) -> None:
    assert page.row("E2")[6] == "> 0.9999"
    assert page.row("E5")[6] == "0.9499"  # 0.94999, where 0.95 is required


def test_missing_characteristics_come_first_and_then_the_least_sure(page: Page) -> None:
    names = [row[0] for row in page.rows if row and row[0] in {f"E{k}" for k in range(1, 7)}]
    assert names == ["E6", "E5", "E4", "E3", "E1", "E2"]


def test_summary_reports_outcome_viewpoints_bound_and_weakest(page: Page) -> None:
    for words in (
        "✗ Not met: 2 of 6 characteristics, not measurable: 1",
        "missing: E4, E5, E6",
        "3 of 6",
        "at least 1 needed; gap 50%",
        "probability 0.9512",
        "1,600",
        "accuracy of at least 0.998, with a probability of at least 0.95",
    ):
        assert words in page.text


def test_all_met_and_proven_is_said() -> None:
    plan = make_plan()
    met = dataclasses.replace(plan, characteristics=plan.characteristics[:3], lower_bound=2)
    text = Page(report(met)).text
    assert "✓ All 3 characteristics are met" in text
    assert "proven the fewest among the candidates" in text


def test_nothing_met_needs_no_viewpoint() -> None:
    plan = make_plan()
    text = Page(
        report(dataclasses.replace(plan, characteristics=plan.characteristics[3:], viewpoints=(), lower_bound=0))
    ).text
    assert "0 of 3" in text
    assert "proven" not in text
    assert "none met" in text
    assert "no candidate meets any characteristic" in text


def test_every_viewpoint_is_in_the_table_and_in_the_picture(page: Page) -> None:
    plan = make_plan()
    for viewpoint in plan.viewpoints:
        (row,) = [row for row in page.rows if row and row[0] == viewpoint.id]
        assert row[1] == ", ".join(f"{value:.1f}" for value in viewpoint.T_part_camera[:3, 3]).replace("-", "−")
        assert row[-1] == ", ".join(viewpoint.observes)
        assert [trace["mode"] for trace in page.scene["cameras"] if trace["name"] == viewpoint.id] == [
            "lines",
            "markers+text",
        ]


def test_working_distance_is_the_depth_of_what_is_measured(page: Page) -> None:
    (row,) = [row for row in page.rows if row and row[0] == "S1"]
    T = make_plan().viewpoints[0].T_part_camera
    depth = (np.linalg.inv(T) @ [0, 0, 10, 1])[2]  # the middle of the measurand
    assert float(row[3]) == pytest.approx(depth, abs=0.5)  # printed in whole mm


def test_frustum_is_the_field_of_view(page: Page) -> None:
    frustum = next(trace for trace in page.scene["cameras"] if trace["mode"] == "lines")
    T = make_plan().viewpoints[0].T_part_camera
    corners = points(frustum)
    in_camera = (corners - T[:3, 3]) @ T[:3, :3]
    base = in_camera[in_camera[:, 2] > 1]
    pixels = np.unique(np.round(CAMERA.to_pixels(CAMERA.project(base)), 1), axis=0)
    # single precision over 300 mm: 3e-5 mm at 20 mm depth is 0.01 px
    assert pixels == pytest.approx(np.array([[-0.5, -0.5], [-0.5, 2047.5], [2447.5, -0.5], [2447.5, 2047.5]]), abs=0.11)


def test_measurands_are_drawn_with_their_viewpoint_and_the_not_met_apart(page: Page) -> None:
    drawn = {trace["name"]: trace for trace in page.scene["part"] if "hovertext" in trace}
    assert set(drawn) == {"S1", "S2", "✗ not met"}
    assert drawn["✗ not met"]["line"] == {"color": "#D00000", "width": 14}
    assert points(drawn["S1"])[[0, 2]] == pytest.approx(make_plan().characteristics[0].measurand)
    assert drawn["S1"]["hovertext"][0] == "<b>E1</b><br>nominal 40 mm<br>probability 0.9876<br>S1"
    assert page.scene["layout"]["scene"]["aspectmode"] == "data"


def test_hostile_text_stays_text() -> None:
    part = make_part(notes=(HOSTILE,))
    text = report(make_plan(HOSTILE, HOSTILE), part, title=HOSTILE, **{HOSTILE: HOSTILE})
    page = Page(text)
    assert not [tag for tag, _ in page.elements if tag == "img"]
    assert not [name for _, attributes in page.elements for name in attributes if name.startswith("on")]
    assert "<img src=x" not in text
    assert len(page.scripts) == 3
    assert [row[-2:] for row in page.rows if row and row[0] == HOSTILE] == [
        [HOSTILE, ""],
        ["1", HOSTILE],
        [HOSTILE] * 2,
    ]
    pictured = json.dumps(page.scene, ensure_ascii=False)
    assert "<img" not in pictured
    assert "‹img" in pictured


def test_nothing_is_fetched(page: Page) -> None:
    fetching = {"src", "href", "srcset", "action", "data", "poster", "background"}
    named = [value for _, attributes in page.elements for name, value in attributes.items() if name in fetching]
    assert not [value for value in named if not value.startswith(("#", "data:"))]
    assert not {"link", "iframe", "object", "embed", "base"} & {tag for tag, _ in page.elements}
    policy = next(a["content"] for _, a in page.elements if a.get("http-equiv") == "Content-Security-Policy")
    assert "default-src 'none'" in policy
    assert "http" not in policy
    assert "http" not in page.text + page.scripts[0] + page.scripts[2]  # all but plotly.js
    assert "url(" not in page.text
    assert "@import" not in page.text


def test_inputs_and_seed_are_listed(page: Page) -> None:
    assert page.row("block") == ["block", "sha256 0123abcd"]
    assert page.row("Seed") == ["Seed", "7"]
    assert page.row("Edge resolution") == ["Edge resolution", "0.1 px"]


def test_same_plan_same_report() -> None:
    assert report(make_plan()) == report(make_plan())


def test_large_part_is_simplified_and_it_is_said() -> None:
    ball = trimesh.creation.icosphere(subdivisions=7, radius=50)
    text = report(make_plan(), make_part(ball))
    page = Page(text)
    mesh = page.scene["part"][0]
    assert len(ball.faces) > TRIANGLE_LIMIT >= len(unpacked(mesh["i"]))
    assert f"of {len(ball.faces):,} triangles" in page.text
    assert len(text.encode()) < 10_000_000
    # a cell of the final grid is below 2 % of the diagonal, and so is what a vertex moves
    assert np.abs(np.linalg.norm(points(mesh), axis=1) - 50).max() < 0.02 * 100 * np.sqrt(3)
