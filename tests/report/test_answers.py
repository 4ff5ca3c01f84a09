"""The pages on what to improve and on cameras: the answers' own numbers, on the safe side, and nothing from outside."""

from __future__ import annotations

import json
import re

import pytest
from test_report import HOSTILE, REQUIREMENT, Page

from viewgauge.planning.improve.catalogue import SensorFormat
from viewgauge.planning.improve.improvement import (
    CameraChoice,
    Change,
    CharacteristicChanges,
    Improvement,
    Specification,
    TradeOff,
)
from viewgauge.report import render_improvement, render_specification


def change(factor, today=1.0, **more):
    value = None if factor is None else factor * today
    interval = None if value is None else (0.0, value)
    best = 0.61239 if factor is None else None
    return Change(factor, value, more.pop("interval", interval), more.pop("unlimited", False), best, True, **more)


def improvement(name="E1"):
    met = {
        "pixel": change(1.48779, 0.1),
        "pose_error": change(1024.0, unlimited=True),
        "distance": change(1.5, 400.0, interval=(191.23456, 593.56789)),
        "focal_length": change(0.7, 16.0, interval=(10.71234, None)),
    }
    not_met = {
        "pixel": change(0.5, 0.1),
        "pose_error": change(None),
        "distance": Change(None, None, None, False, None, True),
        "focal_length": Change(2.0, 32.0, (None, 32.0), False, None, True),
    }
    part = {"pixel": change(0.5, 0.1, limited_by=("E2",)), "pose_error": change(None, limited_by=("E2",))}
    part |= {name: not_met[name] for name in ("distance", "focal_length")}
    trades = (TradeOff(0.05, 1.2, 0.12, 0.024, True), TradeOff(0.1, None, None, None, True))
    today = {"pixel": 0.1, "pose_error": 1.0, "distance": 400.0, "focal_length": 16.0}
    characteristics = (CharacteristicChanges(name, True, 0.97, met), CharacteristicChanges("E2", False, 0.51, not_met))
    return Improvement(today, characteristics, part, trades, ("E3",), (), 12000)


def specification():
    small, big = SensorFormat("small", (720, 540), 0.0069), SensorFormat("big", (4096, 3000), 0.00345)
    return Specification(
        (
            CameraChoice(small, 16.0, (200.0, 300.0), 1, change(0.45678), 0.045678, None, change(0.3, 0.1)),
            CameraChoice(small, 25.0, (200.0, 300.0), 0, change(None), None, None, None),
            CameraChoice(big, 16.0, (200.0, 300.0), 2, change(1.5), 0.15, 0.02, change(2.0, 0.1)),
        ),
        2,
        (),
    )


def rendered(kind, title="block"):
    if kind == "improve":
        return render_improvement(improvement(), REQUIREMENT, title=title, inputs={"file": "0123"})
    return render_specification(specification(), REQUIREMENT, title=title, inputs={"file": "0123"})


def test_limits_are_rounded_to_the_side_that_keeps_them():
    page = Page(rendered("improve"))
    assert page.row("E1") == ["E1", "0.9700", "≤ 0.1487", "any", "191.3 to 593.5", "≥ 10.72"]
    assert page.row("E2") == ["E2", "0.5100", "≤ 0.05", "(0.6123)", "–", "≤ 32"]
    assert page.row("The part")[2] == "≤ 0.05"
    assert "1 of 2 characteristics are met today" in page.text
    assert "No viewpoint that was tried sees E3:" in page.text


def test_the_picture_holds_the_trade_off_and_today():
    line, today = json.loads(Page(rendered("improve")).scripts[0])["data"]
    assert (line["x"], line["y"]) == ([0.05], [1.2]), "what no pose uncertainty does has no point"
    assert (today["x"], today["y"]) == ([0.1], [1.0])


def test_without_a_trade_off_there_is_no_picture():
    bare = Improvement({"pose_error": 1.0}, (), {}, (), (), (), 1)
    page = Page(render_improvement(bare, REQUIREMENT, title="block", inputs={}))
    assert json.loads(page.scripts[0]) is None
    assert "against pose uncertainty" not in page.text


def test_cameras_have_rows_and_points():
    page = Page(rendered("specify"))
    assert "Fewest pixels with today's pose uncertainty: big, 16 mm" in page.text
    rows = [row for row in page.rows if row and row[0] == "small"]
    assert rows[0] == ["small", "6.9", "16", "200 to 300", "1 of 2", "0.4567", "0.04567", "–", "0.03"]
    assert rows[1][5:] == ["–"] * 4
    data = json.loads(page.scripts[0])["data"]
    assert [trace["name"] for trace in data] == ["16 mm", "25 mm"]
    assert data[0]["y"] == [0.45678, 1.5]
    assert data[0]["x"] == pytest.approx([0.3888, 12.288])
    assert data[1]["y"] == []


@pytest.mark.parametrize("kind", ["improve", "specify"])
def test_hostile_text_stays_text_and_nothing_is_fetched(kind):
    page = Page(rendered(kind, HOSTILE))
    assert HOSTILE in page.text
    assert len(page.scripts) == 3
    for tag, attributes in page.elements:
        assert tag not in ("link", "img", "iframe")
        assert not re.match("https?:", attributes.get("src") or attributes.get("href") or "")
