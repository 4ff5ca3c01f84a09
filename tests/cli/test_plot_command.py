"""viewgauge plot, as a user calls it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from box_inspection import refused, write

from inspections import box_part, entry
from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("planned")


@pytest.fixture
def planned(folder, capsys):
    assert main(["plan", "inspection.yaml", "-o", "plan", "--no-refine", "--no-prove"]) == 0
    capsys.readouterr()
    return folder


@pytest.mark.parametrize(
    ("what", "reported"),
    [
        ("scene", "scatter3d"),
        ("table", "heatmap"),
        ("budget", "share of the variance"),
        ("laws", "what it is made of"),
        ("accuracy", "accuracy at least"),
        ("directions", "from all directions"),
    ],
)
def test_each_picture_is_a_page_that_needs_nothing(capsys, what, reported):
    assert main(["plot", "inspection.yaml", "plan", "-o", "out.html", "--what", what]) == 0
    assert capsys.readouterr().out == "written to out.html\n"
    page = Path("out.html").read_text(encoding="utf-8")
    assert "default-src 'none'" in page
    chart = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)[1])
    assert reported in json.dumps(chart, ensure_ascii=False)


@pytest.mark.parametrize("what", ["scene", "table", "budget", "laws", "accuracy", "directions"])
def test_each_can_be_dark(what):
    assert main(["plot", "inspection.yaml", "plan", "-o", "out.html", "--what", what, "--dark"]) == 0
    assert '"paper_bgcolor":"#12181f"' in Path("out.html").read_text(encoding="utf-8")


def test_a_characteristic_can_be_named():
    assert (
        main(["plot", "inspection.yaml", "plan", "-o", "out.html", "--what", "laws", "--characteristic", "heel"]) == 0
    )
    assert "Error of heel" in Path("out.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["-o", "out.png"], "expected: .html"),
        (
            ["-o", "out.html", "--what", "laws", "--characteristic", "toe"],
            "expected: heel, width|expected: width, heel",
        ),
        (["-o", "out.html", "--what", "budget", "--characteristic", "heel"], "of all characteristics"),
    ],
)
def test_mistakes_are_reported(capsys, arguments, reported):
    assert re.search(reported, refused(capsys, "plot", "inspection.yaml", "plan", *arguments))


def test_the_plan_of_another_inspection_is_refused(capsys):
    write(part=box_part(entry("other", "[0, 0, 40]", "[80, 0, 40]")))
    assert "the plan was made from other files" in refused(capsys, "plot", "inspection.yaml", "plan", "-o", "out.html")


def test_a_folder_without_a_plan_is_refused(capsys):
    assert "nowhere: the file does not exist" in refused(capsys, "plot", "inspection.yaml", "nowhere", "-o", "out.html")
